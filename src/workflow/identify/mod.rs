//! Parameters that make the twin's torque match a recording, with tests and intervals.

mod document;
#[cfg(feature = "report")]
mod page;
mod rigid_body;
mod scaled;
mod servos;
mod servos_document;
pub mod words;

use super::{Arm, Prepared, Reading, WorkflowError, conditioned};
use crate::diagnosis::{self, By};
use crate::follow::Watch;
use crate::identification::{
    self, ArmProblem, BoundsByName, Dropped, IdentificationError, Inertial, LinkFit, Located,
    Method, MethodResult, Search, Settings, Terms, assemble_around,
};
use crate::recording::{Provenance, Recording, refuse_same};
use crate::signals::{Conditioning, Samples};
use crate::twin::Twin;

pub use document::IdentificationDocument;
pub use rigid_body::{BaseRow, INERTIA, Left, Link, LinkValue, Summary};
pub use scaled::{KnownLoad, Scaled};
pub use servos::{IdentifiedServos, Told};
pub use servos_document::ServosDocument;

/// What `armtwin identify` can be told; the defaults are its.
///
/// ```
/// # use armtwin::workflow::Identify;
/// let how = Identify::default().with(["payload"]).reduce(true).seed(7);
/// assert!(how.reduce && how.settings.seed == 7);
/// ```
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Identify {
    /// What to fit, effects by name (`paper` is Eq. 1, [`INERTIA`] the links). Empty: what the twin lists
    /// and gives no values for; of an arm without a twin Eq. 1, rotor inertia and current offset.
    pub terms: Vec<String>,
    /// What to fit besides.
    pub with: Vec<String>,
    /// Drop, one by one, the terms whose existence the robust test does not show.
    pub reduce: bool,
    /// Search bounds of parameters, all joints.
    pub bounds: Vec<(String, [f64; 2])>,
    pub settings: Settings,
    /// With [`INERTIA`]: mass of all moving links where it is known, kg.
    pub total_mass: Option<f64>,
    pub reading: Reading,
    /// Against recorded torque, or by simulating command to position; `None`: what is recorded decides.
    pub by: Option<By>,
}

/// An identification and all that led to it.
pub struct Identified {
    /// As given; with torque constants of its own arm where a loaded run tells them.
    pub twin: Twin,
    /// With the nonlinear parameters that were searched for.
    pub around: Twin,
    pub located: Vec<Located>,
    pub terms: Terms,
    pub settings: Settings,
    pub conditioning: Conditioning,
    pub fit: Used,
    pub check: Option<Used>,
    /// With [`Identify::reduce`], the terms that were taken out.
    pub dropped: Option<Vec<Dropped>>,
    /// One per method, in the order asked for.
    pub results: Vec<MethodResult>,
    /// With a loaded run.
    pub scaled: Option<Scaled>,
    /// With a payload: how far links may be from the model's, as a share of a mass.
    pub links_spread: Option<f64>,
    /// With [`INERTIA`].
    pub rigid_body: Option<Summary>,
}

/// What became of a recording.
pub struct Used {
    pub provenance: Provenance,
    pub samples: Samples,
    pub problem: ArmProblem,
}

/// Identifies with the program's defaults what the twin lists and gives no values for; `check` is another
/// recording, which the fit is held against.
///
/// # Errors
/// As [`Identify::run`].
pub fn identify<'a>(
    twin: &Twin,
    fit: &'a Recording,
    check: impl Into<Option<&'a Recording>>,
) -> Result<Identified, WorkflowError> {
    Identify::default().run(twin, fit, check, &())
}

impl Identify {
    /// Fits these effects, in place of what the twin leaves open.
    pub fn terms<S: Into<String>>(mut self, effects: impl IntoIterator<Item = S>) -> Self {
        self.terms = effects.into_iter().map(Into::into).collect();
        self
    }

    /// Fits these effects besides.
    pub fn with<S: Into<String>>(mut self, effects: impl IntoIterator<Item = S>) -> Self {
        self.with = effects.into_iter().map(Into::into).collect();
        self
    }

    /// Estimators, in the order of the results.
    pub fn methods(mut self, methods: impl IntoIterator<Item = Method>) -> Self {
        self.settings.methods.clear();
        for method in methods {
            if !self.settings.methods.contains(&method) {
                self.settings.methods.push(method);
            }
        }
        self
    }

    /// How the swarm's cost is evaluated.
    pub fn cost(mut self, cost: Search) -> Self {
        self.settings.pso_cost = cost;
        self
    }

    /// Seed of the swarm and of the Markov chains.
    pub fn seed(mut self, seed: u64) -> Self {
        self.settings.seed = seed;
        self
    }

