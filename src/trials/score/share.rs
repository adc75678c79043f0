//! How many of how many, with an interval.

use serde::Serialize;

/// Two-sided 95 % quantile of the normal distribution.
const Z: f64 = 1.959_964;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Share {
    pub hits: usize,
    pub of: usize,
}

impl Share {
    pub fn count<'a, T: 'a>(
        all: impl IntoIterator<Item = &'a T>,
        hit: impl Fn(&T) -> bool,
    ) -> Self {
        all.into_iter().fold(Self::default(), |share, x| Self {
            hits: share.hits + usize::from(hit(x)),
            of: share.of + 1,
        })
    }

    /// Hits over cases; `None` where there are no cases.
    pub fn value(self) -> Option<f64> {
        (self.of > 0).then(|| self.hits as f64 / self.of as f64)
    }

    /// 95 % interval (Wilson, *Probable inference*, JASA 22, 1927).
    pub fn interval(self) -> (f64, f64) {
        let Some(p) = self.value() else { return (0.0, 1.0) };
        let n = self.of as f64;
        let spread = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
        let centre = p + Z * Z / (2.0 * n);
        let scale = 1.0 + Z * Z / n;
        (((centre - spread) / scale).max(0.0), ((centre + spread) / scale).min(1.0))
    }
}

/// `.95 (38/40, .83-.99)`
impl std::fmt::Display for Share {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Some(value) = self.value() else { return write!(f, "-") };
        let (low, high) = self.interval();
        write!(f, "{value:.2} ({}/{}, {low:.2}-{high:.2})", self.hits, self.of)
    }
}
