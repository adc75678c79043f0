//! A link's mass and centre of mass other than in the twin: tau = Y_j [dm, d(m c)].
//!
//! First moments m c are in the link's frame. The rotational inertia about the centre of mass stays;
//! what m c c^T adds to it is not linear in m and h = m c. The columns take it between the twin's
//! link and a reference change, which is exact for that change (fit again with what was fitted). Not
//! all combinations can be seen: a mass on a vertical first axis has no torque.

use nalgebra::{Matrix3, Vector3};

use super::rigid::torque_of_change;
use super::{About, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Worked};
use crate::robot::{Inertia, Robot};
use crate::series::JointSeries;

pub struct LinkInertia;

static ABOUT: About = About {
    name: "link_inertia",
    law: "tau = Y_j(q, qd, qdd) [dm, d(m cx), d(m cy), d(m cz)]",
    scope: Scope::Link,
    parameters: &[
        Parameter {
            name: "link_mass",
            symbol: "dm",
            unit: "kg",
            min: -5.0,
            max: 5.0,
            typical: 0.5,
            null: 0.0,
            role: Role::Linear,
        },
        moment("link_moment_x", "d(m cx)"),
        moment("link_moment_y", "d(m cy)"),
        moment("link_moment_z", "d(m cz)"),
        Parameter::reference("link_mass_reference", "dm0", "kg", 5.0),
        Parameter::reference("link_x_reference", "dhx0", "kg.m", 2.0),
        Parameter::reference("link_y_reference", "dhy0", "kg.m", 2.0),
        Parameter::reference("link_z_reference", "dhz0", "kg.m", 2.0),
    ],
    memory: 0,
    dissipates: false,
    cause: "CAD masses that leave out cables, grease and screws; parts bolted to a link",
    remedy: "correct the link's mass and centre of mass in the URDF",
    source: "Atkeson, An, Hollerbach, Int. J. Robotics Research 5(3), 1986: torque linear in inertial parameters",
};

impl Effect for LinkInertia {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn reach(&self, motion: &Motion<'_>, from: usize, reference: &[f64]) -> Vec<JointSeries> {
        let body = motion.regressor(from);
        let inertia = &motion.robot.bodies[from].inertia;
        let new = changed(inertia, reference).unwrap_or(*inertia);
        (0..4).map(|i| torque_of_change(&body, &per_unit(inertia.com, new.com, i), from)).collect()
    }

    fn expected(&self, robot: &Robot, joint: usize, _: &[f64]) -> Vec<f64> {
        let inertia = &robot.bodies[joint].inertia;
        let moment = inertia.mass * (CENTRE_ERROR_M + MASS_ERROR * inertia.com.norm());
        vec![MASS_ERROR * inertia.mass, moment, moment, moment]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        let inertia = &mut mechanism.robot.bodies[joint].inertia;
        *inertia = changed(inertia, values).unwrap_or(*inertia);
    }

    fn worked(&self) -> Option<Worked> {
        Some(Worked::torque(
            "0.1 kg.m x 9.81 m/s2, level",
            0.981,
            &[("link_moment_x", 0.1)],
            [0.0; 3],
        ))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        // Masses are told in combinations alone.
        Some(RoundTrip::fitted(&[]))
    }
}

/// By dm and d(m c); `None` where nothing changes or no mass is left.
fn changed(inertia: &Inertia, by: &[f64]) -> Option<Inertia> {
    let [dm, x, y, z] = *by.first_chunk()?;
    let mass = inertia.mass + dm;
    let moment = inertia.com * inertia.mass + Vector3::new(x, y, z);
    let some = by.iter().any(|v| *v != 0.0) && mass > 0.0;
    some.then(|| Inertia { mass, com: moment / mass, ..*inertia })
}

const fn moment(name: &'static str, symbol: &'static str) -> Parameter {
    let role = Role::Linear;
    Parameter { name, symbol, unit: "kg.m", min: -2.0, max: 2.0, typical: 0.05, null: 0.0, role }
}

/// What data sheets and CAD are commonly wrong by: of a mass, and of its centre, m.
const MASS_ERROR: f64 = 0.1;
const CENTRE_ERROR_M: f64 = 0.02;

/// The ten inertial parameters per unit of dm (`i` = 0) or of a first moment, between the centres
/// c and c': d(m c c^T) = sym((c + c') dh^T) - dm sym(c c'^T).
fn per_unit(c: Vector3<f64>, new: Vector3<f64>, i: usize) -> [f64; 10] {
    let (dm, dh) = match i {
        0 => (1.0, Vector3::zeros()),
        _ => (0.0, Vector3::ith(i - 1, 1.0)),
    };
    let twice = (c + new) * dh.transpose() - c * new.transpose() * dm;
    let second = 0.5 * (twice + twice.transpose());
    let o = Matrix3::identity() * second.trace() - second;
    [dm, dh.x, dh.y, dh.z, o.m11, o.m12, o.m22, o.m13, o.m23, o.m33]
}
