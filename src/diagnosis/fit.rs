//! The twin with causes added, fitted to recordings or held against another.

use std::sync::Arc;

use nalgebra::DVector;
use rayon::prelude::*;

use super::built::{self, Built, Modelled, follows, is_kept, key, of_sensors, of_term};
use super::candidate::{Candidate, Term, shown};
use super::data::Data;
use super::model::Model;
use super::observed::Observed;
use super::sizes::Sizes;
use super::tolerances;
use crate::effects::{Motion, Rigid, Role};
use crate::follow::go_on;
use crate::regression::random_effects::{Metric, STEPS};
use crate::regression::{Blocks, Column, Normal, Raw, System};
use crate::series::JointSeries;

/// Passes of fitting causes that depend on each other.
pub(super) const MOST_PASSES: usize = 4;
/// Expected size of an effect (standard deviation) as a share of a joint's rated torque. Joints are sized
/// such that friction and what else is lost comes to about a tenth of it.
pub const EXPECTED_SHARE: f64 = 0.1;

/// A model fitted to the recordings of `data`.
#[derive(Clone)]
pub struct Fit<'a> {
    pub data: &'a Data<'a>,
    pub model: Model,
    /// Sizes of the discrepancy and of what the twin states within limits.
    pub sizes: Sizes,
    pub metric: Metric,
    pub system: System,
    /// Sum of squares left in the metric, joint by joint, (N.m)^2.
    pub squares: Vec<f64>,
    pub(super) normal: Arc<Normal>,
    modelled: Arc<Modelled>,
    /// What the arm with its causes weighs, of each recording.
    rigid: Vec<Arc<Rigid>>,
    /// Values of what the twin states within limits, in units of its tolerances, where they are held and not fitted.
    held: Option<Vec<f64>>,
}

impl<'a> Fit<'a> {
    /// Least squares beside a discrepancy of these sizes; joints are weighted by what the model leaves
    /// of them, in two rounds. Again where one cause depends on the values of another, until they
    /// agree: columns that belong to other values predict another recording badly.
    pub fn new(data: &'a Data<'a>, model: Model, sizes: Sizes) -> Self {
        Self::settling(data, model, sizes, None)
    }

    /// Another model beside what this fit has of the discrepancy and of what the twin states within limits.
    pub fn with_tolerances_held(&self, model: Model) -> Self {
        let held = Some(self.tolerances().to_vec());
        Self::settling(self.data, model, self.sizes.clone(), held)
    }

    fn settling(data: &'a Data<'a>, model: Model, sizes: Sizes, held: Option<Vec<f64>>) -> Self {
        let mut fit = Self::once(data, model, sizes, held);
        for _ in 0..MOST_PASSES {
            let scaled = fit.sizes.tolerances > 0 && fit.model.carries();
            if !(scaled || fit.model.is_entangled()) {
                break;
            }
            let before = fit.system.x.clone();
            fit = Self::once(data, fit.model, fit.sizes, fit.held);
            if fit.system.is_near(&before) {
                break;
            }
        }
        fit
    }

    /// The fit without a discrepancy.
    pub fn plain(data: &'a Data<'a>, model: Model) -> Self {
        Self::new(data, model, data.nothing())
    }

    fn once(data: &'a Data<'a>, mut model: Model, sizes: Sizes, held: Option<Vec<f64>>) -> Self {
        go_on(data.watch);
        let built: Vec<Built> = data.parts.par_iter().map(|p| Built::new(p, &model)).collect();
        let mut columns = columns(data, &model, &built);
        let key = built::scales(&model);
        let within = data.within_tolerances(key, |p| built[p].carried(data.parts[p], &model));
        let mut y = recorded(data, &model, &built);
        let tolerances = match &held {
            Some(values) => {
                y = y.less_sum(values, &within);
                0
            }
            None => {
                columns.extend(within);
                sizes.tolerances
            }
        };
        let normal = Normal::new(columns, y);
        let metric = data.metric(&sizes);
        let system = solved(data, &model, &normal, &metric, tolerances);
        let modelled = Arc::new(Modelled::new(built, system.x.clone()));
        model.carry(data.twin, &system.x);
        let squares = system.residual.squares();
        let rigid = data.parts.iter().map(|p| p.rigid(&model.laden)).collect();
        Self { data, model, sizes, metric, system, squares, normal, modelled, rigid, held }
    }

