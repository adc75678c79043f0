//! The second case study, an arm, on one pair of recordings.

use std::collections::BTreeMap;

use crate::identification::{
    self, ArmProblem, IdentificationError, LEVEL, Method, MethodResult, ParameterEstimate,
    Settings, Terms, assemble,
};
use crate::recording::Recording;
use crate::signals::{Conditioning, Samples, condition};
use crate::simulation::Setup;
use crate::twin::Twin;

/// Study of one arm: fitted on one recording, held against another.
pub struct Study {
    /// `synthetic`, `real`: part of file names.
    pub name: &'static str,
    pub fit: Part,
    pub check: Part,
    /// PSO, NLSE, MCMC.
    pub results: Vec<MethodResult>,
    /// NLSE without what was dropped.
    pub reduced: MethodResult,
    pub dropped: Vec<Dropped>,
}

/// A power of the velocity that one joint does not show.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Dropped {
    /// From 1 at the base.
    pub joint: usize,
    pub parameter: String,
    /// P-value of the robust test when it was dropped; 1 where the parameter was not identifiable.
    pub p: f64,
}

/// Powers of the velocity whose existence is the paper's question.
const POWERS: [&str; 2] = ["viscous_quadratic", "viscous_cubic"];

pub struct Part {
    pub source: String,
    pub samples: Samples,
    pub problem: ArmProblem,
}

/// # Errors
/// If the recordings cannot be used.
pub fn study(
    name: &'static str,
    fit: &Recording,
    check: &Recording,
    seed: u64,
) -> Result<Study, IdentificationError> {
    let twin = Twin::default();
    let [fit, check] = [part(fit, &twin)?, part(check, &twin)?];
    let methods = vec![Method::Pso, Method::Nlse, Method::Mcmc];
    let settings = Settings { methods, seed, ..Settings::default() };
    let results = identification::identify(&fit.problem, Some(&check.problem), &settings)?;
    let (reduced, dropped) = eliminate(fit.problem.clone(), &settings)?;
    Ok(Study { name, fit, check, results, reduced, dropped })
}

/// Takes out tau_v2 and tau_v3 joint by joint, the larger robust p first, and fits again, until
/// those left are significant. Everything else stays, a T_s below T_c included, which is what the
/// paper prints.
fn eliminate(
    mut problem: ArmProblem,
    settings: &Settings,
) -> Result<(MethodResult, Vec<Dropped>), IdentificationError> {
    let settings = Settings { methods: vec![Method::Nlse], ..settings.clone() };
    let mut dropped = Vec::new();
    loop {
        let result = identification::identify(&problem, None, &settings)?.swap_remove(0);
        let weakest: Vec<Dropped> = result.joints.iter().filter_map(weakest).collect();
        if weakest.is_empty() {
            return Ok((result, dropped));
        }
        for d in &weakest {
            let joints = problem.joints.iter_mut().filter(|j| j.joint == d.joint);
            joints.for_each(|j| j.columns.retain(|c| c.parameter.name != d.parameter));
        }
        dropped.extend(weakest);
    }
}

fn weakest(joint: &identification::JointEstimate) -> Option<Dropped> {
    let powers = joint.parameters.iter().filter(|e| POWERS.contains(&e.name.as_str()));
    let doubt = |e: &ParameterEstimate| Dropped {
        joint: joint.joint,
        parameter: e.name.clone(),
        p: if e.identifiable { e.p } else { 1.0 },
    };
    let open = powers.map(doubt).filter(|d| d.p > 1.0 - LEVEL);
    open.reduce(|a, b| if b.p >= a.p { b } else { a })
}

/// Eq. 1, rotor inertia and current offset.
fn part(recording: &Recording, twin: &Twin) -> Result<Part, IdentificationError> {
    let conditioning = Conditioning::default();
    let samples = condition(recording, &twin.drive, twin.robot.dof(), &conditioning)?;
    let problem = assemble(&samples, twin, &Terms::usual()?, &BTreeMap::new())?;
    Ok(Part { source: recording.provenance.source.clone(), samples, problem })
}

impl Study {
    /// An estimate by method (`pso`, ...), joint (from 1) and parameter.
    pub fn estimate(&self, method: &str, joint: usize, name: &str) -> Option<&ParameterEstimate> {
        let result = self.results.iter().find(|r| r.method == method)?;
        let joint = result.joints.iter().find(|j| j.joint == joint)?;
        joint.parameters.iter().find(|p| p.name == name)
    }

    /// An estimate by NLSE without what was dropped.
    pub fn reduced(&self, joint: usize, name: &str) -> Option<&ParameterEstimate> {
        let joint = self.reduced.joints.iter().find(|j| j.joint == joint)?;
        joint.parameters.iter().find(|p| p.name == name)
    }

    pub fn dropped(&self, joint: usize, name: &str) -> Option<&Dropped> {
        self.dropped.iter().find(|d| d.joint == joint && d.parameter == name)
    }
}

/// What was injected, by parameter: one value per joint. The static level is T_c plus the excess.
pub fn injected(setup: &Setup) -> BTreeMap<&'static str, Vec<f64>> {
    let dof = setup.robot.dof();
    let mut all: BTreeMap<&'static str, Vec<f64>> = BTreeMap::new();
    for injection in &setup.effects {
        for (i, p) in injection.effect.about().parameters.iter().enumerate() {
            let values = all.entry(p.name).or_insert_with(|| vec![0.0; dof]);
            for (joint, row) in injection.joints.iter().zip(&injection.values) {
                values[*joint] = row[i];
            }
        }
    }
    if let (Some(c), Some(e)) = (all.get("coulomb"), all.get("stribeck_excess")) {
        let level = c.iter().zip(e).map(|(c, e)| c + e).collect();
        all.insert("static", level);
    }
    all
}
