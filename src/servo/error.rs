//! What can keep an arm of servos from being simulated along a recording.

use crate::diagnosis::DiagnosisError;
use crate::follow::Interrupted;
use crate::signals::SignalError;
use crate::statistics::StatisticsError;

/// A message says what is missing and what to do about it. Joints count from 1.
#[derive(Debug, thiserror::Error)]
pub enum ServoError {
    #[error(transparent)]
    Signals(#[from] SignalError),
    #[error(transparent)]
    Statistics(#[from] StatisticsError),
    #[error(transparent)]
    Diagnosis(#[from] DiagnosisError),
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    #[error(
        "the twin says nothing of position servos, by which a recording without torque is simulated: give \
         it a [servo] table, for example model = \"sts3215\""
    )]
    NoServo,
    #[error(
        "the recording holds motor torque or current, of which a simulation makes no use here: leave the \
         method out, or say --by torque"
    )]
    NotTold,
    #[error(
        "joint {joint} gives way between motor and link: that needs a rotor_inertia above 0 in the twin's \
         [drive], and a stiffness above 0"
    )]
    Elastic { joint: usize },
    #[error("`{name}`: {problem}")]
    Term { name: String, problem: String },
    #[error(
        "joint {joint} runs away {time_s:.3} s into the simulation: check its gain, rotor_inertia and the \
         links' masses"
    )]
    Diverged { joint: usize, time_s: f64 },
    #[error("{seconds:.1} s of the recording can be used: at least {needed:.1} s are needed")]
    TooShort { seconds: f64, needed: f64 },
    #[error("nothing is left open to fit: name effects with --terms or --with")]
    NothingToFit,
}

impl From<ServoError> for DiagnosisError {
    fn from(error: ServoError) -> Self {
        match error {
            ServoError::Diagnosis(error) => error,
            ServoError::Interrupted(interrupted) => interrupted.into(),
            other => Self::Proof(Box::new(other)),
        }
    }
}
