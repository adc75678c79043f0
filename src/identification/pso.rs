//! Particle swarm optimisation as in the paper (Eqs. 2 to 5), for any cost.
//!
//! V <- chi V + d1 (pBest - X) rnd1 + d2 (gBest - X) rnd2,  X <- X + V
//!
//! with chi falling linearly from chi_max to chi_min (the printed Eq. 3 is constant and above
//! chi_max; Shi and Eberhart, *A modified particle swarm optimizer*, 1998, is what it means).
//! The paper says nothing of three things, chosen here and by everybody since: particles start
//! uniformly within the bounds and at rest; a velocity is cut to half of a parameter's span; a
//! particle that would leave the box is put on its wall and comes back at half its speed (Clerc,
//! *Confinements and biases in particle swarm optimisation*, 2006; particles that stop at the wall
//! stay there: on the friction benchmark they end up to 47 times the lowest cost, these 1.7).
//!
//! All particles of an iteration see the same gBest, and random numbers are drawn in one order
//! by one generator: the outcome does not depend on the number of threads.

use multiversion::multiversion;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::regression::bounds::Bounds;

/// The paper's settings by default.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// d1, pull towards a particle's own best position.
    pub own_pull: f64,
    /// d2, pull towards the swarm's best position.
    pub swarm_pull: f64,
    pub inertia_max: f64,
    pub inertia_min: f64,
    pub particles_per_parameter: usize,
    pub iterations: usize,
    /// Largest velocity as a share of a parameter's span.
    pub velocity_share: f64,
    /// Share the particles of an iteration among threads: worth it from about 10 us per cost.
    pub parallel: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            own_pull: 2.0,
            swarm_pull: 2.0,
            inertia_max: 0.9,
            inertia_min: 0.4,
            particles_per_parameter: 10,
            iterations: 1000,
            velocity_share: 0.5,
            parallel: false,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// All iterations were made; a swarm knows no better reason.
    Iterations,
    /// No position had a finite cost.
    NoFiniteCost,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    pub best: Vec<f64>,
    pub cost: f64,
    pub evaluations: usize,
    pub stop: Stop,
}

/// Positions, velocities and memories, particle after particle.
struct Swarm {
    dimension: usize,
    position: Vec<f64>,
    velocity: Vec<f64>,
    own_best: Vec<f64>,
    own_cost: Vec<f64>,
    best: Vec<f64>,
    cost: f64,
}

/// What limits each coordinate of each particle: the box, and the largest velocity.
struct Limits {
    lower: Vec<f64>,
    upper: Vec<f64>,
    velocity: Vec<f64>,
}

impl Limits {
    fn new(bounds: &Bounds, particles: usize, velocity_share: f64) -> Self {
        let everywhere = |f: &dyn Fn(usize) -> f64| {
            (0..bounds.len()).map(f).collect::<Vec<f64>>().repeat(particles)
        };
        Self {
            lower: everywhere(&|i| bounds.lower(i)),
            upper: everywhere(&|i| bounds.upper(i)),
            velocity: everywhere(&|i| velocity_share * bounds.span(i)),
        }
    }
}

/// What one iteration adds to the velocities: inertia, and random pulls.
struct Pulls {
    inertia: f64,
    /// d1 rnd1, d2 rnd2
    own: Vec<f64>,
    swarm: Vec<f64>,
}

/// Minimises `cost` within finite `bounds`; a cost that is not finite is never a best one.
pub fn minimise(
    cost: impl Fn(&[f64]) -> f64 + Sync,
    bounds: &Bounds,
    settings: &Settings,
    seed: u64,
) -> Outcome {
    minimise_below(|x, _| cost(x), bounds, settings, seed)
}

