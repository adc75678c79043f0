//! The links that one recording calls for, held against another: base parameters by least squares, the
//! most probable links that bodies can have, and everything else fitted again beside these.

use super::arm::identify;
use super::arm_problem::{ArmProblem, BoundsByName};
use super::assemble::assemble_around;
use super::error::IdentificationError;
use super::inertia::Inertial;
use super::located::Located;
use super::reduce::{Dropped, take_out_all};
use super::settings::{Method, Settings};
use super::terms::Terms;
use super::{MethodResult, ParameterEstimate};
use crate::rigid_body::{Estimate, parameters, possible};
use crate::signals::Samples;
use crate::twin::Twin;

/// The recordings, and what links are fitted beside.
#[derive(Clone, Copy)]
pub struct LinkFit<'a> {
    /// The twin with the model's links, and nonlinear parameters as `located`.
    pub twin: &'a Twin,
    pub terms: &'a Terms,
    pub located: &'a [Located],
    pub bounds: &'a BoundsByName,
    pub settings: &'a Settings,
    /// Mass of all moving links together where it is known, kg.
    pub total_mass: Option<f64>,
    pub fit: &'a Samples,
    pub check: Option<&'a Samples>,
}

/// The rigid body by one recording.
#[derive(Debug, Clone)]
pub struct RigidBody {
    /// Base parameters by least squares, in the order of [`Inertial::base`].
    pub base: Vec<ParameterEstimate>,
    /// Condition number of their columns, each in units of its size.
    pub condition: f64,
    pub links: Estimate,
    /// Bodies whose inertia in the model is that of no body.
    pub mended: Vec<usize>,
    /// The twin with these links.
    pub twin: Twin,
    /// The fit recording's problem beside these links.
    pub problem: ArmProblem,
    /// Results of least squares beside the model's links, and beside those found.
    pub given: MethodResult,
    pub fitted: MethodResult,
}

impl LinkFit<'_> {
    /// The links from `results` of the fit recording's problem with the base parameters `attached`;
    /// takes the base parameters' rows out of the `results`. Terms that were `dropped` from the
    /// `attached` problem are not fitted beside the links either.
    ///
    /// # Errors
    /// As [`super::assemble`] and [`identify`], and where a link of the model has no mass.
    pub fn rigid_body(
        &self,
        inertial: &Inertial,
        attached: &ArmProblem,
        results: &mut [MethodResult],
        dropped: &[Dropped],
    ) -> Result<RigidBody, IdentificationError> {
        let (model, mended) = possible(&self.twin.robot);
        let place = results.iter().position(|r| r.method == Method::Nlse.name()).unwrap_or(0);
        let found = results.get(place).map(|r| &r.found).ok_or(IdentificationError::NoTerms)?;
        let links = inertial.links(attached, found, &model, self.total_mass);
        let links = links.ok_or(IdentificationError::NoMass)?;
        let condition = inertial.condition(attached, found);
        let mut rows: Vec<_> = results.iter_mut().map(|r| inertial.take(attached, r)).collect();
        let robot = parameters::built_into(&self.twin.robot, &links.parameters);
        let twin = Twin { robot, ..self.twin.clone() };
        let (_, given) = self.beside(self.twin, dropped)?;
        let (problem, fitted) = self.beside(&twin, dropped)?;
        let base = rows.swap_remove(place);
        Ok(RigidBody { base, condition, links, mended, twin, problem, given, fitted })
    }

    /// Everything but the links, by least squares beside those of `twin`.
    fn beside(
        &self,
        twin: &Twin,
        dropped: &[Dropped],
    ) -> Result<(ArmProblem, MethodResult), IdentificationError> {
        let problem = |samples: &Samples| -> Result<ArmProblem, IdentificationError> {
            let mut arm = assemble_around(samples, twin, self.terms, self.bounds, self.located)?;
            take_out_all(&mut arm, dropped);
            Ok(arm)
        };
        let (fit, check) = (problem(self.fit)?, self.check.map(problem).transpose()?);
        let settings = Settings { methods: vec![Method::Nlse], ..self.settings.clone() };
        let result = identify(&fit, check.as_ref(), &settings)?.pop();
        Ok((fit, result.ok_or(IdentificationError::NoTerms)?))
    }
}
