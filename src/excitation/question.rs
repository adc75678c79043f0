//! What is asked, ready to be answered along any motion of one arm.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::ask::Ask;
use super::columns::{Column, Unknown, Unknowns};
use super::information::{Information, Rows, independent};
use super::limits::torque_along;
use crate::effects::Motion;
use crate::motion::{Envelope, Sampled};
use crate::robot::Robot;
use crate::series::JointSeries;
use crate::signals::Conditioning;
use crate::twin::Twin;

/// How what the motion is recorded with is assumed to be.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Recorder {
    pub rate_hz: f64,
    /// Standard deviation of white noise on the torque of each joint, N.m.
    pub noise_nm: Vec<f64>,
}

pub struct Question<'a> {
    twin: &'a Twin,
    /// The robot with the loads the twin knows.
    robot: Robot,
    recorder: &'a Recorder,
    /// One, or two where rivals are to be told apart: each against the other.
    problems: Vec<Problem>,
}

struct Problem {
    unknowns: Unknowns,
    /// How many of the unknowns are open besides; the others are asked for.
    besides: usize,
    /// Are those asked for one, at the sizes they may well have?
    together: bool,
    /// Columns with something of their own.
    kept: Vec<bool>,
}

/// How well a motion answers.
pub struct Answer {
    /// log det of the information about what is asked for; of rivals, the logarithm of the square of
    /// the smaller one's torque that the other cannot imitate, over the noise.
    pub log_det: f64,
    /// Standard deviation of every asked parameter that can be told at all; of rivals, none.
    pub deviations: Vec<f64>,
}

/// Random states by which it is decided what can be told at all.
const STATES: usize = 150;

impl<'a> Question<'a> {
    /// `filled` is the twin with a value for everything, `twin` as its owner wrote it.
    pub fn new(
        filled: &'a Twin,
        twin: &Twin,
        ask: &Ask,
        recorder: &'a Recorder,
        envelope: &Envelope,
    ) -> Self {
        let robot = filled.laden();
        let besides = Unknowns::besides(ask, twin);
        let problem = |more: Unknowns, asked: Unknowns, together: bool| {
            let open = besides.clone().and(more);
            let besides = open.all.len();
            Problem { unknowns: open.and(asked), besides, together, kept: Vec::new() }
        };
        let problems = match ask {
            Ask::Learn { inertia, terms } => {
                let links = inertia.then(|| Unknowns::of_links(&robot));
                let effects = Unknowns::of(terms, &robot);
                let asked = match links {
                    Some(links) => links.and(effects),
                    None => effects,
                };
                vec![problem(Unknowns::of([], &robot), asked, false)]
            }
            Ask::Apart([a, b]) => [[a, b], [b, a]]
                .map(|[one, other]| {
                    problem(Unknowns::of([other], &robot), Unknowns::of([one], &robot), true)
                })
                .into(),
        };
        let mut question = Self { twin: filled, robot, recorder, problems };
        let anything = states(&question.robot, envelope);
        let rows = question.rows(&anything, 1.0);
        let kept: Vec<_> = question.on(&anything, 1.0, |motion| {
            let problems = question.problems.iter();
            problems.map(|p| independent(&p.columns(motion), &p.sizes(), &rows)).collect()
        });
        question.problems.iter_mut().zip(kept).for_each(|(p, kept)| p.kept = kept);
        question
    }

    /// What is asked for and can be told, in the order of [`Answer::deviations`].
    pub fn told(&self) -> Vec<&Unknown> {
        self.asked(true)
    }

    /// What is asked for and follows from other parameters, whatever the motion.
    pub fn not_told(&self) -> Vec<&Unknown> {
        self.asked(false)
    }

    fn asked(&self, told: bool) -> Vec<&Unknown> {
        let problem = self.problems.iter().filter(|p| !p.together);
        problem
            .flat_map(|p| p.unknowns.all.iter().zip(&p.kept).skip(p.besides))
            .filter(|(_, kept)| **kept == told)
            .map(|(u, _)| u)
            .collect()
    }

    /// Is there anything that some motion could tell?
    pub fn can_be_answered(&self) -> bool {
        self.problems.iter().all(|p| p.kept.iter().skip(p.besides).any(|k| *k))
    }