    /// Is nothing left out at a joint?
    pub fn is_exact(&self, j: usize) -> bool {
        self.metric.joints[j].is_plain() && self.sizes.tolerances == 0
    }

    /// This fit beside a discrepancy of other sizes.
    pub fn beside(mut self, sizes: Sizes) -> Self {
        if sizes == self.sizes {
            return self;
        }
        (self.metric, self.system) = self.seen_beside(&sizes);
        self.squares = self.system.residual.squares();
        self.sizes = sizes;
        self
    }

    /// Logarithm of the evidence: how likely the data are with the discrepancy integrated out, at the
    /// best values of what the twin leaves open, and averaged over what is expected of the causes'
    /// linear parameters; nats, up to a constant of the data.
    pub fn ln_evidence(&self) -> f64 {
        let starts = self.model.causes.iter().map(Term::ln_starts).sum::<f64>();
        self.ln_likelihoods() - self.system.occam_penalty(0) - starts
    }

    /// Evidence for a discrepancy over none beside the same causes and what is known within limits, nats: the best of
    /// so many sizes.
    pub fn evidence_of_discrepancy(&self) -> f64 {
        let plain = self.clone().beside(self.sizes.within_limits());
        (self.ln_evidence() - plain.ln_evidence()) - (self.sizes.count() as f64).ln()
    }

    /// Log-likelihood of all rows at the best values of what the model has, averaged over what the twin states
    /// within limits, nats.
    pub fn ln_likely(&self) -> f64 {
        self.ln_likelihoods() - self.system.occam_penalty(self.terms())
    }

    /// That of all joints; to have chosen the size of the tolerances costs what it is among all.
    fn ln_likelihoods(&self) -> f64 {
        let joints: f64 = (0..self.squares.len()).map(|j| self.ln_likelihood(j)).sum();
        let chosen = if self.sizes.tolerances > 0 { f64::from(STEPS).ln() } else { 0.0 };
        joints - chosen
    }

    /// Log-likelihood of joint `j`'s rows, nats.
    pub fn ln_likelihood(&self, j: usize) -> f64 {
        self.data.ln_likelihood(j, self.squares[j], &self.metric)
    }

    /// Metric and solution of this model beside a discrepancy of other sizes.
    pub fn seen_beside(&self, sizes: &Sizes) -> (Metric, System) {
        let metric = self.data.metric(sizes);
        let tolerances = sizes.tolerances;
        let system = solved(self.data, &self.model, &self.normal, &metric, tolerances);
        (metric, system)
    }

    /// What model and discrepancy leave of a joint, N.m at its rows.
    pub fn innovations(&self, j: usize) -> Vec<f64> {
        let mut rows = self.data.in_full(j, self.system.residual.rows.joint(j).to_vec());
        rows.iter_mut().zip(self.discrepancy(j)).for_each(|(r, d)| *r -= d);
        rows
    }

    /// The most likely discrepancy of a joint, N.m at its rows; empty where there is none.
    pub fn discrepancy(&self, j: usize) -> Vec<f64> {
        let (features, metric) = (&self.data.features[j], &self.metric.joints[j]);
        if metric.is_plain() || self.data.rows(j) == 0 {
            return Vec::new();
        }
        let taken = self.system.residual.taken(j);
        self.data.in_full(j, features.sum(&metric.coefficients(taken, features.count()), None))
    }

    /// The columns of a further candidate, as the rows show them.
    pub fn raw(&self, candidate: Candidate, nonlinear: &[f64]) -> Vec<Raw> {
        self.data.fresh(|p| self.blocks(p, candidate, nonlinear))
    }

    /// The columns of a further candidate, as the rows of recording `p` show them.
    pub fn blocks(&self, p: usize, candidate: Candidate, nonlinear: &[f64]) -> Vec<Blocks> {
        let (observed, sensors) = (self.data.parts[p], &self.model.causes);
        let motion = self.motion_of(p, candidate);
        let series = built::series(observed, &self.model, candidate, nonlinear, &motion);
        series.iter().map(|column| shown(observed, sensors, column)).collect()
    }

