//! What identification finds of the friction, beside what was hidden.

use anyhow::Context;

use super::{HIDDEN, HIDDEN_JOINT};
use crate::cli::identify::brief::{EXPLAINED_ON_CHECK, agreement, by_joint};
use crate::cli::out;
use crate::effects::{CATALOGUE, Role};
use crate::identification::{
    ArmProblem, BoundsByName, Dropped, MethodResult, ParameterEstimate, Settings, Terms, assemble,
    fitted_twin, identify, reduce,
};
use crate::report::{table, to_uncertainty};
use crate::signals::condition;
use crate::simulation::{Experiment, Run};
use crate::studies::recovery::{Recovered, blank_twin, conditioning, recovered};
use crate::twin::Twin;

/// What identification made of the recordings.
pub struct Found {
    pub dropped: Vec<Dropped>,
    pub results: Vec<MethodResult>,
    twin: Twin,
}

impl Found {
    pub fn new(made: &Experiment, fit: &Run, check: &Run, seed: u64) -> anyhow::Result<Self> {
        let blank = blank_twin(made);
        let terms = Terms::usual()?;
        let problem = |run: &Run| -> anyhow::Result<ArmProblem> {
            let dof = blank.robot.dof();
            let samples = condition(&run.recording, &blank.drive, dof, &conditioning())?;
            Ok(assemble(&samples, &blank, &terms, &BoundsByName::new())?)
        };
        let (mut fit, mut check) = (problem(fit)?, problem(check)?);
        let settings = Settings { seed, ..Settings::default() };
        let dropped = reduce(&mut fit, Some(&mut check), &settings.nlse)?;
        let results = identify(&fit, Some(&check), &settings)?;
        let nlse = results.last().context("no method ran")?;
        let twin = fitted_twin(&blank, &terms, &fit, nlse)?;
        Ok(Self { dropped, results, twin })
    }

    /// The identified twin with the linear values of its friction open: what it lacks has misled them
    /// (a ripple hides a Stribeck curve), so that they are fitted again with what it lacks.
    pub fn open(&self) -> Twin {
        let mut open = self.twin.clone();
        let parameters = CATALOGUE.iter().flat_map(|e| e.about().parameters);
        let linear = parameters.filter(|p| p.role == Role::Linear);
        linear.for_each(|p| drop(open.values.remove(p.name)));
        open
    }

    /// Values found by NLSE, each beside what was hidden.
    pub fn print_brief(&self, made: &Experiment) {
        let Some(last) = self.results.last() else { return };
        let all = recovered(std::slice::from_ref(last), made);
        let missed = all.iter().filter(|r| is_missed(r)).count();
        let cell = |joint: usize, p: &ParameterEstimate| {
            all.iter().find(|r| r.joint == joint && r.estimate.name == p.name).map(beside_truth)
        };
        out::page(&format!(
            "\nFound (true): {} of {} intervals (99 %) hold the truth; * marks what does not\n{}\n{}\n",
            all.len() - missed,
            all.len(),
            by_joint(last, cell, &[EXPLAINED_ON_CHECK]),
            agreement(&self.results),
        ));
        self.print_misled(made);
    }

    /// Every value of both methods with its interval.
    pub fn print(&self, made: &Experiment) {
        println!("\n   Dropped, because the robust test does not show them:");
        let mut terms: Vec<&str> = self.dropped.iter().map(|d| d.term.as_str()).collect();
        terms.sort_unstable();
        terms.dedup();
        for term in terms {
            let joints = self.dropped.iter().filter(|d| d.term == term);
            let joints: Vec<_> = joints.map(|d| d.joint.to_string()).collect();
            println!("   {term} on joints {}", joints.join(", "));
        }
        println!("\n{}", self.parameters(made));
        self.print_misled(made);
        println!("\n{}", self.fits());
    }

    fn print_misled(&self, made: &Experiment) {
        if self.misled(made) {
            println!(
                "At joint {HIDDEN_JOINT} the hidden {HIDDEN} pulls at the friction found: the twin lacks it, \
                 which no interval can know. Part 3 finds it."
            );
        }
    }

    /// Does an interval miss the truth where the effect is hidden?
    fn misled(&self, made: &Experiment) -> bool {
        let last = self.results.last().map(std::slice::from_ref).unwrap_or_default();
        recovered(last, made).iter().any(|r| r.joint == HIDDEN_JOINT && is_missed(r))
    }

    fn parameters(&self, made: &Experiment) -> String {
        let by_method: Vec<Vec<Recovered>> =
            self.results.iter().map(|r| recovered(std::slice::from_ref(r), made)).collect();
        let [pso, nlse] = &by_method[..] else { return String::new() };
        let row = |(pso, nlse): (&Recovered, &Recovered)| {
            let e = &nlse.estimate;
            let held = if nlse.within(e.low, e.high) { "holds the truth" } else { "MISSES it" };
            let error = nlse.relative_error().map_or("-".into(), |e| format!("{:+.1}", 100.0 * e));
            let verdict = if e.identifiable { held } else { "not identifiable" };
            vec![
                nlse.joint.to_string(),
                e.name.clone(),
                e.unit.clone(),
                format!("{:.4}", nlse.truth),
                format!("{:.4}", pso.estimate.value),
                format!("{:.4}", e.value),
                error,
                format!("{:.4}", e.low),
                format!("{:.4}", e.high),
                verdict.into(),
            ]
        };
        const HEADER: [&str; 10] = [
            "joint",
            "parameter",
            "unit",
            "true",
            "PSO",
            "NLSE",
            "error %",
            "99 % low",
            "high",
            "",
        ];
        table(&HEADER, 3, pso.iter().zip(nlse).map(row))
    }

    fn fits(&self) -> String {
        let rows = self.results.iter().flat_map(|m| {
            m.joints.iter().map(move |j| {
                vec![
                    m.method.clone(),
                    j.joint.to_string(),
                    format!("{:.6}", j.cost),
                    j.evaluations.to_string(),
                    format!("{:.1}", 1e3 * j.seconds),
                    format!("{:.4}", j.fit.r2),
                    j.check.map_or("-".into(), |c| format!("{:.4}", c.r2)),
                ]
            })
        });
        table(&["method", "joint", "cost N.m", "evaluations", "ms", "R2", "check R2"], 1, rows)
    }
}

/// Does the interval of a value that can be told miss the truth?
fn is_missed(r: &Recovered) -> bool {
    r.estimate.identifiable && !r.within(r.estimate.low, r.estimate.high)
}

/// `6.21 (6.20)`, with a star where the interval misses the truth.
fn beside_truth(r: &Recovered) -> String {
    let e = &r.estimate;
    let [value, _, _] = to_uncertainty(e.value, e.low, e.high);
    let digits = value.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    let star = if is_missed(r) { "*" } else { "" };
    format!("{value} ({:.digits$}){star}", r.truth)
}
