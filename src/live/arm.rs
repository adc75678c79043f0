//! A scenario's arm that works without end: its motion, the way back, and again, with fresh noise each
//! time; effects are switched on while it runs.

use std::sync::Arc;

use crossbeam::channel::{Receiver, bounded};

use super::LiveError;
use crate::recording::Recording;
use crate::robot::{Drive, Robot, body_placements, flange_placement, point_jacobian};
use crate::rtde::Offer;
use crate::simulation::{Command, Experiment, Run, Simulation, SimulationError};

/// The motion, and the way back to where it began, each simulated once.
struct Stage {
    /// Rows from which on the arm is like that.
    from: u64,
    simulation: Simulation,
    motion: Run,
    back: Option<Run>,
}

/// What one time through shows, whole.
type Round = Recording;

/// An arm at work.
pub struct Arm {
    pub offer: Arc<Offer>,
    robot: Robot,
    drive: Drive,
    interval_s: f64,
    rounds: Receiver<Round>,
    round: Round,
    /// Where the columns of a round stand in a row of the offer.
    places: Vec<Option<usize>>,
    at: usize,
    k: u64,
    row: Vec<f64>,
}

/// Peaks on the way back: as slowly as a careful operator, rad/s and rad/s2.
const BACK_RAD_S: f64 = 1.0;
const BACK_RAD_S2: f64 = 2.0;
/// Rest before the motion begins again, s.
const REST_S: f64 = 0.5;

/// A rest-to-rest move with continuous jerk: q = from + s(t/T) (to - from),
/// s(x) = 35 x^4 - 84 x^5 + 70 x^6 - 20 x^7.
struct Way {
    from: Vec<f64>,
    by: Vec<f64>,
    moves_s: f64,
}

impl Way {
    /// `None` where the motion ends where it began.
    fn back(motion: &dyn Command, dof: usize) -> Option<Self> {
        let pose = |t: f64| {
            let mut out = [(); 3].map(|()| vec![0.0; dof]);
            let [q, qd, qdd] = &mut out;
            motion.at(t, q, qd, qdd);
            std::mem::take(q)
        };
        let (from, to) = (pose(motion.duration()), pose(0.0));
        let by: Vec<f64> = to.iter().zip(&from).map(|(to, from)| to - from).collect();
        let longest = by.iter().fold(0.0f64, |m, d| m.max(d.abs()));
        // Peaks of s' and s''.
        let moves_s = (2.1875 * longest / BACK_RAD_S).max((7.5132 * longest / BACK_RAD_S2).sqrt());
        (longest > 1e-9).then_some(Self { from, by, moves_s })
    }
}

impl Command for Way {
    fn duration(&self) -> f64 {
        self.moves_s + REST_S
    }

    fn at(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        let x = (t / self.moves_s).clamp(0.0, 1.0);
        let s = x.powi(4) * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * x.powi(3));
        let sd = 140.0 * x.powi(3) * (1.0 - x).powi(3) / self.moves_s;
        let sdd = 420.0 * x * x * (1.0 - x).powi(2) * (1.0 - 2.0 * x) / self.moves_s.powi(2);
        for (j, by) in self.by.iter().enumerate() {
            q[j] = self.from[j] + s * by;
            qd[j] = sd * by;
            qdd[j] = sdd * by;
        }
    }
}

