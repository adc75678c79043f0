//! PSO against NLSE on the same noises of the DC motor, in sentences.

use crate::motor::report::Method;
use crate::motor::study::{Run, Study};

/// How much is known of PSO, and what it came to.
pub fn swarms(studies: &[Study]) -> String {
    let pso: Vec<&Study> = studies.iter().filter(|s| s.method == Method::Pso.name()).collect();
    let (seeds, at_minimum) = pso.iter().fold((0, 0), |(n, m), s| (n + s.seeds, m + s.at_minimum));
    if seeds == 0 {
        return "PSO was not asked (`--pso-seeds`).".into();
    }
    let per_scenario: Vec<String> = pso.iter().map(|s| s.seeds.to_string()).collect();
    let duels = pso.iter().filter_map(|p| against_nlse(p, studies));
    format!(
        "PSO, with the paper's settings, was asked on {seeds} of the noises ({} per scenario), where \
         the current is measured; {at_minimum} of its searches ended at a minimum of the cost. \
         Elsewhere no test holds, whatever the convention: its rates below are those of taking the \
         swarm at its word.\n\nDoes PSO beat NLSE here? On the same noises, NLSE from the truth \
         (from random starts it stands in the table above):\n\n{}",
        per_scenario.join(" and "),
        duels.collect::<String>()
    )
}

fn against_nlse(pso: &Study, studies: &[Study]) -> Option<String> {
    let asked = |s: &Study| (s.scenario, s.measured.clone(), s.given.clone());
    let nlse =
        studies.iter().find(|s| s.method == Method::Nlse.name() && asked(s) == asked(pso))?;
    let above = |p: &Run| {
        let other = nlse.runs.iter().find(|n| n.seed == p.seed)?;
        Some(100.0 * (p.cost / other.cost - 1.0))
    };
    let mut all: Vec<f64> = pso.runs.iter().filter_map(above).collect();
    all.sort_by(f64::total_cmp);
    let (low, high) = (all.first()?, all.last()?);
    Some(format!(
        "* scenario {}: PSO ended with the lower cost on {} of {} noises; its cost was {:.2} % above \
         NLSE's in the median ({low:.2} to {high:.2} %), after {} simulations instead of {}\n",
        pso.scenario,
        all.iter().filter(|a| **a < 0.0).count(),
        all.len(),
        all[all.len() / 2],
        evaluations(pso),
        evaluations(nlse)
    ))
}

/// Per noise, in the median.
fn evaluations(study: &Study) -> usize {
    let mut all: Vec<usize> = study.runs.iter().map(|r| r.evaluations).collect();
    all.sort_unstable();
    all.get(all.len() / 2).copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::*;
    use crate::motor::scenario::{SHIPPED, Scenario};
    use crate::motor::study::study;

    fn studies() -> Vec<Study> {
        let mut scenario = Scenario::parse(SHIPPED[1]).unwrap();
        scenario.identification.sample_time = 0.01;
        scenario.identification.duration = 20.0;
        scenario.pso.particles_per_parameter = 1;
        scenario.pso.iterations = 5;
        let by = |(method, seeds)| {
            study(&scenario, method, [1, seeds], &(), &AtomicBool::new(false), &|| ()).unwrap()
        };
        [(Method::Nlse, 4), (Method::Pso, 3)].map(by).into()
    }

    #[test]
    fn a_short_swarm_loses_and_that_is_said() {
        let said = swarms(&studies());
        assert!(said.contains("on 3 of the noises (3 per scenario)"), "{said}");
        assert!(said.contains("; 0 of its searches"), "{said}");
        assert!(
            said.contains("scenario 2: PSO ended with the lower cost on 0 of 3 noises"),
            "{said}"
        );
        assert!(said.contains("after 60 simulations instead of "), "{said}");
        assert!(swarms(&studies()[..1]).contains("not asked"));
    }
}
