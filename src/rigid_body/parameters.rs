//! The ten inertial parameters of every link in one vector, link after link from the base, each in the
//! order of [`Inertia::parameters`]: [m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz], the inertia
//! about the origin of the link's frame.

use nalgebra::DVector;

use crate::robot::{Inertia, Robot};

/// Number of inertial parameters per link.
pub const PER_LINK: usize = 10;

/// Names of the parameters, which [`name`] ends with the link's number.
pub const NAMES: [&str; PER_LINK] =
    ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"];

/// Name of parameter `index`; `Ixx_2` is that of the second link from the base.
pub fn name(index: usize) -> String {
    format!("{}_{}", NAMES[index % PER_LINK], index / PER_LINK + 1)
}

pub fn unit(index: usize) -> &'static str {
    match index % PER_LINK {
        0 => "kg",
        1..=3 => "kg.m",
        _ => "kg.m2",
    }
}

/// Inertial parameters of all links.
pub fn of(robot: &Robot) -> DVector<f64> {
    let all = robot.bodies.iter().flat_map(|b| b.inertia.parameters());
    DVector::from_iterator(PER_LINK * robot.dof(), all)
}

/// How large each could be for a link of this mass and extent: m, m r and m r^2 with the radius of
/// gyration r about the origin, which a parameter that happens to be zero does not tell.
pub fn sizes(robot: &Robot) -> DVector<f64> {
    let all = robot.bodies.iter().flat_map(|b| {
        let mass = b.inertia.mass;
        let square = b.inertia.about_origin().trace() / 2.0;
        let moment = (mass * square).sqrt();
        [mass, moment, moment, moment, square, square, square, square, square, square]
    });
    DVector::from_iterator(PER_LINK * robot.dof(), all)
}

/// The robot with these links.
pub fn built_into(robot: &Robot, values: &DVector<f64>) -> Robot {
    let mut new = robot.clone();
    for (body, p) in new.bodies.iter_mut().zip(values.as_slice().as_chunks::<PER_LINK>().0) {
        body.inertia = Inertia::from_parameters(p);
    }
    new
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::builtin;

    #[test]
    fn a_robot_is_built_from_its_own_parameters() {
        let robot = builtin("ur10e").unwrap();
        let again = built_into(&robot, &of(&robot));
        assert!((of(&again) - of(&robot)).amax() < 1e-12);
        assert_eq!((name(14), unit(14)), ("Ixx_2".to_string(), "kg.m2"));
    }

    #[test]
    fn no_parameter_is_larger_than_its_size() {
        let robot = builtin("ur5").unwrap();
        let (values, sizes) = (of(&robot), sizes(&robot));
        // Ixx of a thin rod along y is all of the trace's half.
        values.iter().zip(sizes.iter()).for_each(|(v, s)| assert!(v.abs() <= 1.0001 * s));
    }
}
