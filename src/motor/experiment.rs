//! Recordings of the true motor, with noise.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::input::{Excitation, random_voltage, with_noise};
use super::model::Motor;
use super::scenario::Channel;
use super::simulate::{Accuracy, Failure, Input, Output, simulate};

/// What the motor did, without noise; kept to draw many noises.
#[derive(Debug, Clone, PartialEq)]
pub struct Clean {
    pub input: Input,
    pub output: Output,
    snr_db: f64,
}

/// Input and noisy output.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    pub input: Input,
    pub measured: Output,
}

/// Streams of one noise seed, so that recordings and channels are independent.
const IDENTIFICATION: u64 = 0;
const VERIFICATION: u64 = 1;

impl Clean {
    pub fn of(motor: &Motor, excitation: &Excitation) -> Result<Self, Failure> {
        let input = random_voltage(excitation);
        let mut output = Output::default();
        simulate(motor, &input, Accuracy::TRUTH, &mut output)?;
        Ok(Self { input, output, snr_db: excitation.snr_db })
    }

    /// This motion measured with a signal-to-noise ratio of `snr_db`, dB; infinite is no noise.
    pub fn at(&self, snr_db: f64) -> Self {
        Self { snr_db, ..self.clone() }
    }

    fn with_noise(&self, seed: u64, stream: u64) -> Record {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        let omega = with_noise(&self.output.omega, self.snr_db, &mut rng);
        let current = with_noise(&self.output.current, self.snr_db, &mut rng);
        Record { input: self.input.clone(), measured: Output { omega, current } }
    }

    /// The recording that parameters are identified from.
    pub fn for_identification(&self, seed: u64) -> Record {
        self.with_noise(seed, IDENTIFICATION)
    }

    /// The recording that the identified model is held against.
    pub fn for_verification(&self, seed: u64) -> Record {
        self.with_noise(seed, VERIFICATION)
    }
}

impl Output {
    pub fn channel(&self, channel: Channel) -> &[f64] {
        match channel {
            Channel::Omega => &self.omega,
            Channel::Current => &self.current,
        }
    }
}