    /// `None` where the motion does not determine what is asked for.
    pub fn answer(&self, motion: &Sampled, dt: f64) -> Option<Answer> {
        let rows = self.rows(motion, dt);
        let each = self.on(motion, dt, |motion| {
            self.problems.iter().map(|p| p.answer(motion, &rows)).collect::<Option<Vec<_>>>()
        })?;
        each.into_iter().min_by(|a, b| a.log_det.total_cmp(&b.log_det))
    }

    fn on<T>(&self, motion: &Sampled, dt: f64, work: impl FnOnce(&Motion<'_>) -> T) -> T {
        let Sampled { q, qd, qdd } = motion;
        let known = torque_along(self.twin, motion, dt);
        let motion = Motion { known: Some(&known), ..Motion::new(&self.robot, dt, q, qd, qdd) };
        work(&motion)
    }

    /// Sliding samples, as identification takes them, weighed as so many of the recording's.
    fn rows(&self, motion: &Sampled, dt: f64) -> Rows {
        let slow = Conditioning::default().standstill_rad_s;
        let sliding = |j: usize| {
            let qd = motion.qd.joint(j);
            (0..qd.len()).filter(|&k| qd[k].abs() > slow).collect()
        };
        let share = (self.recorder.rate_hz * dt).sqrt();
        Rows {
            counted: (0..self.robot.dof()).map(sliding).collect(),
            weight: self.recorder.noise_nm.iter().map(|sigma| share / sigma).collect(),
        }
    }
}

impl Problem {
    /// Sizes of the parameters of [`Problem::columns`], each in its unit.
    fn sizes(&self) -> Vec<f64> {
        let all = self.unknowns.all.iter().map(|u| u.size);
        match self.together {
            true => all.take(self.besides).chain([1.0]).collect(),
            false => all.collect(),
        }
    }

    /// Columns of all parameters, before any is left out.
    fn columns(&self, motion: &Motion<'_>) -> Vec<Column> {
        let mut columns = self.unknowns.columns(motion);
        if self.together {
            let asked = columns.split_off(self.besides);
            let sizes = self.unknowns.all[self.besides..].iter().map(|u| u.size);
            columns.push(sum(&asked, sizes, motion.samples()));
        }
        columns
    }

    fn answer(&self, motion: &Motion<'_>, rows: &Rows) -> Option<Answer> {
        let all = self.columns(motion).into_iter().zip(&self.kept);
        let columns: Vec<Column> = all.filter(|(_, kept)| **kept).map(|(c, _)| c).collect();
        let open = self.kept.iter().take(self.besides).filter(|k| **k).count();
        let information = Information::new(&columns, open, rows)?;
        if self.together {
            return Some(Answer { log_det: information.log_det(&[1.0]), deviations: Vec::new() });
        }
        let asked = self.unknowns.all.iter().zip(&self.kept).skip(self.besides);
        let sizes: Vec<f64> = asked.filter(|(_, kept)| **kept).map(|(u, _)| u.size).collect();
        let log_det = information.log_det(&sizes);
        Some(Answer { log_det, deviations: information.deviations() })
    }
}

/// Columns times sizes, added up.
fn sum(columns: &[Column], sizes: impl Iterator<Item = f64>, samples: usize) -> Column {
    let dof = columns.first().map_or(0, Vec::len);
    let mut sum = vec![vec![0.0; samples]; dof];
    for (column, size) in columns.iter().zip(sizes) {
        for (sum, values) in sum.iter_mut().zip(column) {
            sum.iter_mut().zip(values).for_each(|(s, v)| *s += size * v);
        }
    }
    sum
}

/// States all over what the arm may do, independent of each other.
fn states(robot: &Robot, envelope: &Envelope) -> Sampled {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut draw = |centre: &[f64], range: &[f64]| {
        let one = |j: usize, rng: &mut ChaCha8Rng| -> Vec<f64> {
            (0..STATES).map(|_| centre[j] + range[j] * rng.random_range(-1.0..1.0)).collect()
        };
        let joints: Vec<_> = (0..robot.dof()).map(|j| one(j, &mut rng)).collect();
        JointSeries::from_joints(&joints)
    };
    let zero = vec![0.0; robot.dof()];
    Sampled {
        q: draw(&envelope.centre, &envelope.range),
        qd: draw(&zero, &envelope.velocity),
        qdd: draw(&zero, &envelope.acceleration),
    }
}
