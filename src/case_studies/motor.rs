//! The first case study: what comes out of the motor, depending on what is known of it.

use std::sync::atomic::AtomicBool;

use super::motor_versus::swarms;
use crate::motor::dependence::dependence;
use crate::motor::fit::Tick;
use crate::motor::model::{COUNT, NAMES, index};
use crate::motor::render;
use crate::motor::report::{
    Method, MethodReport, MotorError, ParameterReport, ScenarioReport, run,
};
use crate::motor::scenario::{Channel, SHIPPED, Scenario, ScenarioError};
use crate::motor::study::{Archive, Study, study};
use crate::motor::study_text::{answer, grid};
use crate::text::markdown_table;

/// What is measured, and what is given.
type Known = (&'static [Channel], &'static [(usize, f64)]);

/// As in the paper; with the current; with one of the eight that trade off.
const KNOWN: [Known; 3] = [
    (&[Channel::Omega], &[]),
    (&[Channel::Omega, Channel::Current], &[]),
    (&[Channel::Omega], &[(index::R, 1.5)]),
];
/// Noises of the existence question.
const SEEDS: u64 = 200;

#[derive(Debug, thiserror::Error)]
pub enum MotorStudyError {
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Motor(#[from] MotorError),
}

/// Both shipped scenarios with all that may be known, in the order of the page.
///
/// # Errors
/// None as long as the shipped scenarios are sound.
pub fn scenarios() -> Result<Vec<Scenario>, MotorStudyError> {
    let mut all = Vec::new();
    for (measured, given) in KNOWN {
        for text in SHIPPED {
            let mut scenario = Scenario::parse(text)?;
            scenario.measured = measured.to_vec();
            given.iter().for_each(|(k, value)| scenario.given[*k] = Some(*value));
            scenario.check()?;
            all.push(scenario);
        }
    }
    Ok(all)
}

/// PSO and NLSE on one of [`scenarios`].
///
/// # Errors
/// If a scenario cannot be identified.
pub fn identify(scenario: &Scenario, seed: u64) -> Result<ScenarioReport, MotorStudyError> {
    let mut report = run(scenario, &[Method::Pso, Method::Nlse], seed, &|| {})?;
    if !report.unidentifiable.is_empty() {
        report.dependence = dependence(scenario, seed)?;
    }
    Ok(report)
}

/// The existence question: by NLSE wherever every parameter can be determined, and on the first
/// `pso_seeds` noises by PSO where the current is measured.
pub struct Noises<'a> {
    studies: Vec<(&'a Scenario, Method, u64)>,
}

impl<'a> Noises<'a> {
    pub fn of(scenarios: &'a [Scenario], pso_seeds: u64) -> Self {
        let determined = |s: &&Scenario| (&s.measured[..], s.given) != (KNOWN[0].0, [None; COUNT]);
        let with_current = |s: &&Scenario| s.measured == KNOWN[1].0;
        let nlse = scenarios.iter().filter(determined).map(|s| (s, Method::Nlse, SEEDS));
        let pso = scenarios.iter().filter(with_current).map(|s| (s, Method::Pso, pso_seeds));
        Self { studies: nlse.chain(pso).filter(|(.., seeds)| *seeds > 0).collect() }
    }

    /// How many there are in all.
    pub fn count(&self) -> u64 {
        self.studies.iter().map(|(.., seeds)| seeds).sum()
    }

