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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{builtin, inverse_dynamics_series};

    /// Links that grow about their centres have the torque of the columns, exactly.
    #[test]
    fn columns_are_the_torque_of_the_links_that_are_built() {
        let robot = builtin("ur5").unwrap();
        let series = |s: f64| {
            let joint = |j: usize| (0..20).map(|k| (s * (k * 3 + j + 1) as f64).sin()).collect();
            JointSeries::from_joints(&(0..6).map(joint).collect::<Vec<Vec<f64>>>())
        };
        let (q, qd, qdd) = (series(0.7), series(1.1), series(1.9));
        let effect = of_links(6).unwrap();
        let shares = [0.1, -0.2, 0.3, -0.1, 0.2, 0.5];
        let values: Vec<f64> = robot
            .bodies
            .iter()
            .zip(shares)
            .flat_map(|(b, share)| {
                let dm = share * b.inertia.mass;
                let dh = b.inertia.com * dm;
                [dm, dh.x, dh.y, dh.z]
            })
            .collect();
        assert_eq!(effect.about().parameters.len(), values.len());
        assert_eq!(effect.about().parameters[9].name, "link_moment_x_3");
        let mut mechanism = Mechanism::new(robot.clone());
        effect.build(&values, 0, &mut mechanism);
        let torque = |robot: &Robot| inverse_dynamics_series(robot, &q, &qd, &qdd);
        let (built, before) = (torque(&mechanism.robot), torque(&robot));
        let columns = effect.reach(&Motion::new(&robot, 0.008, &q, &qd, &qdd), 0, &[]);
        for joint in 0..6 {
            for k in 0..20 {
                let terms = columns.iter().zip(&values).map(|(c, v)| c.joint(joint)[k] * v);
                let change = built.joint(joint)[k] - before.joint(joint)[k];
                assert!((terms.sum::<f64>() - change).abs() < 1e-9, "joint {}", joint + 1);
            }
        }
    }

    #[test]
    fn one_link_is_not_several() {
        assert!(of_links(1).is_none() && of_links(2).is_some() && of_links(9).is_none());
    }
}
