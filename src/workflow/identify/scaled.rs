//! The drives' torque constants by a load that is known.

use super::{INERTIA, Identify};
use crate::identification::{Load, Terms, TorqueScale, torque_scale};
use crate::recording::{Provenance, Recording, refuse_same};
use crate::signals::{Conditioning, Samples};
use crate::twin::Twin;
use crate::workflow::{Arm, Prepared, WorkflowError, conditioned};

/// A load at the flange.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownLoad {
    pub mass_kg: f64,
    /// Centre of its mass in the flange's frame, m; `None`: found along.
    pub centre_m: Option<[f64; 3]>,
}

/// What was found, and what became of the twin.
pub struct Scaled {
    pub scale: TorqueScale,
    pub twin: Twin,
    pub loaded: Provenance,
    pub note: Option<String>,
}

impl Identify {
    /// The twin with torque constants of its own arm.
    pub(super) fn scaled(
        &self,
        arm: &Arm,
        terms: &Terms,
        (fit, samples): (&Recording, &Samples),
        (loaded, load): (&Prepared<'_>, KnownLoad),
        how: &Conditioning,
    ) -> Result<Scaled, WorkflowError> {
        self.refuse_unknown_loads()?;
        refuse_same(fit, loaded)?;
        let twin = &arm.twin;
        let loaded_samples = conditioned(loaded, twin, how)?;
        let load = Load { mass_kg: load.mass_kg, centre_m: load.centre_m };
        let scale = torque_scale(twin, terms, [samples, &loaded_samples], load)
            .map_err(|e| WorkflowError::from(e).at(&loaded.provenance.source))?;
        let (twin, note) = corrected(twin, &scale, fit);
        Ok(Scaled { scale, twin, loaded: loaded.provenance.clone(), note })
    }

    /// # Errors
    /// Names what is fitted and cannot be told from the load.
    pub fn refuse_unknown_loads(&self) -> Result<(), WorkflowError> {
        let unknown = ["payload", "link_inertia", "torque_constant"];
        let asked = self.with.iter().chain(&self.terms);
        match asked.into_iter().find(|name| unknown.contains(&name.as_str())) {
            Some(name) => Err(WorkflowError::Asked(format!(
                "with a loaded run the load is known, and links and torque constants are found along; \
                 leave `{name}` out (`{INERTIA}` is welcome)"
            ))),
            None => Ok(()),
        }
    }
}

/// The drive with what is told; the twin's own constants elsewhere.
fn corrected(twin: &Twin, scale: &TorqueScale, fit: &Recording) -> (Twin, Option<String>) {
    if fit.channel("joint_torque_0").is_some() {
        let note = "the recording holds joint torque, not current: the gains are its sensors', and \
                    the twin's drive stays as it is";
        return (twin.clone(), Some(note.into()));
    }
    let mut new = twin.clone();
    let told = scale.joints.iter().zip(&mut new.drive.torque_constant);
    told.filter(|(gain, _)| gain.identifiable).for_each(|(gain, k)| *k *= gain.value);
    (new, None)
}
