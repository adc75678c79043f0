//! Samples + twin -> one regression problem per joint.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::error::IdentificationError;
use super::problem::{Column, Curve, JointProblem, Parameter, Reduce};
use super::terms::Terms;
use crate::effects::{self, Effect, Motion, Role, Scope};
use crate::robot::inverse_dynamics_series;
use crate::series::JointSeries;
use crate::signals::{LowPass, Rows, Samples};
use crate::twin::Twin;

/// Bounds that replace the catalogue's, by parameter name: lower and upper.
pub type BoundsByName = BTreeMap<String, [f64; 2]>;

/// All joints' problems, and what they share.
#[derive(Debug, Clone)]
pub struct ArmProblem {
    pub joints: Vec<JointProblem>,
    /// Parameters of the whole arm (payload); every joint has a column for each.
    pub shared: Vec<Parameter>,
    /// Per joint, the columns of the shared parameters.
    pub shared_columns: Vec<Vec<Vec<f64>>>,
}

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
    let robot = twin.robot.dof();
    if samples.joints() != robot {
        return Err(IdentificationError::Joints { samples: samples.joints(), robot });
    }
    let assembly = Assembly { samples, twin, terms, motion: motion(samples, twin) };
    let known = assembly.known_torque()?;
    let filter = samples.torque_filter()?;
    let mut arm = ArmProblem { joints: vec![], shared: vec![], shared_columns: vec![] };
    for joint in 0..robot {
        let rows = samples.rows(joint);
        let reduce = reduce(filter.clone(), &rows);
        arm.joints.push(assembly.joint(joint, &known, &rows, &reduce)?);
        let columns = assembly.linear(joint, Scope::Arm)?;
        arm.shared = columns.iter().map(|(p, _)| p.clone()).collect();
        arm.shared_columns.push(reduce(columns.into_iter().map(|(_, c)| c).collect()));
    }
    if arm.joints.iter().all(|j| j.samples() == 0) {
        let threshold = samples.conditioning.standstill_rad_s;
        return Err(IdentificationError::NothingSlides { threshold });
    }
    arm.set_bounds(bounds)?;
    Ok(arm)
}

fn motion<'a>(samples: &'a Samples, twin: &'a Twin) -> Motion<'a> {
    let mut motion =
        Motion::new(&twin.robot, samples.dt, &samples.q, &samples.qd, &samples.qdd);
    motion.temperature = samples.temperature.as_ref();
    motion
}

/// The same zero-phase filter for every column, then the rows in use.
fn reduce(filter: Option<LowPass>, rows: &Rows) -> Reduce {
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
    twin: &'a Twin,
    terms: &'a Terms,
    motion: Motion<'a>,
}