impl Stage {
    fn new(
        from: u64,
        made: &Experiment,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Self, SimulationError> {
        let mut simulation = Simulation::new(&made.setup)?;
        let motion = simulation.run(&made.fit, made.seed, 0, &mut |_| go_on())?;
        let way = Way::back(&made.fit, made.setup.robot.dof());
        let back = way.map(|way| simulation.run(&way, made.seed, 2, &mut |_| go_on()));
        Ok(Self { from, simulation, motion, back: back.transpose()? })
    }

    /// The first time is the recording that `simulate` writes; later ones have noise of their own.
    fn round(&self, seed: u64, n: u64) -> Round {
        let first = &self.motion.recording;
        let again = |run: &Run, number: u64| {
            let noise = Some(&self.motion.current_noise_a[..]);
            in_order(self.simulation.sensed_with(run, noise, seed, number).recording, first)
        };
        let motion = if n == 0 { first.clone() } else { again(&self.motion, 2 * n + 1) };
        match &self.back {
            None => motion,
            Some(back) => joined(motion, &again(back, 2 * n + 2)),
        }
    }

    fn rows(&self) -> u64 {
        let back = self.back.as_ref().map_or(0, |b| b.recording.time.len());
        (self.motion.recording.time.len() + back) as u64
    }
}

/// With its channels in the order of another.
fn in_order(mut recording: Recording, like: &Recording) -> Recording {
    let place = |name: &str| like.channels.iter().position(|c| c.name == name);
    recording.channels.sort_by_key(|channel| place(&channel.name));
    recording
}

/// One behind the other; times are not used.
fn joined(mut first: Recording, second: &Recording) -> Recording {
    first.time.extend(&second.time);
    for (channel, more) in first.channels.iter_mut().zip(&second.channels) {
        channel.values.extend(&more.values);
    }
    first
}

impl Arm {
    /// Simulates the motion and the way back once, and once more for every one of `switched`: what the arm
    /// is like from that time on, s. `watch` returns false to stop.
    ///
    /// # Errors
    /// If a simulation fails.
    pub fn new(
        made: &Experiment,
        switched: &[(f64, Experiment)],
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Self, ArmError> {
        let clock = made.setup.clock;
        let interval_s = clock.step_s * clock.steps_per_sample as f64;
        let rate_hz = (1e6 / interval_s).round() / 1e6;
        let mut stages = vec![Stage::new(0, made, watch)?];
        for (at_s, made) in switched {
            stages.push(Stage::new((at_s * rate_hz).ceil() as u64, made, watch)?);
        }
        stages.sort_by_key(|stage| stage.from);
        let offer = Arc::new(Offer::new(rate_hz));
        let first = stages[0].round(made.seed, 0);
        let places = first.channels.iter().map(|c| offer.column(&c.name)).collect();
        let row = offer.still.clone();
        let rounds = ahead(stages, made.seed).map_err(ArmError::Live)?;
        let round = rounds.recv().unwrap_or(first);
        Ok(Self {
            offer,
            robot: made.setup.robot.clone(),
            drive: made.setup.drive.clone(),
            interval_s,
            rounds,
            round,
            places,
            at: 0,
            k: 0,
            row,
        })
    }

    pub fn rate_hz(&self) -> f64 {
        self.offer.rate_hz
    }

    /// Length of one time through, s.
    pub fn round_s(&self) -> f64 {
        self.round.time.len() as f64 * self.interval_s
    }

    /// The next row of the offer and its number.
    pub fn next_row(&mut self) -> (u64, &[f64]) {
        if self.at == self.round.time.len() {
            self.at = 0;
            // The thread that makes them ends with the arm only.
            if let Ok(round) = self.rounds.recv() {
                self.round = round;
            }
        }
        for (channel, place) in self.round.channels.iter().zip(&self.places) {
            if let Some(place) = place {
                self.row[*place] = channel.values[self.at];
            }
        }
        let k = self.k;
        self.put("timestamp", &[k as f64 * self.interval_s]);
        self.derive();
        self.at += 1;
        self.k += 1;
        (k, &self.row)
    }

    fn put(&mut self, name: &str, values: &[f64]) {
        if let Some((t, at)) = self.offer.find(name) {
            let width = t.width().min(values.len());
            self.row[at..at + width].copy_from_slice(&values[..width]);
        }
    }

    fn six(&self, name: &str) -> Vec<f64> {
        let dof = self.robot.dof().min(6);
        self.offer.find(name).map_or(vec![0.0; dof], |(_, at)| self.row[at..at + dof].to_vec())
    }

    /// What follows from joints: where the flange is and how fast, torque, the elbow, what the tool weighs.
    fn derive(&mut self) {
        let current = self.six("actual_current");
        self.put("joint_control_output", &current);
        let torque: Vec<f64> =
            current.iter().enumerate().map(|(j, i)| self.drive.torque(j, *i)).collect();
        self.put("actual_current_as_torque", &torque);
        if self.robot.dof() > 6 {
            return;
        }
        for side in ["actual", "target"] {
            let (q, qd) = (self.six(&format!("{side}_q")), self.six(&format!("{side}_qd")));
            let flange = flange_placement(&self.robot, &q);
            let turned = nalgebra::Rotation3::from_matrix_unchecked(flange.rotation).scaled_axis();
            let pose = [flange.translation.as_slice(), turned.as_slice()].concat();
            let last = self.robot.dof() - 1;
            let jacobian = point_jacobian(&self.robot, &q, last, &self.robot.flange.translation);
            let speed = jacobian * nalgebra::DVector::from_vec(qd);
            self.put(&format!("{side}_TCP_pose"), &pose);
            self.put(&format!("{side}_TCP_speed"), speed.as_slice());
            if side == "actual" {
                let felt = -(flange.rotation.transpose() * self.robot.gravity);
                self.put("actual_tool_accelerometer", felt.as_slice());
                if let Some(forearm) = body_placements(&self.robot, &q).get(2) {
                    self.put("elbow_position", forearm.translation.as_slice());
                }
            }
        }
    }
}

/// What can go wrong with an arm that is made ready.
#[derive(Debug, thiserror::Error)]
pub enum ArmError {
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    #[error(transparent)]
    Live(LiveError),
}

/// Rounds, made by a thread of their own, one ahead of the arm.
fn ahead(stages: Vec<Stage>, seed: u64) -> Result<Receiver<Round>, LiveError> {
    let (send, rounds) = bounded(1);
    let work = move || {
        let length = stages[0].rows();
        for n in 0.. {
            let begins = n * length;
            // What the arm is like when the round begins, and what is switched on in it.
            let first = stages.iter().rposition(|s| s.from <= begins).unwrap_or(0);
            let mut round = stages[first].round(seed, n);
            for stage in stages[first + 1..].iter().take_while(|s| s.from < begins + length) {
                let at = (stage.from - begins) as usize;
                for (old, new) in round.channels.iter_mut().zip(stage.round(seed, n).channels) {
                    old.values[at..].copy_from_slice(&new.values[at..]);
                }
            }
            if send.send(round).is_err() {
                return;
            }
        }
    };
    std::thread::Builder::new().name("rounds".into()).spawn(work).map_err(LiveError::Thread)?;
    Ok(rounds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::{Scenario, Switch};

    fn scenario(kind: &str) -> Scenario {
        let text = format!(
            "[motion]\nkind = \"{kind}\"\nduration_s = 5\n[noise]\nsnr_db = 30\nposition_rad = 2e-5\n\
             [drive]\nrotor_inertia = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14]\n\
             [effects.coulomb]\ncoulomb = [6, 7, 5, 1.5, 1.2, 1.0]\n"
        );
        Scenario::parse(&text, "test").unwrap()
    }

    fn rows(arm: &mut Arm, count: usize) -> Vec<Vec<f64>> {
        (0..count).map(|_| arm.next_row().1.to_vec()).collect()
    }

    /// No quantity jumps where one time through follows another, and noise is another each time.
    #[test]
    fn it_works_again_and_again_without_a_jump() {
        for kind in ["random_frequency", "point_to_point"] {
            let made = scenario(kind).work_out("test").unwrap();
            let mut arm = Arm::new(&made, &[], &mut || true).unwrap();
            let length = (arm.round_s() * arm.rate_hz()).round() as usize;
            let all = rows(&mut arm, 3 * length);
            // Of the pose its place: rotation vectors turn over where they are as long as pi.
            let watched = [
                ("target_q", 6),
                ("actual_q", 6),
                ("joint_temperatures", 6),
                ("actual_TCP_pose", 3),
            ];
            for (name, width) in watched {
                let (_, at) = arm.offer.find(name).unwrap();
                for pair in all.windows(2) {
                    let after = pair[1][at..at + width].iter();
                    for (after, before) in after.zip(&pair[0][at..]) {
                        let step = (after - before).abs();
                        assert!(step < 0.1, "{kind} {name} {step}");
                    }
                }
            }
            let current = arm.column("actual_current_1");
            assert_ne!(all[100][current], all[100 + length][current]);
            assert_eq!(
                all[100][arm.column("target_q_1")],
                all[100 + length][arm.column("target_q_1")]
            );
            let interval = all[1][arm.column("timestamp")];
            for (k, row) in all.iter().enumerate() {
                assert_eq!(row[arm.column("timestamp")].to_bits(), (k as f64 * interval).to_bits());
            }
        }
    }

    impl Arm {
        fn column(&self, name: &str) -> usize {
            self.offer.column(name).unwrap()
        }
    }

    #[test]
    fn an_effect_acts_from_its_time_on() {
        let scenario = scenario("random_frequency");
        let switch: Switch = "coulomb.joint3=9".parse().unwrap();
        let made = scenario.work_out("test").unwrap();
        let changed = scenario.switched(&switch, 6).work_out("test").unwrap();
        let mut usual = Arm::new(&made, &[], &mut || true).unwrap();
        let mut switched = Arm::new(&made, &[(1.5, changed)], &mut || true).unwrap();
        let [usual, changed] = [rows(&mut usual, 620), rows(&mut switched, 620)];
        let at = switched.column("actual_current_2");
        let first = (0..620).find(|&k| usual[k][at] != changed[k][at]);
        assert_eq!(first, Some(188), "1.5 s at 125 Hz, rounded up");
        let mean = |rows: &[Vec<f64>]| rows[400..].iter().map(|r| r[at].abs()).sum::<f64>();
        assert!((mean(&usual) - mean(&changed)).abs() > 1.0);
    }
}
