//! By which methods, and how they search.

use super::{adaptive_metropolis, pso, separable};

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// The paper's swarm.
    Pso,
    /// Separable least squares refined by Levenberg-Marquardt.
    Nlse,
    /// Posterior by Markov chains.
    Mcmc,
}

impl Method {
    pub fn name(self) -> &'static str {
        match self {
            Self::Pso => "pso",
            Self::Nlse => "nlse",
            Self::Mcmc => "mcmc",
        }
    }
}

/// How the swarm's cost is evaluated; the same number either way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Search {
    /// Interpolated quadratic form ([`super::quadratic::QuadraticCost`]).
    #[default]
    Quadratic,
    /// The law at every sample.
    Direct,
}

#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Settings {
    pub methods: Vec<Method>,
    /// Joint j's swarm and chains are seeded with `seed` + 2^32 j.
    pub seed: u64,
    pub pso: pso::Settings,
    pub pso_cost: Search,
    pub nlse: separable::Settings,
    pub mcmc: adaptive_metropolis::Settings,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            methods: vec![Method::Pso, Method::Nlse],
            seed: 1,
            pso: pso::Settings::default(),
            pso_cost: Search::default(),
            nlse: separable::Settings::default(),
            mcmc: adaptive_metropolis::Settings::default(),
        }
    }
}
