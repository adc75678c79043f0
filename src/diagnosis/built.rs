//! The columns of a model along one recording, in the order of the catalogue.

use std::sync::{Arc, OnceLock};

use nalgebra::DVector;

use super::candidate::{Candidate, Term, sense, shown};
use super::model::Model;
use super::observed::{Observed, Series};
use crate::effects::{Motion, Scope};
use crate::kernels::axpy;
use crate::regression::Blocks;
use crate::series::JointSeries;

/// A model's columns on one recording.
pub struct Built {
    /// Recorded torque less what the twin knows, at the rows, N.m.
    pub y: Blocks,
    /// Columns of every term, at the rows.
    pub columns: Vec<Arc<Vec<Blocks>>>,
    /// The columns of every term over all samples, before sensors.
    series: Vec<Arc<Series>>,
}

impl Built {
    pub fn new(observed: &Observed<'_>, model: &Model) -> Self {
        let mut built = Self { y: observed.torque.clone(), columns: vec![], series: vec![] };
        let terms: Vec<&Term> = model.terms().collect();
        built.series = vec![Arc::default(); terms.len()];
        built.columns = vec![Arc::default(); terms.len()];
        // In the order of the catalogue, each with the torque of those before it, as last fitted.
        let mut order: Vec<usize> = (0..terms.len()).collect();
        order.sort_by_key(|&i| terms[i].candidate.order());
        let mut known = observed.known.clone();
        for (k, &i) in order.iter().enumerate() {
            let term = terms[i];
            let key = of_term(model, term);
            let series = || signature(observed, model, term, &known);
            let show = |series: &Series| -> Vec<Blocks> {
                series.iter().map(|c| shown(observed, &model.causes, c)).collect()
            };
            built.series[i] = match follows(term.candidate) {
                true => Arc::new(series()),
                false => observed.series.get(&key, series),
            };
            built.columns[i] = match is_kept(model, term.candidate) {
                true => observed.kept.get(&key, || show(&built.series[i])),
                false => Arc::new(show(&built.series[i])),
            };
            if order[k + 1..].iter().any(|&later| follows(terms[later].candidate)) {
                built.series[i].iter().zip(&term.linear).for_each(|(c, x)| add(&mut known, *x, c));
            }
        }
        let sensed = |j: usize| {
            observed.block(j, &sense(observed, &model.causes, j, observed.known.joint(j)))
        };
        match has_sensor(model) {
            true => built.y.add_scaled(-1.0, &Blocks((0..observed.joints()).map(sensed).collect())),
            false => built.y.add_scaled(-1.0, observed.known_rows()),
        }
        built
    }

    /// Torque of the rigid arm with what its causes weigh, as last fitted, at the rows, before sensors, N.m: what a joint's scale
    /// scales. Nothing where a cause is that scale, and what the twin says of it does not hold.
    pub fn carried(&self, observed: &Observed<'_>, model: &Model) -> Blocks {
        let mut sum = observed.rigid_rows().clone();
        let each = model.terms().zip(&self.series).zip(&self.columns);
        for ((term, series), columns) in each.filter(|((t, _), _)| t.candidate.is_load()) {
            for (i, value) in term.linear.iter().enumerate() {
                match has_sensor(model) {
                    true => sum.gather(*value, &shown(observed, &[], &series[i])),
                    false => sum.gather(*value, &columns[i]),
                }
            }
        }
        model.causes.iter().filter_map(|t| t.candidate.scaled()).for_each(|j| sum.0[j].clear());
        sum
    }

    /// Recorded less what the model gives at the values `x`, at the rows, N.m.
    pub fn residual(&self, x: &DVector<f64>) -> Blocks {
        let mut residual = self.y.clone();
        for (column, x) in self.columns.iter().flat_map(|c| c.iter()).zip(x.iter()) {
            residual.add_scaled(-x, column);
        }
        residual
    }
}

/// What a model gives at certain values, recording by recording: few ask for it, so it is worked out when one does.
pub struct Modelled {
    columns: Vec<Vec<Arc<Series>>>,
    x: DVector<f64>,
    sums: Vec<OnceLock<JointSeries>>,
}