/// Minimises a cost that is told the particle's own best one so far, and may say anything from there up where
/// it is not below: the swarm asks no more of it.
pub fn minimise_below(
    cost: impl Fn(&[f64], f64) -> f64 + Sync,
    bounds: &Bounds,
    settings: &Settings,
    seed: u64,
) -> Outcome {
    let particles = settings.particles_per_parameter * bounds.len();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut swarm = Swarm::scattered(bounds, particles, &mut rng);
    let mut costs = vec![f64::INFINITY; particles];
    swarm.evaluate(&cost, settings.parallel, &mut costs);
    let limits = Limits::new(bounds, particles, settings.velocity_share);
    let zeros = vec![0.0; particles * bounds.len()];
    let mut pulls = Pulls { inertia: 0.0, own: zeros.clone(), swarm: zeros };
    for k in 0..settings.iterations {
        pulls.inertia = inertia_weight(settings, k);
        for (own, swarm) in pulls.own.iter_mut().zip(&mut pulls.swarm) {
            *own = settings.own_pull * rng.random::<f64>();
            *swarm = settings.swarm_pull * rng.random::<f64>();
        }
        swarm.advance(&limits, &pulls);
        swarm.evaluate(&cost, settings.parallel, &mut costs);
    }
    let stop = if swarm.cost.is_finite() { Stop::Iterations } else { Stop::NoFiniteCost };
    let evaluations = particles * (settings.iterations + 1);
    Outcome { best: swarm.best, cost: swarm.cost, evaluations, stop }
}

/// chi_max - (chi_max - chi_min) k / iter_max
fn inertia_weight(s: &Settings, k: usize) -> f64 {
    s.inertia_max - (s.inertia_max - s.inertia_min) * k as f64 / s.iterations as f64
}

impl Swarm {
    fn scattered(bounds: &Bounds, particles: usize, rng: &mut ChaCha8Rng) -> Self {
        let n = bounds.len();
        let position: Vec<f64> = (0..particles * n)
            .map(|i| bounds.lower(i % n) + bounds.span(i % n) * rng.random::<f64>())
            .collect();
        Self {
            dimension: n,
            velocity: vec![0.0; particles * n],
            own_best: position.clone(),
            own_cost: vec![f64::INFINITY; particles],
            best: position[..n].to_vec(),
            cost: f64::INFINITY,
            position,
        }
    }

    /// Costs of all positions, then the memories.
    fn evaluate(
        &mut self,
        cost: &(impl Fn(&[f64], f64) -> f64 + Sync),
        parallel: bool,
        costs: &mut [f64],
    ) {
        let n = self.dimension;
        if parallel {
            let known = self.position.par_chunks_exact(n).zip(&self.own_cost);
            costs.par_iter_mut().zip(known).for_each(|(c, (x, &own))| *c = cost(x, own));
        } else {
            let known = self.position.chunks_exact(n).zip(&self.own_cost);
            costs.iter_mut().zip(known).for_each(|(c, (x, &own))| *c = cost(x, own));
        }
        for (i, &c) in costs.iter().enumerate() {
            self.remember(i, c);
        }
    }

    fn remember(&mut self, i: usize, cost: f64) {
        let own = i * self.dimension..(i + 1) * self.dimension;
        if cost < self.own_cost[i] {
            self.own_cost[i] = cost;
            self.own_best[own.clone()].copy_from_slice(&self.position[own.clone()]);
        }
        if cost < self.cost {
            self.cost = cost;
            self.best.copy_from_slice(&self.position[own]);
        }
    }

    /// Eqs. 2 and 4 for every particle.
    fn advance(&mut self, limits: &Limits, pulls: &Pulls) {
        let best = self.best.repeat(self.own_cost.len());
        fly(&mut self.position, &mut self.velocity, [&self.own_best, &best], limits, pulls);
    }
}

/// One step of all coordinates, towards the own and the swarm's best positions.
#[multiversion(targets("x86_64+avx512f+avx512dq", "x86_64+avx2", "aarch64+neon"))]
fn fly(
    position: &mut [f64],
    velocity: &mut [f64],
    [own, best]: [&[f64]; 2],
    limits: &Limits,
    pulls: &Pulls,
) {
    let n = position.len();
    let (velocity, own, best) = (&mut velocity[..n], &own[..n], &best[..n]);
    let (lower, upper) = (&limits.lower[..n], &limits.upper[..n]);
    let (fastest, own_pull, swarm_pull) =
        (&limits.velocity[..n], &pulls.own[..n], &pulls.swarm[..n]);
    for i in 0..n {
        let x = position[i];
        let v = pulls.inertia * velocity[i]
            + own_pull[i] * (own[i] - x)
            + swarm_pull[i] * (best[i] - x);
        let v = v.max(-fastest[i]).min(fastest[i]);
        position[i] = (x + v).max(lower[i]).min(upper[i]);
        velocity[i] = if position[i] == x + v { v } else { -0.5 * v };
    }
}

#[cfg(test)]
#[path = "pso_tests.rs"]
mod tests;