    /// The columns of `raw`, kept for the next time where the effect does not depend on values of the model.
    pub fn raw_kept(&self, candidate: Candidate, nonlinear: &[f64]) -> Arc<Vec<Raw>> {
        if follows(candidate) {
            return Arc::new(self.raw(candidate, nonlinear));
        }
        let key = key(&self.model, candidate, nonlinear) + &of_sensors(&self.model);
        // Other searches of a recording come to the same.
        let blocks =
            |p: usize| self.data.parts[p].kept.get(&key, || self.blocks(p, candidate, nonlinear));
        self.data.kept(&key, |p| blocks(p).to_vec())
    }

    /// The columns of `raw` in the metric of this fit.
    pub fn columns(&self, candidate: Candidate, nonlinear: &[f64]) -> Vec<Column> {
        Column::all(&self.raw(candidate, nonlinear), &self.metric)
    }

    /// The motion of a recording as a candidate sees it on the arm with its causes.
    fn motion_of(&self, p: usize, candidate: Candidate) -> Motion<'_> {
        let (observed, laden) = (self.data.parts[p], &self.model.laden);
        let rigid = Some(&*self.rigid[p]);
        let known = follows(candidate).then(|| self.modelled(p));
        Motion { known, rigid, ..observed.motion(laden) }
    }

    /// What the model gives over all samples of recording `p`, before sensors, N.m.
    pub fn modelled(&self, p: usize) -> &JointSeries {
        self.modelled.along(p, self.data.parts[p])
    }

    /// The motion of the first recording, where a search begins.
    pub fn motion(&self) -> Motion<'_> {
        let first = self.data.parts[0];
        first.motion(&first.twin.robot)
    }

    /// What the fitted values leave of a recording, N.m at its rows.
    pub fn held_against(&self, other: &Observed<'_>) -> Blocks {
        Built::new(other, &self.model).residual(&self.system.x)
    }

    /// What the fitted values leave of a recording within the twin's tolerances, N.m at its rows.
    pub fn held_within(&self, other: &Observed<'_>) -> Blocks {
        let built = Built::new(other, &self.model);
        let mut left = built.residual(&self.system.x);
        let carried = built.carried(other, &self.model);
        let within = self.data.tolerances.torque(other, &carried, self.tolerances());
        left.add_scaled(-1.0, &within);
        left
    }

    /// Values of what the twin states within limits, in units of its tolerances; none where it is exact.
    fn tolerances(&self) -> &[f64] {
        match &self.held {
            Some(values) => values,
            None => &self.system.x.as_slice()[self.terms()..],
        }
    }

    /// Torque of the rigid arm with what the causes weigh in recording `p`, at the rows, N.m.
    pub fn carried(&self, p: usize) -> Blocks {
        Built::new(self.data.parts[p], &self.model).carried(self.data.parts[p], &self.model)
    }

    /// How many linear values the terms of the model have.
    pub fn terms(&self) -> usize {
        self.model.terms().map(|t| t.candidate.linear()).sum()
    }

    /// Does cause `i` change what a recording shows?
    pub fn acts_in(&self, i: usize, other: &Observed<'_>) -> bool {
        let cause = &self.model.causes[i];
        let columns = Built::new(other, &self.model).columns.swap_remove(self.model.open.len() + i);
        let shows = |column: &Blocks| (0..other.joints()).any(|j| column.touches(j));
        cause.candidate.senses() || columns.iter().any(shows)
    }

    /// Values of cause `i`: linear, then nonlinear.
    pub fn values(&self, i: usize) -> Vec<f64> {
        let linear = &self.system.x.as_slice()[self.model.range(i)];
        linear.iter().chain(&self.model.causes[i].nonlinear).copied().collect()
    }

    /// Columns of all terms with what a bound holds at zero set free, and the residual, of one
    /// recording as columns of `data` see it.
    pub fn free_columns(&self) -> Vec<Raw> {
        let mut free = self.model.clone();
        free.causes.iter_mut().for_each(|t| t.held.fill(false));
        let built: Vec<Built> = self.data.parts.iter().map(|p| Built::new(p, &free)).collect();
        columns(self.data, &free, &built)
    }

    /// What another model gives at the values of this one, less the recorded torque, N.m.
    pub fn predicted(&self, model: &Model) -> Raw {
        let minus = |p: &&Observed| {
            let mut residual = Built::new(p, model).residual(&self.system.x);
            residual.0.iter_mut().flatten().for_each(|v| *v = -*v);
            residual
        };
        self.data.raw(self.data.parts.iter().map(minus).collect())
    }
}

