//! All links' parameters from what the data say of the base parameters, what the model says of each
//! link, and that every link must be possible.
//!
//! Minus log posterior over the whitened pseudo-inertias X_i (1 is the model's link i):
//!
//! f = (beta - b)^T H (beta - b) / 2 + g sum_i (tr X_i - log det X_i),   beta = G pi(X)
//!
//! The prior is a Wishart density with its mode at the model; its sum is the divergence of Lee,
//! Wensing and Park times g. f is convex and grows without bound towards a link that cannot exist, so
//! that Newton's method finds the one minimum inside (Boyd, Vandenberghe, *Convex Optimization*, 2004,
//! section 9.6: f is self-concordant but for a factor). How far links are from the model, 1 / sqrt(4 g)
//! as a share of a link's mass, is what the marginal likelihood says (Laplace's method over X).

use std::ops::Add;

use nalgebra::{DMatrix, DVector, SVector};
use statrs::function::gamma::ln_gamma;

use super::base::BaseParameters;
use super::parameters::PER_LINK;
use super::pseudo_inertia::{Frame, divergence};
use crate::robot::Robot;

/// What data say of the base parameters, and of others after them that have no model to stay near:
/// log-likelihood = - beta^T H beta / 2 + pull^T beta.
#[derive(Debug, Clone, PartialEq)]
pub struct Information {
    /// H
    pub gram: DMatrix<f64>,
    pub pull: DVector<f64>,
}

impl Information {
    /// Information that says nothing of `n` parameters.
    pub fn none(n: usize) -> Self {
        Self { gram: DMatrix::zeros(n, n), pull: DVector::zeros(n) }
    }
}

/// Adds the information of independent rows.
impl Add for Information {
    type Output = Self;

    fn add(self, more: Self) -> Self {
        Self { gram: self.gram + more.gram, pull: self.pull + more.pull }
    }
}

/// Estimated parameters of all links, and how sure they are.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// Inertial parameters of all links, in the order of [`super::parameters::of`].
    pub parameters: DVector<f64>,
    /// Estimates of the other parameters, after the base parameters.
    pub others: DVector<f64>,
    /// Covariance of the links' parameters and the others after them.
    pub covariance: DMatrix<f64>,
    /// Standard deviation of a link's mass from the model's, as a share of it, that the data call for.
    pub spread: f64,
    /// nats
    pub log_evidence: f64,
}

/// The arm's mass is known to this share where it is given.
const TOTAL_MASS: f64 = 1e-3;
/// Spreads that are tried: from a sound CAD model to links that are off several times.
const SPREADS: [f64; 12] = [0.005, 0.01, 0.02, 0.04, 0.07, 0.12, 0.2, 0.35, 0.6, 1.0, 1.7, 3.0];
const MOST_STEPS: usize = 100;
/// Newton's decrement below which the search ends, nats.
const SETTLED: f64 = 1e-9;

/// The most probable links beside the `robot`'s own; `total_mass` (kg) of all of them where it is
/// known. `None` where a link of the robot is impossible (see [`super::made_possible`]).
pub fn estimate(
    robot: &Robot,
    base: &BaseParameters,
    information: &Information,
    total_mass: Option<f64>,
) -> Option<Estimate> {
    let problem = Problem::new(robot, base, information, total_mass)?;
    let each = SPREADS.iter().filter_map(|&spread| problem.solve(spread));
    each.max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))
}

/// The most probable links where they are known to the share `spread` of their masses.
pub fn estimate_within(
    robot: &Robot,
    base: &BaseParameters,
    information: &Information,
    spread: f64,
) -> Option<Estimate> {
    Problem::new(robot, base, information, None)?.solve(spread)
}

/// The search in whitened coordinates of the links, then the others.
struct Problem {
    links: usize,
    /// Matrix from coordinates to parameters.
    map: DMatrix<f64>,
    gram: DMatrix<f64>,
    pull: DVector<f64>,
}

