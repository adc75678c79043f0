//! Work that an arm does again and again, cheaply.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{PASSES, Settings, StudyError, bare, drawn};
use crate::diagnosis::conditioning;
use crate::identification::{
    BoundsByName, Method, Settings as Identifying, Terms, assemble, fitted_twin, identify,
};
use crate::recording::Recording;
use crate::signals::condition;
use crate::simulation::{Run, Scenario, Simulation};
use crate::twin::Twin;
use crate::watch::Stretch;

/// Two motions in turn, seen through the sensors many times.
pub struct Work {
    /// Motion by motion, pass by pass, without noise of the torque.
    passes: Vec<Vec<Stretch>>,
    /// Standard deviation of that noise, N.m, motion by motion and joint by joint.
    noise_nm: Vec<Vec<f64>>,
    motion_s: f64,
    /// The first motion with all noise, to be diagnosed.
    pub recording: Recording,
}

/// What an arm does all day: slow and fast, all joints, with rests.
const KINDS: [&str; 2] = ["mixed", "random_frequency"];

fn runs(
    scenario: &Scenario,
    file: &str,
    settings: &Settings,
    kinds: &[&str],
    seeds: u64,
) -> Result<Vec<(Simulation, Run)>, StudyError> {
    let run = |(n, kind): (usize, &&str)| -> Result<(Simulation, Run), StudyError> {
        let mut scenario = scenario.clone();
        scenario.shorten(settings.motion_s);
        scenario.motion.kind =
            serde_json::from_value((*kind).into()).map_err(|e| StudyError::Table(e.to_string()))?;
        scenario.motion.seed = seeds + n as u64;
        let made = scenario.work_out(file)?;
        let mut simulation = Simulation::new(&made.setup)?;
        let run = simulation.run(&made.fit, settings.seed, 0, &mut |_| true)?;
        Ok((simulation, run))
    };
    kinds.iter().enumerate().map(run).collect()
}

/// Seeds of the motions of work, and of the recording the twin is fitted on.
const WORK: u64 = 31;
const FITTED_ON: u64 = 71;

impl Work {
    pub fn new(
        scenario: &Scenario,
        file: &str,
        twin: &Twin,
        settings: &Settings,
    ) -> Result<Self, StudyError> {
        let (mut passes, mut noise_nm, mut recording) = (Vec::new(), Vec::new(), None);
        for (simulation, run) in runs(scenario, file, settings, &KINDS, WORK)? {
            recording
                .get_or_insert(simulation.sensed_again(&run, settings.seed, PASSES + 1).recording);
            let none = vec![0.0; twin.robot.dof()];
            let pass = |n: u64| -> Result<Stretch, StudyError> {
                let seen = simulation.sensed_with(&run, Some(&none), settings.seed, n + 1);
                Ok(Stretch::of(&seen.recording, None, twin)?)
            };
            passes.push((0..PASSES).map(pass).collect::<Result<_, _>>()?);
            let noise = run.current_noise_a.iter().enumerate();
            noise_nm.push(noise.map(|(j, a)| a * twin.drive.torque_per_ampere(j)).collect());
        }
        let recording = recording.ok_or_else(|| StudyError::Table("there is no motion".into()))?;
        Ok(Self { passes, noise_nm, motion_s: settings.motion_s, recording })
    }

    pub fn joints(&self) -> usize {
        self.noise_nm[0].len()
    }

    /// The next motion, begun at `time`, s, with fresh noise of the torque.
    pub fn next(&self, time: f64, rng: &mut ChaCha8Rng) -> Stretch {
        let turn = (time / self.motion_s).round() as usize;
        let mut stretch = drawn(&self.passes, turn, rng).clone();
        stretch.time.iter_mut().for_each(|t| *t += time);
        for (j, sigma) in self.noise_nm[turn % self.noise_nm.len()].iter().enumerate() {
            for torque in stretch.measured.joint_mut(j) {
                let noise: f64 = StandardNormal.sample(rng);
                *torque += sigma * noise;
            }
        }
        stretch
    }

    /// Time that a motion takes, s.
    pub fn length_s(&self) -> f64 {
        self.motion_s
    }

    /// Share of the time in which joints slide and count, mean over joints.
    pub fn sliding(&self) -> f64 {
        let all = self.passes.iter().flatten();
        let (mut counted, mut samples) = (0, 0);
        for stretch in all {
            counted += stretch.counts.iter().flatten().filter(|c| **c).count();
            samples += stretch.joints() * (self.motion_s / stretch.dt).round() as usize;
        }
        counted as f64 / samples as f64
    }

    /// How much larger the gap is than `before`, rms in multiples of the noise, at the joint where that is most.
    pub fn over_noise(&self, before: &Self) -> f64 {
        let mean_square = |work: &Self, j: usize| {
            let (mut sum, mut count) = (0.0, 0.0);
            for (motion, noise) in work.passes.iter().zip(&work.noise_nm) {
                for k in (0..motion[0].len()).filter(|&k| motion[0].counts[j][k]) {
                    sum += (motion[0].left(j, k) / noise[j]).powi(2);
                    count += 1.0;
                }
            }
            if count > 0.0 { sum / count } else { 0.0 }
        };
        let more = |j: usize| (mean_square(self, j) - mean_square(before, j)).max(0.0).sqrt();
        (0..self.joints()).map(more).fold(0.0, f64::max)
    }
}

/// The twin, its friction fitted on another motion.
pub fn twin(scenario: &Scenario, file: &str, settings: &Settings) -> Result<Twin, StudyError> {
    let twin = bare(scenario, file)?;
    let all = runs(scenario, file, settings, &KINDS[..1], FITTED_ON)?;
    let recording = &all[0].1.recording;
    let dof = twin.robot.dof();
    let how = conditioning(recording, dof);
    let samples = condition(recording, &twin.drive, dof, &how)?;
    let terms = Terms::of_twin(&twin, &[])?;
    let arm = assemble(&samples, &twin, &terms, &BoundsByName::new())?;
    let nlse = Identifying { methods: vec![Method::Nlse], ..Identifying::default() };
    let results = identify(&arm, None, &nlse)?;
    match results.first() {
        Some(result) => Ok(fitted_twin(&twin, &terms, &arm, result)?),
        None => Err(StudyError::Table("the twin could not be fitted".into())),
    }
}
