//! How a recording is conditioned for a diagnosis, where its user does not say.

use crate::recording::Recording;
use crate::signals::{Conditioning, Derivatives};

/// Instants from which on a recording is low-passed and thinned in any case: its torque at full rate
/// says little more about slow causes, and costs its length at every candidate.
const LONG: usize = 9000;

/// Guard beside standstill where the torque is low-passed, s.
pub(super) const GUARD_S: f64 = 0.04;
/// Guard where it is not low-passed, s: the first sample that slides again is half a standing one.
const SHARP_GUARD_S: f64 = 0.008;

/// Where a command of all `dof` joints is recorded with its derivatives, motion is that command
/// plus the smoothed tracking error: hardly any differentiation noise, so the torque need not be
/// filtered and reversals stay sharp. Then nothing smears the torque of a standing joint, and what
/// friction does before it slides shows right beside standstill. Else the defaults of a regression
/// on measured positions.
pub fn conditioning(recording: &Recording, dof: usize) -> Conditioning {
    let commanded =
        |stem: &str| (0..dof).all(|j| recording.channel(&format!("{stem}_{j}")).is_some());
    if !["target_q", "target_qd", "target_qdd"].into_iter().all(commanded) {
        return Conditioning::default();
    }
    let sharp = Conditioning {
        derivatives: Derivatives::TrackingError,
        motion_cutoff_hz: 10.0,
        standstill_cutoff_hz: 20.0,
        torque_cutoff_hz: 0.0,
        standstill_rad_s: 0.03,
        guard_s: SHARP_GUARD_S,
        ..Conditioning::default()
    };
    match recording.time.len() > LONG {
        true => Conditioning {
            torque_cutoff_hz: Conditioning::default().torque_cutoff_hz,
            guard_s: GUARD_S,
            ..sharp
        },
        false => sharp,
    }
}