impl Problem {
    fn new(
        robot: &Robot,
        base: &BaseParameters,
        information: &Information,
        total_mass: Option<f64>,
    ) -> Option<Self> {
        let links = PER_LINK * robot.dof();
        let others = information.pull.len() - base.len();
        let n = links + others;
        let mut map = DMatrix::identity(n, n);
        for (i, body) in robot.bodies.iter().enumerate() {
            let frame = Frame::of(&body.inertia)?;
            let place = (PER_LINK * i, PER_LINK * i);
            map.view_mut(place, (PER_LINK, PER_LINK)).copy_from(&frame.to_parameters);
        }
        let mut grouping = DMatrix::zeros(base.len() + others, n);
        grouping.view_mut((0, 0), (base.len(), links)).copy_from(&base.grouping);
        grouping.view_mut((base.len(), links), (others, others)).fill_with_identity();
        let seen = &grouping * &map;
        let mut gram = seen.tr_mul(&(&information.gram * &seen));
        let mut pull = seen.tr_mul(&information.pull);
        if let Some(mass) = total_mass {
            let is_mass = |i: usize| i < links && i.is_multiple_of(PER_LINK);
            let masses = DVector::from_fn(n, |i, _| f64::from(u8::from(is_mass(i))));
            let row = map.tr_mul(&masses);
            let weight = (TOTAL_MASS * mass).powi(-2);
            gram += &row * row.transpose() * weight;
            pull += row * (weight * mass);
        }
        Some(Self { links: robot.dof(), map, gram, pull })
    }

    fn solve(&self, spread: f64) -> Option<Estimate> {
        let weight = 0.25 * spread.powi(-2);
        let (links, others) = (self.links, self.map.nrows() - PER_LINK * self.links);
        let origin = Frame::origin().repeat(links).into_iter().chain(vec![0.0; others]);
        let mut x = DVector::from_iterator(self.map.nrows(), origin);
        let mut now = self.at(&x, weight)?;
        for _ in 0..MOST_STEPS {
            let step = -now.hessian.clone().cholesky()?.solve(&now.gradient);
            let decrement = -step.dot(&now.gradient);
            if decrement < SETTLED {
                break;
            }
            let Some((there, next)) = self.forward(&x, &step, &now, weight) else { break };
            (x, now) = (there, next);
        }
        let cholesky = now.hessian.cholesky()?;
        let log_det = 2.0 * cholesky.l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let laplace = 0.5 * (x.len() as f64 * (2.0 * std::f64::consts::PI).ln() - log_det);
        let log_evidence = -now.value - links as f64 * log_normaliser(weight) + laplace;
        let all = &self.map * &x;
        Some(Estimate {
            parameters: all.rows(0, PER_LINK * links).into_owned(),
            others: all.rows(PER_LINK * links, others).into_owned(),
            covariance: &self.map * cholesky.inverse() * self.map.transpose(),
            spread,
            log_evidence,
        })
    }

    /// Moves along a Newton step until the posterior has grown by a share of what its slope says (Armijo).
    fn forward(
        &self,
        x: &DVector<f64>,
        step: &DVector<f64>,
        now: &Point,
        weight: f64,
    ) -> Option<(DVector<f64>, Point)> {
        const SHARE: f64 = 0.1;
        let slope = step.dot(&now.gradient);
        let lengths = (0..50).map(|k| 0.5f64.powi(k));
        lengths
            .filter_map(|t| {
                let there = x + step * t;
                let next = self.at(&there, weight)?;
                (next.value <= now.value + SHARE * t * slope).then_some((there, next))
            })
            .next()
    }

    /// `None` where a link is impossible.
    fn at(&self, x: &DVector<f64>, weight: f64) -> Option<Point> {
        let pushed = &self.gram * x;
        let mut value = 0.5 * x.dot(&pushed) - x.dot(&self.pull);
        let mut gradient = pushed - &self.pull;
        let mut hessian = self.gram.clone();
        let coordinates = x.as_slice().as_chunks::<PER_LINK>().0;
        for (i, own) in coordinates.iter().take(self.links).enumerate() {
            let (v, g, h) = divergence(own)?;
            let place = PER_LINK * i;
            value += weight * v;
            let mut part = gradient.fixed_rows_mut::<PER_LINK>(place);
            part += SVector::from(g) * weight;
            let mut part = hessian.fixed_view_mut::<PER_LINK, PER_LINK>(place, place);
            part += h * weight;
        }
        Some(Point { value, gradient, hessian })
    }
}

struct Point {
    value: f64,
    gradient: DVector<f64>,
    hessian: DMatrix<f64>,
}

