//! A load at the flange: tau = Y_flange(q, qd, qdd) [m, m cx, m cy, m cz].
//!
//! A compact load: a point mass as far as rotation goes. Its second moment S = m c c^T is not linear
//! in m and h = m c. The columns take it at a reference centre r, S = r h^T + h r^T - m r r^T,
//! which is exact for c = r (fit again with r = h / m).

use nalgebra::{Matrix3, Vector3};

use super::{About, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Worked, starts};
use crate::robot::Placement;
use crate::series::JointSeries;

pub struct Payload;

static ABOUT: About = About {
    name: "payload",
    law: "tau = Y_flange(q, qd, qdd) [m, m cx, m cy, m cz]",
    scope: Scope::Arm,
    parameters: &[
        Parameter {
            name: "payload_mass",
            symbol: "m",
            unit: "kg",
            min: 0.0,
            max: 15.0,
            typical: 2.0,
            null: 0.0,
            role: Role::Linear,
        },
        moment("payload_moment_x", "m cx", 0.0),
        moment("payload_moment_y", "m cy", 0.0),
        moment("payload_moment_z", "m cz", 0.14),
        reference("payload_x_reference", "rx"),
        reference("payload_y_reference", "ry"),
        reference("payload_z_reference", "rz"),
    ],
    memory: 0,
    dissipates: false,
    cause: "a tool or load at the flange that the twin does not carry",
    remedy: "add a body of this mass and centre of mass at the flange (tool0)",
    source: "Khalil, Gautier, Lemoine, ICRA 2007; Atkeson, An, Hollerbach, IJRR 5(3), 1986",
};

impl Effect for Payload {
    fn depends_on_load(&self) -> bool {
        false
    }

    fn about(&self) -> &'static About {
        &ABOUT
    }

    /// One: gravity alone tells the centre well enough to settle on it.
    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        starts::grid(ABOUT.parameters, &[])
    }

    fn settle(&self, linear: &[f64], nonlinear: &mut [f64]) {
        if linear[0] > LIGHTEST_KG {
            let references = ABOUT.parameters.iter().filter(|p| p.is_reference());
            for ((r, moment), p) in nonlinear.iter_mut().zip(&linear[1..]).zip(references) {
                *r = p.clamp(moment / linear[0]);
            }
        }
    }

    fn reach(&self, motion: &Motion<'_>, _: usize, reference: &[f64]) -> Vec<JointSeries> {
        let robot = motion.robot;
        let Some(last) = robot.dof().checked_sub(1) else { return vec![] };
        let body = motion.regressor(last);
        let combine = |p: [f64; 10]| weighted_sum(&body, &p);
        let reference = Vector3::from_column_slice(reference);
        flange_parameters(&robot.flange, reference).map(combine).to_vec()
    }

    fn build(&self, values: &[f64], _: usize, mechanism: &mut Mechanism) {
        let mass = values[0];
        if mass > 0.0 {
            let com = Vector3::new(values[1], values[2], values[3]) / mass;
            mechanism.robot = mechanism.robot.with_payload(mass, com, Matrix3::zeros());
        }
    }

    fn worked(&self) -> Option<Worked> {
        let text = "(2 kg x 0.5 m + 0.1 kg.m) x 9.81 m/s2 + 2 kg (0.55 m)^2 x 3 rad/s2";
        let values = [("payload_mass", 2.0), ("payload_moment_x", 0.1)];
        Some(Worked::torque(text, 10.791 + 1.815, &values, [0.0, 0.0, 3.0]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["payload_mass"]))
    }
}

const fn moment(name: &'static str, symbol: &'static str, typical: f64) -> Parameter {
    let role = Role::Linear;
    Parameter { name, symbol, unit: "kg.m", min: -3.0, max: 3.0, typical, null: 0.0, role }
}

/// m
const fn reference(name: &'static str, symbol: &'static str) -> Parameter {
    let (role, null) = (Role::Nonlinear, f64::NAN);
    Parameter { name, symbol, unit: "m", min: -5.0, max: 5.0, typical: 0.0, null, role }
}

/// Below this mass (kg) moments say nothing about a centre.
const LIGHTEST_KG: f64 = 0.01;

/// The last body's ten inertial parameters ([`crate::robot::Inertia::parameters`]) per unit of
/// m, m cx, m cy and m cz in the flange's frame: with d from the body to the flange and R r the
/// reference in the body's axes, e = d + R r, a load's S is e h^T + h e^T + m (d d^T - R r r^T R^T).
fn flange_parameters(flange: &Placement, reference: Vector3<f64>) -> [[f64; 10]; 4] {
    let (d, r) = (flange.translation, flange.rotation * reference);
    let axis = |i: usize| flange.rotation.column(i).into_owned();
    let e = d + r;
    let moment = |h: Vector3<f64>| parameters(0.0, h, e * h.transpose() + h * e.transpose());
    let mass = parameters(1.0, d, d * d.transpose() - r * r.transpose());
    [mass, moment(axis(0)), moment(axis(1)), moment(axis(2))]
}

/// From mass, first moment and second moment S (integral of x x^T dm): inertia = tr(S) 1 - S.
fn parameters(mass: f64, h: Vector3<f64>, s: Matrix3<f64>) -> [f64; 10] {
    let i = Matrix3::identity() * s.trace() - s;
    [mass, h.x, h.y, h.z, i.m11, i.m12, i.m22, i.m13, i.m23, i.m33]
}

fn weighted_sum(columns: &[JointSeries; 10], weights: &[f64; 10]) -> JointSeries {
    columns[0].map_joints(|joint, first| {
        let mut sum = vec![0.0; first.len()];
        for (column, &weight) in columns.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
            sum.iter_mut().zip(column.joint(joint)).for_each(|(s, c)| *s += weight * c);
        }
        sum
    })
}