/// The columns of all terms of a model; those that follow no value of it are kept.
fn columns(data: &Data<'_>, model: &Model, built: &[Built]) -> Vec<Raw> {
    let of = |(i, term): (usize, &Term)| {
        let parts = |p: usize| built[p].columns[i].to_vec();
        match is_kept(model, term.candidate) {
            true => data.kept(&of_term(model, term), parts).to_vec(),
            false => data.fresh(parts),
        }
    };
    model.terms().enumerate().flat_map(of).collect()
}

/// Recorded torque less what the twin knows: without a sensor the same for all models.
fn recorded(data: &Data<'_>, model: &Model, built: &[Built]) -> Raw {
    match model.causes.iter().any(|t| t.candidate.senses()) {
        true => data.raw(built.iter().map(|b| b.y.clone()).collect()),
        false => data.kept("recorded", |p| vec![built[p].y.clone()])[0].clone(),
    }
}

/// Least squares in two rounds: the weights of the second are what the first leaves. The twin's own friction
/// that would have to push is held at zero.
fn solved(
    data: &Data<'_>,
    model: &Model,
    normal: &Normal,
    metric: &Metric,
    tolerances: u8,
) -> System {
    let mut priors = priors(data, model, &normal.columns);
    if tolerances > 0 {
        priors.resize(normal.columns.len(), tolerances::size(tolerances));
    }
    let seen = normal.seen(metric, priors.len());
    let first = seen.values(&data.weights(&seen.squares(None)), &priors);
    let weights = data.weights(&seen.squares(Some(&first)));
    for _ in 0..MOST_PASSES {
        let pushing = pushing(model, &seen.values(&weights, &priors), &priors);
        if pushing.is_empty() {
            break;
        }
        pushing.into_iter().for_each(|i| priors[i] = HELD);
    }
    seen.solve(weights, priors)
}

/// Standard deviation of what is held at zero, in any unit.
const HELD: f64 = 1e-12;

/// Places of open parameters that may not be negative and are.
fn pushing(model: &Model, x: &DVector<f64>, priors: &[f64]) -> Vec<usize> {
    let parameters = model.open.iter().flat_map(|t| t.candidate.effect.about().parameters);
    let linear = parameters.filter(|p| p.role == Role::Linear).enumerate();
    let pushes = |i: usize| x[i] < 0.0 && priors[i].is_infinite();
    linear.filter(|(i, p)| p.min >= 0.0 && pushes(*i)).map(|(i, _)| i).collect()
}

/// Standard deviations of all linear parameters: unknown where the twin leaves them open.
fn priors(data: &Data<'_>, model: &Model, columns: &[Raw]) -> Vec<f64> {
    let open: usize = model.open.iter().map(|t| t.candidate.linear()).sum();
    let mut all = vec![f64::INFINITY; open];
    let mut rest = &columns[open..];
    for term in &model.causes {
        let (own, others) = rest.split_at(term.candidate.linear());
        all.extend(match term.free {
            true => vec![f64::INFINITY; own.len()],
            false => expected(data, term.candidate, &term.nonlinear, own),
        });
        rest = others;
    }
    all
}