/// log of the integral of |X|^g exp(-g tr X) over 4 x 4 positive definite X: log Gamma_4(g + 5/2) -
/// 4 (g + 5/2) log g (Muirhead, *Aspects of Multivariate Statistical Theory*, 1982, theorem 2.1.11).
/// The coordinates' constant volume is left out: it is the same for every g.
fn log_normaliser(g: f64) -> f64 {
    let a = g + 2.5;
    let multivariate: f64 = (0..4).map(|j| ln_gamma(a - 0.5 * f64::from(j))).sum();
    3.0 * std::f64::consts::PI.ln() + multivariate - 4.0 * a * g.ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigid_body::{is_possible, parameters};
    use crate::robot::builtin;

    /// Information as good as exact data for the base parameters of `truth`.
    fn told(base: &BaseParameters, truth: &Robot, precision: f64) -> Information {
        let size = base.sizes(truth).map(|s| (precision / s).powi(2));
        let gram = DMatrix::from_diagonal(&size);
        let pull = &gram * base.values(&parameters::of(truth));
        Information { gram, pull }
    }

    fn wrong(robot: &Robot) -> Robot {
        let mut model = robot.clone();
        for (i, body) in model.bodies.iter_mut().enumerate() {
            let factor = if i % 2 == 0 { 1.3 } else { 0.7 };
            body.inertia.mass *= factor;
            body.inertia.about_com *= factor;
        }
        model
    }

    #[test]
    fn base_parameters_are_met_and_every_link_is_possible() {
        let truth = builtin("ur5").unwrap();
        let base = BaseParameters::of(&truth, false);
        let found = estimate(&wrong(&truth), &base, &told(&base, &truth, 1e4), None).unwrap();
        let met = base.values(&found.parameters) - base.values(&parameters::of(&truth));
        let size = base.sizes(&truth);
        assert!(met.component_div(&size).amax() < 1e-2, "{met}");
        let arm = parameters::built_into(&truth, &found.parameters);
        assert!(arm.bodies.iter().all(|b| is_possible(&b.inertia)));
    }

    #[test]
    fn what_no_data_tell_stays_the_models() {
        let truth = builtin("ur5").unwrap();
        let base = BaseParameters::of(&truth, false);
        let found = estimate(&truth, &base, &told(&base, &truth, 1e-6), None).unwrap();
        assert!((&found.parameters - parameters::of(&truth)).amax() < 1e-6);
    }

    /// Links 30 % off call for a spread of that order; exact ones for the least.
    #[test]
    fn the_spread_is_what_the_data_call_for() {
        let truth = builtin("ur5").unwrap();
        let base = BaseParameters::of(&truth, false);
        let data = told(&base, &truth, 1e3);
        let off = estimate(&wrong(&truth), &base, &data, None).unwrap().spread;
        assert!((0.07..=0.6).contains(&off), "{off}");
        assert!(estimate(&truth, &base, &data, None).unwrap().spread <= 0.01);
    }

    /// Two values that the data give outright, beside links that they know.
    #[test]
    fn others_are_found_beside_the_links() {
        let robot = builtin("ur5").unwrap();
        let base = BaseParameters::of(&robot, false);
        let n = base.len();
        let links = told(&base, &robot, 1e3);
        let mut gram = links.gram.resize(n + 2, n + 2, 0.0);
        (gram[(n, n)], gram[(n + 1, n + 1)]) = (4.0, 100.0);
        let mut pull = links.pull.resize_vertically(n + 2, 0.0);
        (pull[n], pull[n + 1]) = (8.0, -50.0);
        let found = estimate(&robot, &base, &Information { gram, pull }, None).unwrap();
        assert!((found.others - DVector::from_vec(vec![2.0, -0.5])).amax() < 1e-9);
        assert!((found.covariance[(60, 60)] - 0.25).abs() < 1e-9);
        assert!((found.parameters - parameters::of(&robot)).amax() < 1e-6);
    }

    #[test]
    fn a_known_total_mass_is_kept() {
        let truth = builtin("ur5").unwrap();
        let base = BaseParameters::of(&truth, false);
        let data = told(&base, &truth, 1e2);
        let mass = |p: &DVector<f64>| p.iter().step_by(PER_LINK).sum::<f64>();
        let total = mass(&parameters::of(&truth));
        let found = estimate(&wrong(&truth), &base, &data, Some(total)).unwrap();
        assert!((mass(&found.parameters) / total - 1.0).abs() < 3e-3);
    }

    /// Compares the normaliser of a narrow prior with Laplace's approximation of the integral.
    #[test]
    fn the_normaliser_of_a_narrow_prior_is_laplaces() {
        let g = 4e4;
        let (value, _, hessian) = divergence(&Frame::origin()).unwrap();
        let log_det = (hessian * g).determinant().ln();
        let laplace = -g * value + 5.0 * (2.0 * std::f64::consts::PI).ln() - 0.5 * log_det;
        // Coordinates (Ixx, Iyy, Izz) have 1/4 of the volume of the matrix's own diagonal.
        let volume = jacobian().ln();
        assert!((laplace + volume - log_normaliser(g)).abs() < 1e-3);
    }

    /// Volume of (S11, S22, S33) per volume of (Ixx, Iyy, Izz).
    fn jacobian() -> f64 {
        let diagonal = nalgebra::Matrix3::from_fn(|i, k| if i == k { -0.5 } else { 0.5 });
        let volume: f64 = diagonal.determinant();
        volume.abs()
    }
}