impl Modelled {
    pub fn new(built: Vec<Built>, x: DVector<f64>) -> Self {
        let sums = built.iter().map(|_| OnceLock::new()).collect();
        Self { columns: built.into_iter().map(|b| b.series).collect(), x, sums }
    }

    /// Over all samples of recording `p`, before sensors, N.m.
    pub fn along(&self, p: usize, observed: &Observed<'_>) -> &JointSeries {
        self.sums[p].get_or_init(|| {
            let mut sum = observed.known.clone();
            for (column, x) in self.columns[p].iter().flat_map(|s| s.iter()).zip(self.x.iter()) {
                add(&mut sum, *x, column);
            }
            sum
        })
    }
}

/// Do the columns of a candidate change with all values of the model, so that keeping them is of no use?
pub fn follows(candidate: Candidate) -> bool {
    candidate.effect.follows_drive()
}

/// Does the model change the recorded channels? What rows show is then kept for as long as it does so alike.
fn has_sensor(model: &Model) -> bool {
    model.causes.iter().any(|t| t.candidate.senses())
}

/// Are what rows show of a term kept? A delay that is being refined is another each time.
pub fn is_kept(model: &Model, candidate: Candidate) -> bool {
    !follows(candidate) && !has_sensor(model)
}

/// Series of a candidate over all samples of a recording, kept where sensors show them ever anew.
pub fn series(
    observed: &Observed<'_>,
    model: &Model,
    candidate: Candidate,
    nonlinear: &[f64],
    motion: &Motion<'_>,
) -> Arc<Series> {
    let fresh = || candidate.series(motion, nonlinear, observed.index);
    match has_sensor(model) && !follows(candidate) {
        true => observed.series.get(&key(model, candidate, nonlinear), fresh),
        false => Arc::new(fresh()),
    }
}

/// Key of the sensors of a model, for columns that are kept.
pub fn of_sensors(model: &Model) -> String {
    let sensors = model.causes.iter().filter(|t| t.candidate.senses());
    sensors.map(|t| format!(" {:?} {:?}", t.candidate, t.nonlinear)).collect()
}

/// Key of an effect's columns: all that they depend on, where they follow no value of the model.
pub fn key(model: &Model, candidate: Candidate, nonlinear: &[f64]) -> String {
    let recording = candidate.recording;
    let key = format!("{candidate:?} {recording:?} {nonlinear:?}");
    match candidate.effect.depends_on_load() {
        true => {
            let carried: Vec<_> = model.laden.bodies.iter().map(|b| b.inertia).collect();
            key + &format!("{carried:?} {:?}", model.laden.gravity)
        }
        false => key,
    }
}

/// Key of those columns of a term that are not held.
pub fn of_term(model: &Model, term: &Term) -> String {
    format!("term {} {:?}", key(model, term.candidate, &term.nonlinear), term.held)
}

/// Key of the scales of all joints' torque; `None` where it goes with what causes weigh, another value each time.
pub fn scales(model: &Model) -> Option<String> {
    let scaled: Vec<usize> = model.causes.iter().filter_map(|t| t.candidate.scaled()).collect();
    (!model.terms().any(|t| t.candidate.is_load())).then(|| format!("scales but {scaled:?}"))
}

fn add(sum: &mut JointSeries, factor: f64, column: &[Vec<f64>]) {
    for (joint, series) in column.iter().enumerate() {
        axpy(factor, series, sum.joint_mut(joint));
    }
}

/// The columns of a term where the drive supplies `known` without it.
fn signature(observed: &Observed<'_>, model: &Model, term: &Term, known: &JointSeries) -> Series {
    let under;
    let robot = match term.candidate.effect.about().scope {
        Scope::Joint => &model.laden,
        _ => {
            let place = term.candidate.order();
            under = model.laden_with(observed.twin, |c| c.order() < place);
            &under
        }
    };
    let rigid = observed.rigid(robot);
    let (known, rigid) = (Some(known), Some(&*rigid));
    let motion = Motion { known, rigid, ..observed.motion(robot) };
    term.series(&motion, observed.index)
}
