//! A signal of every joint on a common time base.

/// A signal at a place between its samples (0: the first), on a straight line; both ends are held.
pub fn at_place(signal: &[f64], place: f64) -> f64 {
    let last = signal.len() - 1;
    let place = place.clamp(0.0, last as f64);
    let from = place as usize;
    let next = (from + 1).min(last);
    signal[from] + (place - from as f64) * (signal[next] - signal[from])
}

/// `joints` x `samples` values, one joint after the other, so that the samples of a joint are
/// contiguous (hot loops run over time, joint by joint).
#[derive(Debug, Clone, PartialEq)]
pub struct JointSeries {
    joints: usize,
    samples: usize,
    values: Vec<f64>,
}

impl JointSeries {
    pub fn zeros(joints: usize, samples: usize) -> Self {
        Self { joints, samples, values: vec![0.0; joints * samples] }
    }

    /// From one vector per joint.
    ///
    /// # Panics
    /// If the vectors differ in length: callers check user data before.
    pub fn from_joints(rows: &[Vec<f64>]) -> Self {
        let samples = rows.first().map_or(0, Vec::len);
        assert!(rows.iter().all(|r| r.len() == samples), "joints of unequal length");
        Self { joints: rows.len(), samples, values: rows.concat() }
    }

    /// From the samples of the first joint, then those of the next, ...
    ///
    /// # Panics
    /// If there are not `joints` x `samples` values: callers check user data before.
    pub fn from_values(joints: usize, samples: usize, values: Vec<f64>) -> Self {
        assert_eq!(values.len(), joints * samples, "as many values as samples of all joints");
        Self { joints, samples, values }
    }

    /// The samples of the first joint, then those of the next, ...
    pub fn into_values(self) -> Vec<f64> {
        self.values
    }

    pub fn joints(&self) -> usize {
        self.joints
    }

    /// Samples per joint.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// The samples of joint `j` (from 0).
    pub fn joint(&self, j: usize) -> &[f64] {
        &self.values[j * self.samples..(j + 1) * self.samples]
    }

    pub fn joint_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.values[j * self.samples..(j + 1) * self.samples]
    }

    /// Copies the values of all joints at sample `k` into `out`.
    pub fn sample_into(&self, k: usize, out: &mut [f64]) {
        for (j, o) in out.iter_mut().enumerate() {
            *o = self.values[j * self.samples + k];
        }
    }

    /// Sets the values of all joints at sample `k`.
    pub fn set_sample(&mut self, k: usize, values: &[f64]) {
        for (j, v) in values.iter().enumerate() {
            self.values[j * self.samples + k] = *v;
        }
    }

    /// A new series of `f` applied to each joint's samples.
    pub fn map_joints(&self, mut f: impl FnMut(usize, &[f64]) -> Vec<f64>) -> Self {
        let rows: Vec<_> = (0..self.joints).map(|j| f(j, self.joint(j))).collect();
        Self::from_joints(&rows)
    }
}
