//! The twin with causes added, fitted to a recording or held against another.

use nalgebra::DVector;

use super::Settings;
use super::candidate::{Candidate, Place, Term, sense, shown};
use super::columns::Blocks;
use super::evidence::Evidence;
use super::rank::{acts_on, effective_shares};
use super::system::System;
use crate::effects::{Mechanism, Motion, Rigid, Role, Scope, find};
use crate::robot::Robot;
use crate::series::JointSeries;
use crate::twin::Twin;

/// Passes of fitting causes that depend on each other.
const MOST_PASSES: usize = 4;

/// What is fitted: the twin's open effects and the causes accepted so far.
#[derive(Debug, Clone)]
pub struct Model {
    pub open: Vec<Term>,
    pub causes: Vec<Term>,
    /// What the gears carry: the twin's robot with known and accepted loads.
    pub laden: Robot,
}

impl Model {
    /// The twin alone; nonlinear parameters of its open effects at their typical values.
    pub fn of(twin: &Twin) -> Self {
        let everywhere = |effect: &'static dyn crate::effects::Effect| {
            let joints = if effect.about().scope == Scope::Arm { 0 } else { twin.robot.dof() };
            let arm = (joints == 0).then_some(Place::Arm);
            let nonlinear: Vec<f64> = effect
                .about()
                .parameters
                .iter()
                .filter(|p| p.role == Role::Nonlinear)
                .map(|p| p.typical)
                .collect();
            (0..joints)
                .map(Place::Joint)
                .chain(arm)
                .map(move |place| Term::new(Candidate { effect, place }, nonlinear.clone()))
        };
        let open = twin.open().flat_map(everywhere).collect();
        Self { open, causes: Vec::new(), laden: twin.laden() }
    }

    /// The same with link masses and centres free within what is known of them.
    pub fn of_uncertain(twin: &Twin, settings: &Settings) -> Self {
        let mut model = Self::of(twin);
        let Some(effect) = find("link_inertia") else { return model };
        model.open.extend((0..twin.robot.dof()).map(|j| {
            let inertia = &twin.robot.bodies[j].inertia;
            let mass = settings.mass_error * inertia.mass;
            let moment = settings.centre_error_m * inertia.mass + mass * inertia.com.norm();
            let place = Place::Joint(j);
            let prior = vec![mass, moment, moment, moment];
            Term { prior, ..Term::new(Candidate { effect, place }, Vec::new()) }
        }));
        model
    }

    /// Standard deviations of all linear parameters, infinite where nothing is known.
    pub fn priors(&self) -> Vec<f64> {
        let of_term = |t: &Term| match t.prior.is_empty() {
            true => vec![f64::INFINITY; t.candidate.linear()],
            false => t.prior.clone(),
        };
        self.terms().flat_map(of_term).collect()
    }

    /// Is anything known of a parameter beforehand?
    fn knows(&self) -> bool {
        self.terms().any(|t| !t.prior.is_empty())
    }

    pub fn with(&self, cause: Term) -> Self {
        let mut more = self.clone();
        more.causes.push(cause);
        more
    }

    /// Without the causes at these indices.
    pub fn without(&self, causes: &[usize]) -> Self {
        let mut fewer = self.clone();
        let mut index = 0..;
        fewer.causes.retain(|_| index.next().is_none_or(|i| !causes.contains(&i)));
        fewer
    }

    pub fn has(&self, candidate: Candidate) -> bool {
        self.causes.iter().any(|t| t.candidate == candidate)
    }

    pub fn terms(&self) -> impl Iterator<Item = &Term> {
        self.open.iter().chain(&self.causes)
    }

    /// Where the linear parameters of cause `i` are among all.
    pub fn range(&self, i: usize) -> std::ops::Range<usize> {
        let before = self.open.iter().chain(&self.causes[..i]);
        let start = before.map(|t| t.candidate.linear()).sum();
        start..start + self.causes[i].candidate.linear()
    }

    /// Takes over the values `x` of all terms, and what the causes weigh.
    fn carry(&mut self, twin: &Twin, x: &DVector<f64>) {
        let mut values = x.iter().copied();
        for term in self.open.iter_mut().chain(&mut self.causes) {
            term.linear = values.by_ref().take(term.candidate.linear()).collect();
        }
        self.laden = self.laden_with(twin, |_| true);
    }

    /// The twin's robot with known loads and those of the causes that `which` asks for.
    fn laden_with(&self, twin: &Twin, which: impl Fn(&Candidate) -> bool) -> Robot {
        let mut mechanism = Mechanism::new(twin.laden());
        let fitted = self.causes.iter().filter(|t| !t.linear.is_empty() && which(&t.candidate));
        let mut causes: Vec<&Term> = fitted.collect();
        causes.sort_by_key(|t| t.candidate.order());
        for term in causes {
            let values: Vec<f64> = term.linear.iter().chain(&term.nonlinear).copied().collect();
            term.candidate.build(&values, &mut mechanism);
        }
        mechanism.robot
    }

    /// Does one cause depend on what others weigh, or on all that the drive supplies?
    fn is_entangled(&self) -> bool {
        let loads = |t: &&Term| t.candidate.effect.about().scope != Scope::Joint;
        let follows = |t: &Term| t.candidate.effect.follows_drive();
        self.causes.iter().filter(loads).count() > 1 || self.causes.iter().any(follows)
    }
}

