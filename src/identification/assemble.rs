//! Samples + twin -> one regression problem per joint.

use std::sync::Arc;

use super::arm_problem::{ArmProblem, BoundsByName, at_joint, searched};
use super::error::IdentificationError;
use super::located::Located;
use super::problem::{Curve, JointProblem, Parameter, Reduce};
use super::regressors::{Regressor, columns_of};
use super::terms::Terms;
use super::{separable, shared};
use crate::effects::{
    self, About, CATALOGUE, Effect, Mechanism, Motion, Role, Scope, Seen, Size, Transmission,
};
use crate::robot::Robot;
use crate::series::JointSeries;
use crate::signals::{ALIKE, LowPass, Rows, Samples, cycle};
use crate::statistics::Cycle;
use crate::twin::Twin;

/// Builds the problems for the effects in `terms`. What the twin gives values for, and its drive's
/// rotor inertia unless that is fitted, is subtracted from the torque with the rigid body.
///
/// # Errors
/// If robot and recording differ in joints, a term needs a parameter that cannot be searched for,
/// nothing slides, or bounds are wrong.
pub fn assemble(
    samples: &Samples,
    twin: &Twin,
    terms: &Terms,
    bounds: &BoundsByName,
) -> Result<ArmProblem, IdentificationError> {
    assemble_around(samples, twin, terms, bounds, &[])
}

/// Builds the problems where nonlinear parameters were `located` by a search: the twin has their values, and
/// they are fitted along from there.
///
/// # Errors
/// As [`assemble`].
pub fn assemble_around(
    samples: &Samples,
    twin: &Twin,
    terms: &Terms,
    bounds: &BoundsByName,
    located: &[Located],
) -> Result<ArmProblem, IdentificationError> {
    let robot = twin.robot.dof();
    if samples.joints() != robot {
        return Err(IdentificationError::Joints { samples: samples.joints(), robot });
    }
    let samples = &twin.correct(samples);
    let mut arm = assemble_on(samples, twin, terms, twin, located)?;
    let open = open_references(twin, terms);
    let entangled = terms.contains("load_friction") || give_way(terms) || !open.is_empty();
    if !arm.shared.is_empty() && entangled {
        // Gears carry the load that is being fitted, too, joints that give way pull at each other,
        // and references follow what is fitted: once more with all that.
        let found = shared::solve(&arm, &separable::Settings::default())?;
        let fitted = with_shared(twin, terms, &arm.shared, &found);
        let mut settled = twin.clone();
        settled.values.extend(open.iter().filter_map(|(e, p)| settled_on(&fitted, *e, p)));
        arm = assemble_on(samples, &settled, terms, &fitted, located)?;
    }
    if arm.joints.iter().all(|j| j.samples() == 0) {
        let threshold = samples.conditioning.standstill_rad_s;
        return Err(IdentificationError::NothingSlides { threshold });
    }
    arm.set_bounds(bounds)?;
    Ok(arm)
}

/// Are there effects whose columns at one joint hang on their values at others?
fn give_way(terms: &Terms) -> bool {
    let referred = |e: &dyn Effect| e.about().parameters.iter().any(|p| p.is_reference());
    terms.with_scope(Scope::Link).any(referred)
}

/// References of effects to be fitted that the twin leaves open.
fn open_references(twin: &Twin, terms: &Terms) -> Vec<(&'static dyn Effect, &'static str)> {
    let effects = terms.names().into_iter().filter_map(effects::find);
    let of = |e: &'static dyn Effect| e.about().parameters.iter().map(move |p| (e, p));
    let open = |p: &effects::Parameter| p.is_reference() && !twin.values.contains_key(p.name);
    effects.flat_map(of).filter(|(_, p)| open(p)).map(|(e, p)| (e, p.name)).collect()
}

/// What a reference is in a twin that knows everything else of its effect.
fn settled_on(fitted: &Twin, effect: &dyn Effect, name: &str) -> Option<(String, Vec<f64>)> {
    let about = effect.about();
    let place = about.parameters.iter().position(|p| p.name == name)?;
    let joints = if about.scope == Scope::Arm { 1 } else { fitted.robot.dof() };
    let at = |joint| Some(*fitted.values_at(effect, joint)?.get(place)?);
    Some((name.to_string(), (0..joints).map(at).collect::<Option<_>>()?))
}

