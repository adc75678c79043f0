//! Robot + effects + motion -> recording: ground truth from rapier (f64 multibody).
