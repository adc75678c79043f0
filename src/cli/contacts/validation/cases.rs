//! The recordings, what is fitted to them, and what is known of them.

use std::path::{Path, PathBuf};

use super::super::arm::Source;
use crate::recording::{self, RecordingError};
use crate::twin::{Twin, TwinError};

/// An arm whose recordings lie in one folder.
#[derive(Clone, Copy)]
pub struct Setup {
    folder: &'static str,
    twin: (&'static str, &'static str),
    /// In place of the twin's, N.m/A.
    torque_constant: Option<[f64; 6]>,
    /// Fitted besides what the twin leaves open.
    pub with: &'static [&'static str],
    columns: Option<&'static str>,
    /// After the name of a recording.
    extension: &'static str,
}

#[derive(Clone, Copy)]
pub struct Case {
    pub setup: Setup,
    pub recording: &'static str,
    pub fit: &'static str,
    /// s after the start.
    pub known: &'static [[f64; 2]],
}

const UR5: Setup = Setup {
    folder: "kkufieta-ur5_modeling_force_estimate",
    twin: ("scenarios/twins/ur5.toml", include_str!("../../../../scenarios/twins/ur5.toml")),
    torque_constant: None,
    with: &["rotor_inertia", "load_friction", "payload", "offset"],
    columns: None,
    extension: "",
};

/// Desired torque over desired current at rest is 10.706, 10.667 and 10.208 N.m/A at joints 2 to 4;
/// joint 1 has the motor of joint 2, joints 5 and 6 that of joint 4. Divided by the gear ratio.
const CONTROLLERS: [f64; 6] = [0.1060, 0.1060, 0.1056, 0.1011, 0.1011, 0.1011];

const UR10E: Setup = Setup {
    folder: "shamilmamedov-dynamic_calibration",
    twin: ("scenarios/twins/ur10e.toml", include_str!("../../../../scenarios/twins/ur10e.toml")),
    torque_constant: None,
    with: &["load_friction"],
    columns: Some("scenarios/columns/ur10e_shamilmamedov.toml"),
    extension: ".csv.gz",
};

const COLLISION: Setup = Setup {
    columns: Some("scenarios/columns/ur10e_shamilmamedov_collision.toml"),
    with: &["load_friction", "offset"],
    ..UR10E
};

const LONG: &str = "Movement_No6_Acc_slow_Verify_Model";

/// The recording with the force sensor.
pub const PLAIN: Case = Case {
    setup: UR5,
    recording: "Movement_No10_Standstill_ForceSensor_All",
    fit: LONG,
    known: &[],
};

pub const FLANGE: Case =
    Case { setup: Setup { torque_constant: Some(CONTROLLERS), ..UR5 }, ..PLAIN };

/// Known as far as a model fitted to the undisturbed path errs: an estimate, and not all of them.
pub const NAMED: &[Case] = &[
    Case {
        setup: COLLISION,
        recording: "collision_detection_data/collision_2link",
        fit: "collision_detection_data/collision_free",
        known: &[[2.0, 2.3], [10.2, 10.5], [18.4, 19.0], [27.1, 27.5], [32.0, 32.5], [52.6, 53.1]],
    },
    Case {
        setup: UR5,
        recording: "Movement_No5_Acc_slow_w_disturbance",
        fit: LONG,
        known: &[[12.6, 13.1], [19.0, 19.4], [24.9, 25.1]],
    },
    Case {
        setup: UR5,
        recording: "Movement_No7_Acc_slow_Verify_Model_short_with_disturbance",
        fit: LONG,
        known: &[[12.0, 12.8], [15.8, 16.3], [18.6, 19.2]],
    },
];

const fn untouched(setup: Setup, recording: &'static str, fit: &'static str) -> Case {
    Case { setup, recording, fit, known: &[] }
}

pub const UNTOUCHED: &[Case] = &[
    untouched(UR5, "Movement_No5_Acc_slow_no_disturbance", LONG),
    untouched(UR5, "Movement_No7_Acc_slow_Verify_Model_short", LONG),
    untouched(UR5, LONG, "Movement_No7_Acc_slow_Verify_Model_short"),
    untouched(UR5, "Movement_No4_Acc", LONG),
];

const UNLOADED: [&str; 7] = [
    "identification_data/ur-20_01_31-unload",
    "identification_data/ur-20_02_05-20sec_8harm",
    "identification_data/ur-20_02_06-20sec_5harm",
    "identification_data/ur-20_02_06-20sec_10harm",
    "identification_data/ur-20_02_10-30sec_12harm",
    "identification_data/ur-20_02_12-40sec_12harm",
    "identification_data/ur-20_02_19_14harm50sec",
];

/// Every unloaded recording of the UR10e against every other.
pub fn unloaded() -> Vec<Case> {
    let against = |fit: &'static str| {
        let others = UNLOADED.into_iter().filter(move |other| *other != fit);
        others.map(move |other| untouched(UR10E, other, fit))
    };
    UNLOADED.into_iter().flat_map(against).collect()
}

pub fn twin(setup: &Setup) -> Result<Twin, TwinError> {
    let (file, text) = setup.twin;
    let mut twin = Twin::parse(text, Path::new(file))?;
    if let Some(constant) = setup.torque_constant {
        twin.drive.torque_constant = constant.to_vec();
    }
    Ok(twin)
}

pub fn path(folder: &Path, setup: &Setup, recording: &str) -> PathBuf {
    folder.join(setup.folder).join(format!("{recording}{}", setup.extension))
}

pub fn source(folder: &Path, setup: &Setup, name: &str) -> Result<Source, RecordingError> {
    let path = path(folder, setup, name);
    let recording = recording::read(&path, setup.columns.map(Path::new))?;
    Ok(Source::of(path, recording))
}