/// The problems on the arm with the loads that `built` knows.
fn assemble_on(
    samples: &Samples,
    twin: &Twin,
    terms: &Terms,
    built: &Twin,
    located: &[Located],
) -> Result<ArmProblem, IdentificationError> {
    let known = known_torque(samples, twin, terms);
    let motion = Motion { known: Some(&known), ..twin.motion(samples) };
    let laden = &built.laden();
    let size = Size::of(&twin.robot);
    let cycle = cycle(samples, ALIKE);
    let assembly = Assembly { samples, cycle, twin, terms, built, laden, motion, located, size };
    let filter = samples.torque_filter()?;
    let reaching = assembly.reaching()?;
    let mut arm = ArmProblem { joints: vec![], shared: vec![], shared_columns: vec![] };
    for joint in 0..twin.robot.dof() {
        let rows = samples.rows(joint);
        let reduce = reduce(filter.clone(), &rows);
        arm.joints.push(assembly.joint(joint, &known, &rows, &reduce)?);
        let mut regressors = assembly.linear(joint, Scope::Arm)?;
        let samples = samples.len();
        regressors.extend(reaching.iter().map(|r| r.at(joint, samples)));
        let reduced = reduce(regressors.iter().map(|r| r.series.clone()).collect());
        let y = &mut arm.joints[joint].y;
        let columns = columns_of(regressors, reduced.into_iter(), y);
        arm.shared = columns.iter().map(|c| c.parameter.clone()).collect();
        arm.shared_columns.push(columns.into_iter().map(|c| c.values).collect());
    }
    Ok(arm)
}

/// `twin` with `values` for the parameters that all joints share.
pub(super) fn with_shared(
    twin: &Twin,
    terms: &Terms,
    shared: &[Parameter],
    values: &[f64],
) -> Twin {
    let mut fitted = twin.clone();
    let dof = twin.robot.dof();
    let found = |name: &str| {
        let place = shared.iter().position(|p| p.name == name);
        place.and_then(|i| values.get(i)).copied()
    };
    for effect in terms.with_scope(Scope::Arm).chain(terms.with_scope(Scope::Link)) {
        for p in effect.about().parameters {
            let values: Option<Vec<f64>> = match effect.about().scope {
                Scope::Link => {
                    let each: Vec<_> = (0..dof).map(|j| found(&at_joint(p.name, j))).collect();
                    let absent = |j: usize| {
                        let known = twin.values.get(p.name).and_then(|v| v.get(j)).copied();
                        known.unwrap_or(if p.role == Role::Linear { p.null } else { p.typical })
                    };
                    let all = each.iter().enumerate().map(|(j, v)| v.unwrap_or_else(|| absent(j)));
                    each.iter().any(Option::is_some).then(|| all.collect())
                }
                _ => found(p.name).map(|value| vec![value]),
            };
            fitted.values.extend(values.map(|values| (p.name.to_string(), values)));
        }
        if !fitted.effects.iter().any(|name| name == effect.about().name) {
            fitted.effects.push(effect.about().name.into());
        }
    }
    fitted
}

/// What the twin knows, N.m: rigid body, rotor inertia, effects with given values; without what is
/// fitted.
fn known_torque(samples: &Samples, twin: &Twin, terms: &Terms) -> JointSeries {
    let mut twin = twin.clone();
    terms.effects().for_each(|effect| twin.forget(effect));
    twin.torque(&twin.motion(samples))
}

/// One zero-phase filter for all columns, then the rows in use.
pub(super) fn reduce(filter: Option<LowPass>, rows: &Rows) -> Reduce {
    let rows = rows.clone();
    Arc::new(move |mut columns| {
        if let Some(filter) = &filter {
            filter.apply_many(&mut columns);
        }
        columns.iter().map(|c| rows.take(c)).collect()
    })
}

/// What all joints are assembled from.
struct Assembly<'a> {
    samples: &'a Samples,
    /// Samples after which the motion comes again.
    cycle: Option<usize>,
    twin: &'a Twin,
    terms: &'a Terms,
    built: &'a Twin,
    /// The robot as its gears carry it.
    laden: &'a Robot,
    motion: Motion<'a>,
    located: &'a [Located],
    size: Size,
}

