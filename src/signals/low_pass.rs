//! Zero-phase Butterworth low-pass.

use std::f64::consts::PI;

use super::SignalError;

/// Columns filtered side by side: the recursion is serial in time, so lanes are the axis to
/// vectorise.
const LANES: usize = 8;
const MAX_ORDER: usize = 12;

/// Butterworth low-pass run forward and backward (twice the order, no phase), second-order
/// sections in transposed direct form II. The ends are padded by odd reflection and the state
/// starts in the steady state of the first padded sample, as in Gustafsson, "Determining the
/// initial states in forward-backward filtering", IEEE Transactions on Signal Processing 44(4),
/// 1996, and in scipy's `sosfiltfilt`, whose numbers it repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct LowPass {
    cutoff_hz: f64,
    sections: Vec<Section>,
}

/// y[k] = b0 x[k] + z1, z1 = b1 x[k] - a1 y[k] + z2, z2 = b2 x[k] - a2 y[k]
#[derive(Debug, Clone, Copy, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

impl LowPass {
    /// `cutoff_hz` is the -3 dB point of one pass (-6 dB of both), below half of `rate_hz`.
    pub fn new(cutoff_hz: f64, rate_hz: f64, order: usize) -> Result<Self, SignalError> {
        let limit_hz = 0.5 * rate_hz;
        if !(cutoff_hz > 0.0 && cutoff_hz < limit_hz) {
            return Err(SignalError::Cutoff { cutoff_hz, rate_hz, limit_hz });
        }
        if !(1..=MAX_ORDER).contains(&order) {
            return Err(SignalError::FilterOrder { order });
        }
        Ok(Self { cutoff_hz, sections: butterworth(cutoff_hz / rate_hz, order) })
    }

    /// `None` for a cutoff of 0.
    pub fn if_wanted(
        cutoff_hz: f64,
        rate_hz: f64,
        order: usize,
    ) -> Result<Option<Self>, SignalError> {
        match cutoff_hz == 0.0 {
            true => Ok(None),
            false => Self::new(cutoff_hz, rate_hz, order).map(Some),
        }
    }

    pub fn cutoff_hz(&self) -> f64 {
        self.cutoff_hz
    }

    /// Samples of odd reflection at each end (scipy's default).
    pub fn padding(&self) -> usize {
        let first_order = self.sections.iter().filter(|s| s.a[1] == 0.0).count();
        3 * (2 * self.sections.len() + 1 - first_order)
    }

    /// Filters in place; a signal of up to [`LowPass::padding`] samples is padded by less.
    pub fn apply(&self, x: &mut [f64]) {
        self.apply_lanes(&mut [x]);
    }

    /// Filters every column in place, eight at a time. Columns of one group of eight that differ
    /// in length are filtered one by one.
    pub fn apply_many(&self, columns: &mut [Vec<f64>]) {
        for group in columns.chunks_mut(LANES) {
            let length = group[0].len();
            if group.iter().all(|c| c.len() == length) {
                let mut lanes: Vec<&mut [f64]> = group.iter_mut().map(Vec::as_mut_slice).collect();
                self.apply_lanes(&mut lanes);
            } else {
                group.iter_mut().for_each(|c| self.apply(c));
            }
        }
    }

    /// Up to eight columns of one length.
    fn apply_lanes(&self, columns: &mut [&mut [f64]]) {
        let n = columns[0].len();
        if n == 0 {
            return;
        }
        let pad = self.padding().min(n - 1);
        let mut x = interleave(columns, pad);
        pass(&self.sections, &mut x);
        x.reverse();
        pass(&self.sections, &mut x);
        x.reverse();
        for (k, row) in x[pad..pad + n].iter().enumerate() {
            columns.iter_mut().zip(row).for_each(|(c, v)| c[k] = *v);
        }
    }
}

/// Samples of up to eight columns side by side, extended by 2 x[0] - x[k] and 2 x[n-1] - x[k].
fn interleave(columns: &[&mut [f64]], pad: usize) -> Vec<[f64; LANES]> {
    let n = columns[0].len();
    let mut x = vec![[0.0; LANES]; n + 2 * pad];
    for (lane, c) in columns.iter().enumerate() {
        for (row, v) in x[pad..].iter_mut().zip(c.iter()) {
            row[lane] = *v;
        }
        for k in 0..pad {
            x[k][lane] = 2.0 * c[0] - c[pad - k];
            x[pad + n + k][lane] = 2.0 * c[n - 1] - c[n - 2 - k];
        }
    }
    x
}

/// One pass through all sections, from the steady state of the first sample: sample by sample, so
/// that one section works on the next sample while the following one still waits for this.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2"))]
fn pass(sections: &[Section], x: &mut [[f64; LANES]]) {
    let mut state = steady(sections, x[0]);
    for row in x.iter_mut() {
        let mut u = *row;
        for (s, [z1, z2]) in sections.iter().zip(&mut state) {
            for l in 0..LANES {
                let y = s.b[0] * u[l] + z1[l];
                z1[l] = s.b[1] * u[l] - s.a[0] * y + z2[l];
                z2[l] = s.b[2] * u[l] - s.a[1] * y;
                u[l] = y;
            }
        }
        *row = u;
    }
}

/// z1 and z2 of each section after endlessly many samples of `level`.
fn steady(sections: &[Section], mut level: [f64; LANES]) -> Vec<[[f64; LANES]; 2]> {
    let settle = |s: &Section| {
        let u = level;
        level = u.map(|u| s.gain() * u);
        let each = |f: &dyn Fn(f64, f64) -> f64| std::array::from_fn(|l| f(u[l], level[l]));
        [each(&|u, y| y - s.b[0] * u), each(&|u, y| s.b[2] * u - s.a[1] * y)]
    };
    sections.iter().map(settle).collect()
}

impl Section {
    /// At frequency zero.
    fn gain(&self) -> f64 {
        self.b.iter().sum::<f64>() / (1.0 + self.a[0] + self.a[1])
    }
}

/// Analog Butterworth poles exp(i pi (2k + n - 1) / 2n), warped w = tan(pi f_c / f_s) and mapped by
/// the bilinear transform, in conjugate pairs (Oppenheim and Schafer, Discrete-Time Signal
/// Processing, section 7.1). `relative` is cutoff over sample rate.
fn butterworth(relative: f64, order: usize) -> Vec<Section> {
    let w = (PI * relative).tan();
    let pair = |k: usize| {
        let damping = 2.0 * (PI * (2 * k + 1) as f64 / (2 * order) as f64).sin();
        let norm = 1.0 / (1.0 + damping * w + w * w);
        let b = w * w * norm;
        let a = [2.0 * (w * w - 1.0) * norm, (1.0 - damping * w + w * w) * norm];
        Section { b: [b, 2.0 * b, b], a }
    };
    let single = || {
        let b = w / (1.0 + w);
        Section { b: [b, b, 0.0], a: [(w - 1.0) / (w + 1.0), 0.0] }
    };
    (0..order / 2).map(pair).chain((order % 2 == 1).then(single)).collect()
}