impl Assembly<'_> {
    /// Rigid body, rotor inertia and effects with given values, N.m.
    fn known_torque(&self) -> Result<JointSeries, IdentificationError> {
        let Motion { q, qd, qdd, .. } = self.motion;
        let mut torque = inverse_dynamics_series(&self.twin.robot, q, qd, qdd);
        for joint in 0..self.samples.joints() {
            let rotor = self.twin.drive.rotor_inertia[joint];
            if !self.terms.contains("rotor_inertia") && !self.gives("rotor_inertia") {
                super::kernels::axpy(rotor, qdd.joint(joint), torque.joint_mut(joint));
            }
            for effect in self.known_effects() {
                self.add_known(effect, joint, torque.joint_mut(joint))?;
            }
        }
        Ok(torque)
    }

    fn gives(&self, parameter: &str) -> bool {
        self.twin.values.contains_key(parameter)
    }

    /// Effects the twin models with values for all parameters, and that are not fitted.
    fn known_effects(&self) -> impl Iterator<Item = &'static dyn Effect> {
        let all_given = |e: &&'static dyn Effect| {
            let about = e.about();
            let given = about.parameters.iter().all(|p| self.gives(p.name));
            given && !self.terms.contains(about.name)
        };
        effects::CATALOGUE.iter().copied().filter(all_given)
    }

    fn add_known(
        &self,
        effect: &dyn Effect,
        joint: usize,
        torque: &mut [f64],
    ) -> Result<(), IdentificationError> {
        let about = effect.about();
        let value = |name: &str| self.value(name, joint, about.scope);
        let of_role = |role: Role| about.parameters.iter().filter(move |p| p.role == role);
        let nonlinear: Vec<f64> =
            of_role(Role::Nonlinear).map(|p| value(p.name)).collect::<Result<_, _>>()?;
        let columns = effect.columns(&self.motion, joint, &nonlinear);
        for (parameter, column) in of_role(Role::Linear).zip(&columns) {
            super::kernels::axpy(value(parameter.name)?, column, torque);
        }
        Ok(())
    }

    /// The twin's value of a parameter at a joint.
    fn value(&self, name: &str, joint: usize, scope: Scope) -> Result<f64, IdentificationError> {
        let values = self.twin.values.get(name).map_or(&[][..], Vec::as_slice);
        let (index, expected) = match scope {
            Scope::Joint => (joint, self.samples.joints()),
            Scope::Arm => (0, 1),
        };
        match values.get(index) {
            Some(&value) if values.len() == expected => Ok(value),
            _ => {
                let found = values.len();
                Err(IdentificationError::Values { name: name.into(), found, expected })
            }
        }
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
        let (parameters, columns): (Vec<_>, Vec<_>) = linear.into_iter().unzip();
        raw.extend(columns);
        let mut reduced = reduce(raw).into_iter();
        let mut next = || reduced.next().unwrap_or_default();
        let (measured, y, sign) = (next(), next(), next());
        let columns = parameters.into_iter().map(|parameter| Column { parameter, values: next() });
        Ok(JointProblem {
            joint: joint + 1,
            columns: columns.collect(),
            curve: self.curve(qd, sign, reduce),
            speed: rows.take(qd).iter().map(|w| w.abs()).collect(),
            slots: rows.slots.clone(),
            dt: self.samples.dt * rows.decimation as f64,
            measured,
            y,
        })
    }

    /// Parameters that enter linearly, and their columns at every sample. Coulomb friction is left
    /// to the Stribeck curve where one is fitted.
    fn linear(
        &self,
        joint: usize,
        scope: Scope,
    ) -> Result<Vec<(Parameter, Vec<f64>)>, IdentificationError> {
        let mut all = Vec::new();
        for effect in self.terms.with_scope(scope) {
            let about = effect.about();
            if self.curved() && ["coulomb", "stribeck"].contains(&about.name) {
                continue;
            }
            let mut nonlinear = Vec::new();
            for p in about.parameters.iter().filter(|p| p.role == Role::Nonlinear) {
                if !self.gives(p.name) {
                    return Err(IdentificationError::Nonlinear {
                        effect: about.name.into(),
                        parameter: p.name.into(),
                    });
                }
                nonlinear.push(self.value(p.name, joint, scope)?);
            }
            let linear = about.parameters.iter().filter(|p| p.role == Role::Linear);
            let columns = effect.columns(&self.motion, joint, &nonlinear);
            all.extend(linear.map(searched).zip(columns));
        }
        Ok(all)
    }

    /// Is a Stribeck velocity searched for?
    fn curved(&self) -> bool {
        self.terms.contains("stribeck") && !self.gives("stribeck_velocity")
    }

    fn curve(&self, qd: &[f64], sign: Vec<f64>, reduce: &Reduce) -> Option<Curve> {
        let coulomb = effects::find("coulomb")?.about().parameters.first()?;
        let [excess, velocity] = effects::find("stribeck")?.about().parameters else { return None };
        self.curved().then(|| Curve {
            coulomb: searched(coulomb),
            static_level: Parameter {
                name: "static".into(),
                unit: coulomb.unit.into(),
                lower: coulomb.min,
                upper: coulomb.max + excess.max,
            },
            velocity: searched(velocity),
            speed: qd.to_vec(),
            reduce: reduce.clone(),
            sign,
        })
    }
}

/// -1, 0 or 1: zero at rest.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

/// A parameter of the catalogue, with the catalogue's bounds.
fn searched(p: &effects::Parameter) -> Parameter {
    let name = if p.name == "current_offset" { "offset" } else { p.name };
    Parameter { name: name.into(), unit: p.unit.into(), lower: p.min, upper: p.max }
}

impl ArmProblem {
    /// Replaces bounds by name, in every joint.
    fn set_bounds(&mut self, by_name: &BoundsByName) -> Result<(), IdentificationError> {
        for (name, &[lower, upper]) in by_name {
            super::bounds::check(name, lower, upper)?;
            let mut found = false;
            let all = self.joints.iter_mut().flat_map(JointProblem::parameters_mut);
            for p in all.chain(&mut self.shared).filter(|p| p.name == *name) {
                (p.lower, p.upper, found) = (lower, upper, true);
            }
            if !found {
                let known = self.parameter_names().join(", ");
                return Err(IdentificationError::UnknownBound { name: name.clone(), known });
            }
        }
        Ok(())
    }

    fn parameter_names(&self) -> Vec<&str> {
        let joint = self.joints.first().map_or(vec![], JointProblem::parameters);
        joint.into_iter().chain(&self.shared).map(|p| p.name.as_str()).collect()
    }
}