impl Assembly<'_> {
    fn gives(&self, parameter: &str) -> bool {
        self.twin.values.contains_key(parameter)
    }

    fn joint(
        &self,
        joint: usize,
        known: &JointSeries,
        rows: &Rows,
        reduce: &Reduce,
    ) -> Result<JointProblem, IdentificationError> {
        let qd = self.samples.qd.joint(joint);
        let torque = self.samples.torque.joint(joint);
        let left = torque.iter().zip(known.joint(joint)).map(|(t, k)| t - k).collect();
        let linear = self.linear(joint, Scope::Joint)?;
        let sign = qd.iter().map(|&w| sign(w)).collect();
        let mut raw = vec![torque.to_vec(), left, sign];
        raw.extend(linear.iter().map(|r| r.series.clone()));
        let mut reduced = reduce(raw).into_iter();
        let mut next = || reduced.next().unwrap_or_default();
        let (measured, mut y, sign) = (next(), next(), next());
        let columns = columns_of(linear, reduced, &mut y);
        Ok(JointProblem {
            joint: joint + 1,
            columns,
            curve: self.curve(joint, qd, sign, reduce),
            speed: rows.take(qd).iter().map(|w| w.abs()).collect(),
            slots: rows.slots.clone(),
            cycle: self.cycle(rows),
            dt: self.samples.dt * rows.decimation as f64,
            measured,
            y,
        })
    }

    /// In slots of these rows.
    fn cycle(&self, rows: &Rows) -> Option<Cycle> {
        let lag = self.cycle?;
        let slots = (lag as f64 / rows.decimation as f64).round() as usize;
        Some(Cycle { slots, count: self.samples.len() as f64 / lag as f64 })
    }

    /// Parameters that enter linearly, and their columns at every sample. Coulomb friction is left
    /// to the Stribeck curve where one is fitted.
    fn linear(&self, joint: usize, scope: Scope) -> Result<Vec<Regressor>, IdentificationError> {
        let mut all = Vec::new();
        for effect in self.terms.with_scope(scope) {
            let about = effect.about();
            if self.curved() && ["coulomb", "stribeck"].contains(&about.name) {
                continue;
            }
            let nonlinear = self.nonlinear(about, joint)?;
            if effect.seen() != Seen::Columns {
                return Err(IdentificationError::Unseen { effect: about.name.into() });
            }
            let under;
            let robot = if scope == Scope::Joint {
                self.laden
            } else {
                under = self.under(effect);
                &under
            };
            let motion = Motion { robot, ..self.motion };
            let linear = about.parameters.iter().filter(|p| p.role == Role::Linear);
            let from = if scope == Scope::Arm { 0 } else { joint };
            let columns = |n: &[f64]| effect.columns(&motion, joint, n);
            match self.located(effect, from) {
                Some(l) if l.shows() => {
                    all.extend(Regressor::of_tangent(l.tangent(&self.size, columns)))
                }
                Some(_) => {}
                None => {
                    let each = linear.zip(columns(&nonlinear));
                    let fitted = each.filter(|(p, _)| self.terms.tells(p));
                    let found = |(p, c)| Regressor::linear(searched(p, &self.size), c);
                    all.extend(fitted.map(found));
                }
            }
        }
        Ok(all)
    }

    /// The robot with the loads that are known, and those of the terms before this one: a base
    /// tilts with the payload on it.
    fn under(&self, effect: &dyn Effect) -> Robot {
        let before = |e: &dyn Effect| {
            !self.terms.contains(e.about().name) || effects::order(e) < effects::order(effect)
        };
        self.built.mechanism(before).robot
    }

    /// Parameters of single joints that all joints feel, and their torque everywhere.
    fn reaching(&self) -> Result<Vec<Regressor>, IdentificationError> {
        let mut all = Vec::new();
        for effect in self.terms.with_scope(Scope::Link) {
            let about = effect.about();
            let robot = &self.under(effect);
            for from in 0..self.twin.robot.dof() {
                let giving = &self.giving(effect, from);
                let motion = Motion { robot, giving, ..self.motion };
                let nonlinear = self.nonlinear(about, from)?;
                let linear = about.parameters.iter().filter(|p| p.role == Role::Linear);
                let named = |p: Parameter| Parameter { name: at_joint(&p.name, from), ..p };
                let reach = |n: &[f64]| -> Vec<Vec<f64>> {
                    effect.reach(&motion, from, n).iter().map(in_a_row).collect()
                };
                let mut own = match self.located(effect, from) {
                    Some(l) if l.shows() => Regressor::of_tangent(l.tangent(&self.size, reach)),
                    Some(_) => vec![],
                    None => {
                        let each = linear.map(|p| searched(p, &self.size)).zip(reach(&nonlinear));
                        each.map(|(p, c)| Regressor::linear(p, c)).collect()
                    }
                };
                own.iter_mut().for_each(|r| r.parameter = r.parameter.take().map(named));
                all.extend(own);
            }
        }
        Ok(all)
    }

    /// What gives way already where an effect at a joint comes to it, in the order of the catalogue
    /// and from the base.
    fn giving(&self, effect: &dyn Effect, from: usize) -> Vec<Option<Transmission>> {
        let mut mechanism = Mechanism::new(self.twin.robot.clone());
        let place = effects::order(effect);
        for before in CATALOGUE[..=place].iter().filter(|e| e.about().scope == Scope::Link) {
            let end = if effects::order(*before) == place { from } else { self.twin.robot.dof() };
            for joint in 0..end {
                if let Some(values) = self.values_at(*before, joint) {
                    before.build(&values, joint, &mut mechanism);
                }
            }
        }
        mechanism.transmission
    }

    /// Values as located, or else as known or fitted before.
    fn values_at(&self, effect: &dyn Effect, joint: usize) -> Option<Vec<f64>> {
        match self.located(effect, joint) {
            Some(l) => Some([&l.linear[..], &l.nonlinear].concat()),
            None if self.knows_or_fits(effect) => self.built.values_at(effect, joint),
            None => None,
        }
    }

    fn knows_or_fits(&self, effect: &dyn Effect) -> bool {
        self.built.effects.iter().any(|name| name == effect.about().name)
    }

    fn located(&self, effect: &dyn Effect, joint: usize) -> Option<&Located> {
        let here = |l: &&Located| l.effect.about().name == effect.about().name && l.joint == joint;
        self.located.iter().find(here)
    }

    /// Values the twin gives for an effect's nonlinear parameters.
    fn nonlinear(&self, about: &About, joint: usize) -> Result<Vec<f64>, IdentificationError> {
        let at = if about.scope == Scope::Arm { 0 } else { joint };
        let given = |p: &effects::Parameter| {
            let value = self.twin.values.get(p.name).and_then(|v| v.get(at)).copied();
            value.or(p.left_out()).ok_or_else(|| IdentificationError::Nonlinear {
                effect: about.name.into(),
                parameter: p.name.into(),
            })
        };
        about.parameters.iter().filter(|p| p.role == Role::Nonlinear).map(given).collect()
    }

    /// Is a Stribeck velocity searched for?
    fn curved(&self) -> bool {
        self.terms.contains("stribeck") && !self.gives("stribeck_velocity")
    }

    fn curve(&self, joint: usize, qd: &[f64], sign: Vec<f64>, reduce: &Reduce) -> Option<Curve> {
        let coulomb = effects::find("coulomb")?.about().parameters.first()?;
        let [excess, velocity, exponent] = effects::find("stribeck")?.about().parameters else {
            return None;
        };
        let given = self.twin.values.get(exponent.name).and_then(|v| v.get(joint));
        self.curved().then(|| Curve {
            coulomb: searched(coulomb, &self.size),
            static_level: Parameter {
                name: "static".into(),
                unit: coulomb.unit.into(),
                lower: coulomb.on(&self.size).min,
                upper: coulomb.on(&self.size).max + excess.on(&self.size).max,
            },
            velocity: searched(velocity, &self.size),
            exponent: given.copied().unwrap_or(exponent.typical),
            speed: qd.to_vec(),
            reduce: reduce.clone(),
            sign,
        })
    }
}

/// Joint after joint.
fn in_a_row(series: &JointSeries) -> Vec<f64> {
    (0..series.joints()).flat_map(|j| series.joint(j).to_vec()).collect()
}

/// -1, 0 or 1: zero at rest.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}