/// A model's columns on a recording.
pub struct Built {
    /// Recorded torque less what the twin knows, at the rows, N.m.
    pub y: Blocks,
    pub columns: Vec<Blocks>,
    /// The columns over all samples, before sensors.
    series: Vec<Vec<Vec<f64>>>,
}

impl Built {
    pub fn new(evidence: &Evidence<'_>, model: &Model) -> Self {
        let mut built = Self { y: evidence.torque.clone(), columns: vec![], series: vec![] };
        built.series = series(evidence, model);
        for column in &built.series {
            built.columns.push(shown(evidence, &model.causes, column.clone()));
        }
        let known = (0..evidence.joints()).map(|j| {
            let series = evidence.known.joint(j).to_vec();
            evidence.block(j, &sense(evidence, &model.causes, j, series))
        });
        built.y.add_scaled(-1.0, &Blocks(known.collect()));
        built
    }

    /// What the model gives at the values `x`, over all samples, N.m.
    fn modelled(&self, evidence: &Evidence<'_>, x: &DVector<f64>) -> JointSeries {
        let mut sum = evidence.known.clone();
        for (column, x) in self.series.iter().zip(x.iter()) {
            add(&mut sum, *x, column);
        }
        sum
    }
}

/// The columns of all terms over all samples, before sensors. Worked out in the order of the
/// catalogue, each with the torque of those before it, as last fitted.
fn series(evidence: &Evidence<'_>, model: &Model) -> Vec<Vec<Vec<f64>>> {
    let terms: Vec<&Term> = model.terms().collect();
    let mut order: Vec<usize> = (0..terms.len()).collect();
    order.sort_by_key(|&i| terms[i].candidate.order());
    let mut known = evidence.known.clone();
    let mut columns = vec![Vec::new(); terms.len()];
    for i in order {
        columns[i] = signature(evidence, model, terms[i], &known);
        for (column, value) in columns[i].iter().zip(&terms[i].linear) {
            add(&mut known, *value, column);
        }
    }
    columns.concat()
}

fn add(sum: &mut JointSeries, factor: f64, column: &[Vec<f64>]) {
    for (joint, series) in column.iter().enumerate() {
        sum.joint_mut(joint).iter_mut().zip(series).for_each(|(s, c)| *s += factor * c);
    }
}

/// The columns of a term where the drive supplies `known` without it.
fn signature(
    evidence: &Evidence<'_>,
    model: &Model,
    term: &Term,
    known: &JointSeries,
) -> Vec<Vec<Vec<f64>>> {
    let under;
    let robot = match term.candidate.effect.about().scope {
        Scope::Joint => &model.laden,
        _ => {
            let place = term.candidate.order();
            under = model.laden_with(evidence.twin, |c| c.order() < place);
            &under
        }
    };
    let (known, rigid) = (Some(known), evidence.rigid(robot));
    let motion = Motion { known, rigid, ..evidence.motion(robot) };
    term.series(&motion)
}

/// A model fitted to a recording.
pub struct Fit<'a, 'e> {
    pub evidence: &'a Evidence<'e>,
    pub model: Model,
    pub system: System,
    /// Sum of squares left, joint by joint, (N.m)^2.
    pub squares: Vec<f64>,
    /// What the model gives, over all samples, N.m.
    modelled: JointSeries,
    /// Where the causes weigh something.
    rigid: Rigid,
}

impl<'a, 'e> Fit<'a, 'e> {
    /// Least squares; joints are weighted by what the model leaves of them, in two rounds. Again
    /// where one cause depends on the values of another, until they agree: columns that belong to
    /// other values predict another recording badly.
    pub fn new(evidence: &'a Evidence<'e>, model: Model) -> Self {
        let mut fit = Self::once(evidence, model);
        for _ in 0..MOST_PASSES {
            if !fit.model.is_entangled() {
                break;
            }
            let before = fit.system.x.clone();
            fit = Self::once(evidence, fit.model);
            if fit.system.is_near(&before) {
                break;
            }
        }
        fit
    }

    fn once(evidence: &'a Evidence<'e>, mut model: Model) -> Self {
        let built = Built::new(evidence, &model);
        let priors = model.priors();
        let weights = evidence.weights(&built.y.squares());
        let first = System::solve(built.columns.clone(), &built.y, weights, &priors);
        let mut weights = evidence.weights(&first.residual.squares());
        if model.knows() {
            // What is known beforehand counts against independent samples.
            let shares = effective_shares(&first.residual);
            weights.iter_mut().zip(shares).for_each(|(w, share)| *w *= share);
        }
        let system = System::solve(first.columns, &built.y, weights, &priors);
        let modelled = built.modelled(evidence, &system.x);
        model.carry(evidence.twin, &system.x);
        let squares = system.residual.squares();
        let rigid = Rigid::new(evidence.joints());
        Self { evidence, model, system, squares, modelled, rigid }
    }

