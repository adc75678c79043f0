//! All links other than in the twin at once: tau = sum over links of Y_j [dm, d(m c)].
//!
//! Where a whole model is a guess, one link after the other explains little: their torques overlap. It
//! is not in the catalogue, whose effects have as many parameters on any arm: what it injects, and
//! what a twin holds of it, is [`super::link_inertia`] at every link.

use super::link_inertia::LinkInertia;
use super::{About, Effect, Mechanism, Motion, Parameter, Role, Scope, starts};
use crate::robot::Robot;
use crate::series::JointSeries;

pub const NAME: &str = "inertial_parameters";
/// Of one link: mass and three first moments.
pub const PER_LINK: usize = 4;
const MOST_LINKS: usize = 8;

pub struct InertialParameters {
    about: About,
    links: usize,
}

/// Of an arm with so many links; `None` where there are too few to speak of several, or too many.
pub fn of_links(links: usize) -> Option<&'static dyn Effect> {
    let effect = ALL.get(links.checked_sub(2)?)?;
    Some(effect)
}

static ALL: [InertialParameters; MOST_LINKS - 1] =
    [all(2), all(3), all(4), all(5), all(6), all(7), all(8)];

const fn all(links: usize) -> InertialParameters {
    let about = About {
        name: NAME,
        law: "tau = sum_j Y_j(q, qd, qdd) [dm_j, d(m cx)_j, d(m cy)_j, d(m cz)_j]",
        scope: Scope::Arm,
        parameters: PARAMETERS.split_at(PER_LINK * links).0,
        memory: 0,
        dissipates: false,
        cause: "a model whose masses are guesses: CAD without cables and grease, copied from another \
                arm, or one number in every link",
        remedy: "identify the links (identify --with inertia) and use the URDF it writes",
        source: "Atkeson, An, Hollerbach, Int. J. Robotics Research 5(3), 1986: torque linear in inertial parameters",
    };
    InertialParameters { about, links }
}

impl Effect for InertialParameters {
    fn about(&self) -> &'static About {
        &ALL[self.links - 2].about
    }

    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        starts::grid(self.about.parameters, &[])
    }

    /// As of single links, about the twin's own centres.
    fn reach(&self, motion: &Motion<'_>, _: usize, _: &[f64]) -> Vec<JointSeries> {
        (0..self.links).flat_map(|link| LinkInertia.reach(motion, link, &[0.0; PER_LINK])).collect()
    }

    fn is_itself(&self, linear: &[f64]) -> bool {
        linear.iter().any(|v| *v != 0.0)
    }

    fn expected(&self, robot: &Robot, _: usize) -> Vec<f64> {
        (0..self.links).flat_map(|link| LinkInertia.expected(robot, link)).collect()
    }

    fn build(&self, values: &[f64], _: usize, mechanism: &mut Mechanism) {
        let links = values.as_chunks::<PER_LINK>().0.iter().take(self.links);
        links.enumerate().for_each(|(link, own)| LinkInertia.build(own, link, mechanism));
    }
}

const fn parameter(name: &'static str, symbol: &'static str) -> Parameter {
    let role = Role::Linear;
    Parameter { name, symbol, unit: "kg.m", min: -2.0, max: 2.0, typical: 0.05, null: 0.0, role }
}

macro_rules! links {
    ($($n:literal)*) => {
        [$(
            Parameter {
                name: concat!("link_mass_", $n),
                symbol: concat!("dm_", $n),
                unit: "kg",
                min: -5.0,
                max: 5.0,
                typical: 0.5,
                null: 0.0,
                role: Role::Linear,
            },
            parameter(concat!("link_moment_x_", $n), concat!("d(m cx)_", $n)),
            parameter(concat!("link_moment_y_", $n), concat!("d(m cy)_", $n)),
            parameter(concat!("link_moment_z_", $n), concat!("d(m cz)_", $n)),
        )*]
    };
}

const PARAMETERS: &[Parameter] = &links!(1 2 3 4 5 6 7 8);
