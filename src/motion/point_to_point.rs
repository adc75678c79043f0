//! Moves between random poses with rests, as an operator's program would make them.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::path::Path;

const REST_S: f64 = 0.4;

/// Random poses in the envelope at 30 to 100 % of the pace it allows.
pub(super) fn point_to_point(path: &mut Path, until: f64, rng: &mut ChaCha8Rng) {
    loop {
        let pose = path.envelope.random_pose(1.0, rng);
        let haste = rng.random_range(0.3..1.0);
        if !path.go(pose, haste, until - REST_S) {
            return path.rest_until(until);
        }
        path.rest_until(path.now + REST_S);
    }
}