    /// The columns of a further candidate, as the rows show them.
    pub fn columns(&self, candidate: Candidate, nonlinear: &[f64]) -> Vec<Blocks> {
        let laden = &self.model.laden;
        let rigid = Some(self.evidence.rigid(laden).unwrap_or(&self.rigid));
        let motion = Motion { known: Some(&self.modelled), rigid, ..self.evidence.motion(laden) };
        let series = candidate.series(&motion, nonlinear);
        let sensors = &self.model.causes;
        series.into_iter().map(|column| shown(self.evidence, sensors, column)).collect()
    }

    pub fn motion(&self) -> Motion<'_> {
        self.evidence.motion(&self.evidence.twin.robot)
    }

    /// What the fitted values leave of another recording, N.m at its rows.
    pub fn held_against(&self, other: &Evidence<'_>) -> Blocks {
        let built = Built::new(other, &self.model);
        let mut residual = built.y;
        for (column, x) in built.columns.iter().zip(self.system.x.iter()) {
            residual.add_scaled(-x, column);
        }
        residual
    }

    /// The model with the twin's own friction held at zero where this fit has it push; `None` where
    /// it nowhere does.
    pub fn without_pushing(&self) -> Option<Model> {
        let mut model = self.model.clone();
        let (mut index, mut pushed) = (0, false);
        for term in &mut model.open {
            let parameters = term.candidate.effect.about().parameters.iter();
            let linear = parameters.filter(|p| p.role == Role::Linear);
            for (p, held) in linear.zip(&mut term.held) {
                let pushes = term.prior.is_empty() && p.min >= 0.0 && self.system.x[index] < p.min;
                pushed |= pushes && !*held;
                *held |= pushes;
                index += 1;
            }
        }
        pushed.then_some(model)
    }

    /// Joints where something is at work, a cause or what the twin knows, that a motor answers faster
    /// than motion is followed: what is fast there says nothing more.
    pub fn answered(&self) -> Vec<bool> {
        let known = self.evidence.twin.known().any(|e| e.outruns_motion());
        let at = |j: usize| {
            let mut causes = self.model.causes.iter().map(|t| t.candidate);
            known || causes.any(|c| c.effect.outruns_motion() && acts_on(c, j))
        };
        (0..self.squares.len()).map(at).collect()
    }

    /// Values of cause `i`: linear, then nonlinear.
    pub fn values(&self, i: usize) -> Vec<f64> {
        let linear = &self.system.x.as_slice()[self.model.range(i)];
        linear.iter().chain(&self.model.causes[i].nonlinear).copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::testing::samples;

    const GAIN: f64 = 0.2;
    const COULOMB_NM: f64 = 6.0;
    const LOAD_KG: f64 = 2.0;
    const TILT_RAD: f64 = 0.1;

    fn cause(name: &str, twin: &Twin, evidence: &Evidence<'_>) -> Term {
        let candidate = Candidate { effect: find(name).unwrap(), place: Place::Arm };
        let starts = candidate.starts(&evidence.motion(&twin.robot));
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
        let evidence = Evidence::new(&twin, &made, &floor).unwrap();
        let fit = Fit::new(&evidence, Model::of(&twin));
        assert!(fit.system.x.iter().any(|x| *x < -1.0), "{:?}", fit.system.x);
        let mut held = Fit::new(&evidence, fit.without_pushing().unwrap());
        while let Some(model) = held.without_pushing() {
            held = Fit::new(&evidence, model);
        }
        assert!(held.system.x.iter().all(|x| *x >= 0.0), "{:?}", held.system.x);
    }

    /// A gain scales friction too, and a base tilts with its load: fitted together they come out as
    /// they are, and so does the friction beside them.
    #[test]
    fn causes_that_depend_on_each_other_come_out_as_they_are() {
        let twin = Twin::default();
        let samples = recorded(&twin);
        let floor = noise_floor(&samples, &twin);
        let evidence = Evidence::new(&twin, &samples, &floor).unwrap();
        let mut model = Model::of(&twin);
        for name in ["payload", "base_tilt", "torque_constant"] {
            model = model.with(cause(name, &twin, &evidence));
        }
        // References and dependences settle.
        let mut fit = Fit::new(&evidence, model);
        for _ in 0..8 {
            let mut model = fit.model.clone();
            for term in &mut model.causes {
                let linear = term.linear.clone();
                term.candidate.effect.settle(&linear, &mut term.nonlinear);
            }
            fit = Fit::new(&evidence, model);
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
