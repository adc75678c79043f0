//! What is watched for a change: a joint's gap over some seconds of sliding, in three numbers.

/// Along the motion (friction), in itself (gravity, offsets), and its size in whatever direction.
pub const FEATURES: [&str; 3] = ["along the motion", "one-sided", "size"];

/// Sliding time in a block, s: long against the residual's memory, short against a minute.
pub const BLOCK_S: f64 = 4.0;

/// A block in the making.
#[derive(Debug, Clone, Copy, Default)]
pub struct Block {
    samples: f64,
    along: f64,
    sum: f64,
    squares: f64,
    /// Time of the first sample, s.
    pub begins: f64,
}

impl Block {
    /// Adds the gap, N.m, at `time`; the features of the block if that makes it whole.
    pub fn add(
        &mut self,
        time: f64,
        left: f64,
        direction: f64,
        dt: f64,
    ) -> Option<(f64, [f64; 3])> {
        if self.samples == 0.0 {
            self.begins = time;
        }
        self.samples += 1.0;
        self.along += left * direction;
        self.sum += left;
        self.squares += left * left;
        if self.samples * dt < BLOCK_S - 0.5 * dt {
            return None;
        }
        let Self { samples: n, along, sum, squares, begins } = std::mem::take(self);
        // A gap of exactly nothing is that of a recording without noise: no logarithm of it.
        let size = 0.5 * (squares / n).max(f64::MIN_POSITIVE).ln();
        Some((begins, [along / n, sum / n, size]))
    }
}