    /// # Errors
    /// If a true motor cannot be simulated.
    pub fn run(
        &self,
        seed: u64,
        archive: &dyn Archive,
        tick: Tick<'_>,
    ) -> Result<Vec<Study>, MotorStudyError> {
        let stop = AtomicBool::new(false);
        let one = |&(scenario, method, seeds): &(&Scenario, Method, u64)| {
            Ok(study(scenario, method, [seed, seeds], archive, &stop, tick)?)
        };
        self.studies.iter().map(one).collect()
    }
}

/// All that was found.
pub struct Results {
    pub reports: Vec<ScenarioReport>,
    pub studies: Vec<Study>,
}

/// The page's section.
pub fn section(Results { reports, studies }: &Results) -> String {
    let studied = studies.iter().map(|s| format!("{}\n{}\n", grid(s).markdown(), answer(s)));
    format!(
        "## DC motor (Tables III and IV)\n\nMade by `armtwin motor`, `--measured omega,current` and \
         `--given R=1.5`. From the speed alone ten parameters cannot be had: a factor can move from \
         R and L to J and all torques and nothing changes. The current, or any one of the eight, \
         settles it; how well then depends on the excitation.\n\n{}\n\
         ### The existence question\n\nIs a term kept that exists, and dropped that does not? \
         Asked of another noise per seed, as `armtwin motor --study` does for one way of measuring. \
         The paper's intervals (Eq. 8) are sqrt(n) too narrow, n the number of samples: nearly every \
         absent term is \"kept\" and nearly no interval holds the truth. {}\n\n{}\n{}",
        markdown_table(&SUMMARY, 3, &reports.iter().flat_map(rows).collect::<Vec<_>>()),
        swarms(studies),
        studied.collect::<String>(),
        reports.iter().map(render::markdown).collect::<String>()
    )
}

const SUMMARY: [&str; 10] = [
    "scenario",
    "known",
    "method",
    "cost (1 = noise)",
    "SE from the minimum",
    "determined",
    "within 5 %",
    "largest error of these %",
    "of all determined %",
    "omega_s",
];

fn rows(report: &ScenarioReport) -> Vec<Vec<String>> {
    report.methods.iter().map(|m| row(report, m)).collect()
}

fn row(report: &ScenarioReport, m: &MethodReport) -> Vec<String> {
    let searched = || m.parameters.iter().filter(|p| !p.given);
    let determined: Vec<_> = searched().filter(|p| p.identifiable).collect();
    let holds = |p: &&&ParameterReport| m.at_minimum && p.is_supported();
    let supported: Vec<_> = determined.iter().filter(holds).copied().collect();
    let omega_s = &m.parameters[index::OMEGA_S];
    vec![
        report.scenario.to_string(),
        render::setting(&report.measured, &report.given),
        m.method.into(),
        format!("{:.5}", m.cost),
        format!("{:.1}", m.newton_step),
        format!("{} of {}", determined.len(), searched().count()),
        names(&supported),
        largest(&supported),
        largest(&determined),
        format!("{}: {}", render::number(omega_s.value), omega_s.verdict),
    ]
}

fn names(parameters: &[&ParameterReport]) -> String {
    let known = NAMES.iter().filter(|n| parameters.iter().any(|p| p.name == **n));
    let names: Vec<&str> = known.copied().collect();
    if names.is_empty() { "none".into() } else { names.join(", ") }
}

/// Error in %, of those whose truth is not zero.
fn largest(parameters: &[&ParameterReport]) -> String {
    let errors = parameters.iter().filter_map(|p| p.error_percent).map(f64::abs);
    errors.reduce(f64::max).map_or("-".into(), |e| format!("{e:.2}"))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;

    /// At 100 Hz for 50 s and from two starts: short work.
    fn report(measured: &[Channel], given: Option<f64>) -> ScenarioReport {
        let mut scenario = Scenario::parse(SHIPPED[0]).unwrap();
        scenario.identification.sample_time = 0.01;
        scenario.identification.duration = 50.0;
        scenario.verification = scenario.identification;
        scenario.nlse.starts = 2;
        scenario.measured = measured.to_vec();
        scenario.given[index::R] = given;
        run(&scenario, &[Method::Nlse], 1, &|| {}).unwrap()
    }

    #[test]
    fn the_summary_says_what_is_determined_and_what_the_excitation_supports() {
        let of = |measured: &[Channel], given| rows(&report(measured, given)).swap_remove(0);
        let speed = of(&[Channel::Omega], None);
        assert_eq!((speed[1].as_str(), speed[5].as_str()), ("omega", "2 of 10"));
        let both = of(&[Channel::Omega, Channel::Current], None);
        assert_eq!(both[5], "10 of 10");
        assert!(both[6].starts_with("J, K, L, R"), "{both:?}");
        let given = of(&[Channel::Omega], Some(1.5));
        assert_eq!((given[1].as_str(), given[5].as_str()), ("omega, R = 1.5 given", "9 of 9"));
        assert!(given[6].contains('L') && !given[6].contains('R'), "{given:?}");
    }

    #[test]
    fn pso_is_asked_on_its_noises_where_the_current_is_measured() {
        let all: Vec<Scenario> = scenarios()
            .unwrap()
            .into_iter()
            .map(|mut s| {
                s.identification.sample_time = 0.01;
                s.identification.duration = 20.0;
                s.pso.particles_per_parameter = 1;
                s.pso.iterations = 5;
                s
            })
            .collect();
        assert_eq!(Noises::of(&all, 3).count(), 4 * SEEDS + 2 * 3);
        let mut few = Noises::of(&all, 3);
        few.studies.retain(|(_, method, _)| *method == Method::Pso);
        let done = AtomicU64::new(0);
        let tick = || _ = done.fetch_add(1, Ordering::Relaxed);
        let studies = few.run(1, &(), &tick).unwrap();
        assert_eq!(done.into_inner(), 6);
        assert!(studies.iter().all(|s| s.measured == KNOWN[1].0 && s.seeds == 3));
    }

    #[test]
    fn every_shipped_scenario_is_asked_with_all_that_may_be_known() {
        let all = scenarios().unwrap();
        assert_eq!(all.len(), KNOWN.len() * SHIPPED.len());
        assert!(all[..SHIPPED.len()].iter().all(|s| s.measured == [Channel::Omega]));
        assert!(all.iter().any(|s| s.given[index::R] == Some(1.5)));
    }
}