/// How large the linear parameters of a candidate with these columns are expected to be, standard
/// deviations: as its effect says; where it does not, as gives the torque that effects are expected to have, at the
/// joint where that is reached first.
pub fn expected(
    data: &Data<'_>,
    candidate: Candidate,
    nonlinear: &[f64],
    columns: &[Raw],
) -> Vec<f64> {
    let known = candidate.expected(data.twin, nonlinear);
    let of = |column: &Raw| {
        let relative = |j: usize| match column.rows.touches(j) {
            true => {
                let rows = column.rows.joint(j);
                let rows = data.in_full(j, rows.to_vec());
                let square: f64 = crate::kernels::dot(&rows, &rows);
                let acting = rows.iter().filter(|v| **v != 0.0).count().max(1) as f64;
                (square / acting).sqrt() / data.rated[j]
            }
            false => 0.0,
        };
        let largest = (0..data.joints()).map(relative).fold(0.0, f64::max);
        if largest > 0.0 { EXPECTED_SHARE / largest } else { 1.0 }
    };
    let known = |i: usize| known.get(i).copied().filter(|size| size.is_finite());
    columns.iter().enumerate().map(|(i, c)| known(i).unwrap_or_else(|| of(c))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::candidate::Place;
    use crate::diagnosis::floor::noise_floor;
    use crate::effects::find;
    use crate::signals::testing::samples;
    use crate::twin::Twin;

    const GAIN: f64 = 0.2;
    const COULOMB_NM: f64 = 6.0;
    const LOAD_KG: f64 = 2.0;
    const TILT_RAD: f64 = 0.1;

    fn cause(name: &str, twin: &Twin, evidence: &Observed<'_>) -> Term {
        let candidate = Candidate::new(find(name).unwrap(), Place::Arm);
        let starts = candidate.starts(&evidence.motion(&twin.robot), twin);
        Term::new(candidate, starts[0].clone())
    }

    /// Torque of an arm that has a gain, a load and a tilt, all of which its twin lacks.
    fn recorded(twin: &Twin) -> crate::signals::Samples {
        let mut arm = twin.clone();
        arm.effects.extend(["payload", "base_tilt", "torque_constant"].map(String::from));
        for (name, value) in [
            ("coulomb", COULOMB_NM),
            ("viscous", 3.0),
            ("payload_mass", LOAD_KG),
            ("payload_moment_x", 0.0),
            ("payload_moment_y", 0.0),
            ("payload_moment_z", 0.1),
            ("tilt_x", TILT_RAD),
            ("tilt_y", 0.0),
            ("torque_gain_error", GAIN),
        ] {
            let count = if name.starts_with("payload") || name.starts_with("tilt") { 1 } else { 6 };
            arm.values.insert(name.into(), vec![value; count]);
        }
        let mut made = samples(6, 4000, |j, t| {
            0.7 * (0.9 * t + j as f64).sin() + 0.3 * ((1.7 + 0.3 * j as f64) * t).sin()
        });
        made.torque = arm.torque(&arm.motion(&made));
        made
    }

    #[test]
    fn friction_that_would_push_is_held_at_zero() {
        let twin = Twin::default();
        let mut made = recorded(&twin);
        let push = made.qd.joint(2).iter().map(|qd| -20.0 * qd.signum()).collect::<Vec<f64>>();
        made.torque.joint_mut(2).iter_mut().zip(push).for_each(|(t, p)| *t += p);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let data = Data::plain(vec![&observed]);
        let fit = Fit::plain(&data, Model::of(&twin));
        assert!(fit.system.x.iter().all(|x| *x >= -1e-9), "{:?}", fit.system.x);
        assert!(fit.system.x.iter().any(|x| x.abs() <= 1e-9), "{:?}", fit.system.x);
    }

    /// A gain scales friction too, and a base tilts with its load: fitted together they come out as
    /// they are, and so does the friction beside them.
    #[test]
    fn causes_that_depend_on_each_other_come_out_as_they_are() {
        let twin = Twin::default();
        let samples = recorded(&twin);
        let floor = noise_floor(&samples, &twin);
        let evidence = Observed::new(0, &twin, &samples, &floor).unwrap();
        let data = Data::plain(vec![&evidence]);
        let mut model = Model::of(&twin);
        for name in ["payload", "base_tilt", "torque_constant"] {
            model = model.with(cause(name, &twin, &evidence));
        }
        // References and dependences settle.
        let mut fit = Fit::plain(&data, model);
        for _ in 0..8 {
            let mut model = fit.model.clone();
            for term in &mut model.causes {
                let linear = term.linear.clone();
                term.candidate.settle(&linear, &mut term.nonlinear);
            }
            fit = Fit::plain(&data, model);
        }
        let near = |found: f64, truth: f64| (found - truth).abs() < 0.01 * truth;
        assert!(near(fit.values(0)[0], LOAD_KG), "{:?}", fit.values(0));
        assert!(near(fit.values(1)[0], TILT_RAD), "{:?}", fit.values(1));
        assert!(near(fit.values(2)[0], GAIN), "{:?}", fit.values(2));
        let coulomb = fit.model.open.iter().filter(|t| t.candidate.name() == "coulomb");
        for term in coulomb {
            assert!(near(term.linear[0], COULOMB_NM), "{:?}", term);
        }
    }
}
