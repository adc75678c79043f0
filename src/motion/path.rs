//! A trajectory under construction.

use super::Envelope;
use super::trajectory::{Piece, STEP_PEAK, Shape, Trajectory};

/// Pieces so far, the pose they end in and the time.
pub(super) struct Path<'a> {
    pub envelope: &'a Envelope,
    pub here: Vec<f64>,
    pub now: f64,
    pieces: Vec<Piece>,
    starts: Vec<f64>,
}

impl<'a> Path<'a> {
    pub fn from_centre(envelope: &'a Envelope) -> Self {
        let here = envelope.centre.clone();
        Self { envelope, here, now: 0.0, pieces: vec![], starts: vec![] }
    }

    /// Appends a stretch that ends in the pose it begins with.
    pub fn push(&mut self, duration: f64, shape: Shape) {
        self.starts.push(self.now);
        self.pieces.push(Piece { duration, from: self.here.clone(), shape });
        self.now += duration;
    }

    pub fn rest_until(&mut self, until: f64) {
        if until > self.now {
            self.push(until - self.now, Shape::Move { by: vec![0.0; self.here.len()] });
        }
    }

    /// Moves to a pose at `haste` (0 to 1) times the fastest pace that the envelope allows.
    /// Returns false, and stays, if that takes longer than `until`.
    pub fn go(&mut self, to: Vec<f64>, haste: f64, until: f64) -> bool {
        let by: Vec<f64> = to.iter().zip(&self.here).map(|(b, a)| b - a).collect();
        let duration = self.fastest(&by) / haste;
        if self.now + duration > until {
            return false;
        }
        self.push(duration, Shape::Move { by });
        self.here = to;
        true
    }

    /// Seconds for a move that reaches the velocity or the acceleration limit of one joint.
    fn fastest(&self, by: &[f64]) -> f64 {
        let limits = self.envelope.velocity.iter().zip(&self.envelope.acceleration);
        let each = by.iter().zip(limits).map(|(by, (v, a))| {
            (STEP_PEAK[0] * by.abs() / v).max((STEP_PEAK[1] * by.abs() / a).sqrt())
        });
        each.fold(0.1, f64::max)
    }

    pub fn finish(self) -> Trajectory {
        Trajectory { pieces: self.pieces, starts: self.starts, duration: self.now }
    }
}