    /// Whether terms that do not show are dropped.
    pub fn reduce(mut self, reduce: bool) -> Self {
        self.reduce = reduce;
        self
    }

    /// Search bounds of a parameter, all joints.
    pub fn bounds(mut self, parameter: &str, low: f64, high: f64) -> Self {
        self.bounds.push((parameter.into(), [low, high]));
        self
    }

    /// Mass of all moving links, kg.
    pub fn total_mass(mut self, kg: Option<f64>) -> Self {
        self.total_mass = kg;
        self
    }

    /// Against recorded torque, or by simulating command to position.
    pub fn by(mut self, by: Option<By>) -> Self {
        self.by = by;
        self
    }

    /// Takes and conditions all recordings so.
    pub fn reading(mut self, reading: Reading) -> Self {
        self.reading = reading;
        self
    }

    /// # Errors
    /// Unknown effects, a recording that is not of this arm or contradicts itself, two recordings with the same
    /// samples, nothing that slides, or an end by `watch`.
    pub fn run<'a>(
        &self,
        arm: impl Into<Arm>,
        fit: &'a Recording,
        check: impl Into<Option<&'a Recording>>,
        watch: &dyn Watch,
    ) -> Result<Identified, WorkflowError> {
        self.check()?;
        let arm = arm.into();
        let (fit, check) = self.reading.both(&arm, fit, check.into(), watch)?;
        self.on(&arm, fit, check, None, watch)
    }

    pub fn asks_for_inertia(&self) -> bool {
        self.terms.iter().chain(&self.with).any(|name| name == INERTIA)
    }

    /// # Errors
    /// Names what does not go together, or is out of its range.
    pub fn check(&self) -> Result<(), WorkflowError> {
        self.check_inertia()?;
        for (name, [low, high]) in &self.bounds {
            crate::regression::bounds::check(name, *low, *high)
                .map_err(IdentificationError::from)?;
        }
        Ok(())
    }

    /// What goes with the rigid body makes sense beside it alone.
    fn check_inertia(&self) -> Result<(), WorkflowError> {
        let asked = self.asks_for_inertia();
        let beside = |n: &String| n == "payload" || n == "link_inertia";
        let wrong = match self.total_mass {
            Some(_) if !asked => format!("a total mass is of the links: fit {INERTIA} with it"),
            _ if asked && self.with.iter().chain(&self.terms).any(beside) => format!(
                "{INERTIA}: a payload or a link's change cannot be told from the links themselves; \
                 leave `payload` and `link_inertia` out"
            ),
            Some(mass) if !(mass > 0.0 && mass.is_finite()) => {
                format!("total mass {mass}: give the mass of all moving links, kg")
            }
            _ => return Ok(()),
        };
        Err(WorkflowError::Asked(wrong))
    }

    /// Which effects are fitted to recordings of `arm`.
    ///
    /// # Errors
    /// For a name that is not in the catalogue, or none at all.
    pub fn terms_for(&self, arm: &Arm) -> Result<Terms, IdentificationError> {
        let effects = |names: &[String]| -> Vec<String> {
            names.iter().filter(|name| *name != INERTIA).cloned().collect()
        };
        let (terms, with) = (effects(&self.terms), effects(&self.with));
        let more = with.iter().map(String::as_str);
        match (&terms[..], arm.has_twin()) {
            ([], false) => Terms::named(Terms::usual()?.names().into_iter().chain(more)),
            ([], true) => Terms::of_twin(&arm.twin, &with),
            (given, _) => Terms::named(given.iter().map(String::as_str).chain(more)),
        }
    }

    fn bounds_by_name(&self) -> BoundsByName {
        self.bounds.iter().cloned().collect()
    }

    /// Identifies on recordings that were taken before; `loaded` tells the drives' torque constants first.
    ///
    /// # Errors
    /// As [`Identify::run`].
    pub fn on<'a>(
        &self,
        arm: &Arm,
        fit: Prepared<'a>,
        check: Option<Prepared<'a>>,
        loaded: Option<(Prepared<'a>, KnownLoad)>,
        watch: &dyn Watch,
    ) -> Result<Identified, WorkflowError> {
        check.iter().try_for_each(|check| refuse_same(&fit, check))?;
        let terms = self.terms_for(arm)?;
        let how = self.reading.signals.over(Conditioning::default());
        let mut samples = conditioned(&fit, &arm.twin, &how)?;
        let scale = |(run, load)| self.scaled(arm, &terms, (&fit, &samples), (&run, load), &how);
        let scaled = loaded.map(scale).transpose()?;
        let twin = scaled.as_ref().map_or(&arm.twin, |s| &s.twin).clone();
        if scaled.is_some() {
            samples = conditioned(&fit, &twin, &how)?;
        }
        watch.tell(diagnosis::LOCATING, 0, 0);
        let (around, located) = self.located(&samples, &twin, &terms, watch)?;
        let used = |recording: &Recording, samples: Samples| -> Result<Used, WorkflowError> {
            let provenance = recording.provenance.clone();
            let problem =
                assemble_around(&samples, &around, &terms, &self.bounds_by_name(), &located)
                    .map_err(|e| WorkflowError::from(e).at(&provenance.source))?;
            Ok(Used { provenance, samples, problem })
        };
        let mut fit = used(&fit, samples)?;
        let held = |check: Prepared<'_>| used(&check, conditioned(&check, &twin, &how)?);
        let mut check = check.map(held).transpose()?;
        let mut inertial = self.asks_for_inertia().then(|| Inertial::of(&around, &terms));
        if let Some(inertial) = &mut inertial {
            for Used { problem, samples, .. } in std::iter::once(&mut fit).chain(&mut check) {
                inertial.attach(problem, samples, &around)?;
            }
        }
        let dropped = self.reduced(&mut fit, check.as_mut())?;
        let against = check.as_ref().map(|c| &c.problem);
        let mut results =
            identification::identify_watched(&fit.problem, against, &self.settings, watch)?;
        let link_fit = LinkFit {
            twin: &around,
            terms: &terms,
            located: &located,
            bounds: &self.bounds_by_name(),
            settings: &self.settings,
            total_mass: self.total_mass,
            fit: &fit.samples,
            check: check.as_ref().map(|c| &c.samples),
        };
        let body = |inertial: &Inertial| -> Result<Summary, WorkflowError> {
            let dropped = dropped.as_deref().unwrap_or_default();
            let found = link_fit.rigid_body(inertial, &fit.problem, &mut results, dropped)?;
            let sources = [Some(&fit), check.as_ref()].map(|u| Some(&*u?.provenance.source));
            Ok(rigid_body::summary(found, inertial, &around.robot, &results, sources))
        };
        let rigid_body = inertial.as_ref().map(body).transpose()?;
        let (problem, samples) = (&fit.problem, &fit.samples);
        let links_spread =
            identification::payload_beside_links(problem, samples, &around, &terms, &mut results)?;
        Ok(Identified {
            twin,
            around,
            located,
            terms,
            settings: self.settings.clone(),
            conditioning: how,
            fit,
            check,
            dropped,
            results,
            scaled,
            links_spread,
            rigid_body,
        })
    }

    /// The twin with nonlinear parameters of what is to be fitted, found as a diagnosis finds them.
    fn located(
        &self,
        samples: &Samples,
        twin: &Twin,
        terms: &Terms,
        watch: &dyn Watch,
    ) -> Result<(Twin, Vec<Located>), WorkflowError> {
        let located = diagnosis::locate(samples, twin, terms, watch)?;
        if located.is_empty() {
            return Ok((twin.clone(), located));
        }
        Ok(identification::settle(samples, twin, terms, located, &self.settings.nlse)?)
    }

    fn reduced(
        &self,
        fit: &mut Used,
        check: Option<&mut Used>,
    ) -> Result<Option<Vec<Dropped>>, IdentificationError> {
        if !self.reduce {
            return Ok(None);
        }
        let check = check.map(|c| &mut c.problem);
        identification::reduce(&mut fit.problem, check, &self.settings.nlse).map(Some)
    }
}

impl Identified {
    /// Least squares where it was asked for, else what was asked for first.
    pub fn preferred(&self) -> Option<&MethodResult> {
        let nlse = self.results.iter().find(|r| r.method == Method::Nlse.name());
        nlse.or(self.results.first())
    }

    /// The twin with the values found, and by which method; `None` where no method was asked for.
    ///
    /// # Errors
    /// If bounds are wrong.
    pub fn fitted(&self) -> Result<Option<(Twin, &str)>, IdentificationError> {
        if let Some(Summary { found, .. }) = &self.rigid_body {
            let (problem, result) = (&found.problem, &found.fitted);
            let twin = identification::fitted_twin(&found.twin, &self.terms, problem, result)?;
            return Ok(Some((twin, &found.fitted.method)));
        }
        let Some(result) = self.preferred() else { return Ok(None) };
        let fitted =
            identification::fitted_twin(&self.around, &self.terms, &self.fit.problem, result)?;
        Ok(Some((fitted, &result.method)))
    }
}
