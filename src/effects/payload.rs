//! A load at the flange, a rigid body: tau = Y_flange(q, qd, qdd) [m, m cx, m cy, m cz, I].
//!
//! I is the inertia about the centre of mass, along the flange's axes. What m c c^T adds to it is not
//! linear in m and h = m c. The columns take it at a reference centre r, S = r h^T + h r^T - m r r^T,
//! which is exact for c = r (fit again with r = h / m).

use std::ops::Range;

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use super::rigid::torque_of_change;
use super::{
    About, Effect, Mechanism, Motion, Parameter, Ratio, Role, RoundTrip, Scope, Worked, starts,
};
use crate::robot::{Placement, Robot};
use crate::series::JointSeries;

pub struct Payload;

static ABOUT: About = About {
    name: "payload",
    law: "tau = Y_flange(q, qd, qdd) [m, m cx, m cy, m cz, I]",
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
        inertia("payload_inertia_xx", "Ixx", 0.008),
        inertia("payload_inertia_yy", "Iyy", 0.008),
        inertia("payload_inertia_zz", "Izz", 0.008),
        inertia("payload_inertia_xy", "Ixy", 0.0),
        inertia("payload_inertia_xz", "Ixz", 0.0),
        inertia("payload_inertia_yz", "Iyz", 0.0),
        Parameter::reference("payload_x_reference", "rx", "m", 5.0),
        Parameter::reference("payload_y_reference", "ry", "m", 5.0),
        Parameter::reference("payload_z_reference", "rz", "m", 5.0),
        Parameter::reference("payload_m_reference", "m0", "kg", 15.0),
    ],
    memory: 0,
    dissipates: false,
    cause: "a tool or load at the flange that the twin does not carry",
    remedy: "add a body of this mass, centre of mass and inertia at the flange (tool0)",
    source: "Khalil, Gautier, Lemoine, ICRA 2007; Atkeson, An, Hollerbach, IJRR 5(3), 1986",
};

impl Effect for Payload {
    fn depends_on_load(&self) -> bool {
        false
    }

    fn about(&self) -> &'static About {
        &ABOUT
    }

    /// One: gravity alone tells mass and centre well enough to settle on them.
    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        starts::grid(ABOUT.parameters, &[])
    }

    fn readable(&self) -> &'static [Ratio] {
        &CENTRE
    }

    /// First moments and inertia of a load that has the mass m0 and is as long as tools are; before there is such
    /// a mass, the inertia of one that is as heavy as tools are.
    fn expected(&self, robot: &Robot, _: usize, reference: &[f64]) -> Vec<f64> {
        let length = TOOL_LENGTH * robot.reach();
        let found = reference.get(MASS_REFERENCE).copied().filter(|m| *m > LIGHTEST_KG);
        let moment = found.map_or(f64::INFINITY, |m| m * 0.5 * length);
        let inertia = found.unwrap_or(TOOL_MASS * robot.mass()) * length.powi(2) / 12.0;
        [[f64::INFINITY].as_slice(), &[moment; 3], &[inertia; 6]].concat()
    }

    fn keep_physical(&self, values: &mut [f64]) {
        let Some(own) = values.get_mut(INERTIA) else { return };
        let i = possible(symmetric(own));
        own.copy_from_slice(&[i.m11, i.m22, i.m33, i.m12, i.m13, i.m23]);
    }

    fn settle(&self, linear: &[f64], nonlinear: &mut [f64]) {
        if linear[0] > LIGHTEST_KG {
            let references = ABOUT.parameters.iter().filter(|p| p.is_reference());
            let centre = linear[MOMENT].iter().map(|moment| moment / linear[0]);
            let found = centre.chain([linear[0]]);
            for ((r, found), p) in nonlinear.iter_mut().zip(found).zip(references) {
                *r = p.clamp(found);
            }
        }
    }

    fn reach(&self, motion: &Motion<'_>, _: usize, reference: &[f64]) -> Vec<JointSeries> {
        let robot = motion.robot;
        let Some(carrier) = robot.carrier() else { return vec![] };
        let body = motion.regressor(carrier);
        let combine = |p: [f64; 10]| torque_of_change(&body, &p, carrier);
        let reference = Vector3::from_column_slice(&reference[..3]);
        let point = flange_parameters(&robot.flange, reference);
        point.into_iter().chain(rotational(&robot.flange)).map(combine).collect()
    }

    fn build(&self, values: &[f64], _: usize, mechanism: &mut Mechanism) {
        let mass = values[0];
        if mass > 0.0 {
            let com = Vector3::from_column_slice(&values[MOMENT]) / mass;
            let about_com = possible(symmetric(&values[INERTIA]));
            mechanism.robot = mechanism.robot.with_payload(mass, com, about_com);
        }
    }

    fn worked(&self) -> Option<Worked> {
        let text =
            "(2 kg x 0.5 m + 0.1 kg.m) x 9.81 m/s2 + (2 kg (0.55 m)^2 + 0.02 kg.m2) x 3 rad/s2";
        let values = [
            ("payload_mass", 2.0),
            ("payload_moment_x", 0.1),
            ("payload_inertia_xx", 0.01),
            ("payload_inertia_yy", 0.02),
            ("payload_inertia_zz", 0.015),
        ];
        Some(Worked::torque(text, 10.791 + 1.875, &values, [0.0, 0.0, 3.0]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["payload_mass"]))
    }
}

const fn moment(name: &'static str, symbol: &'static str, typical: f64) -> Parameter {
    let role = Role::Linear;
    Parameter { name, symbol, unit: "kg.m", min: -3.0, max: 3.0, typical, null: 0.0, role }
}

/// About the centre of mass; a load in a file is a point where it has none. What a body can have is no range of
/// single values ([`Effect::keep_physical`]).
const fn inertia(name: &'static str, symbol: &'static str, typical: f64) -> Parameter {
    let role = Role::Linear;
    Parameter { name, symbol, unit: "kg.m2", min: -1.0, max: 1.0, typical, null: 0.0, role }
}

/// Places of the first moments and of the inertia among the values.
const MOMENT: Range<usize> = 1..4;
const INERTIA: Range<usize> = 4..10;
/// Place of m0 among the references.
const MASS_REFERENCE: usize = 3;

const CENTRE: [Ratio; 3] = [
    centre("payload_centre_x", "payload_moment_x"),
    centre("payload_centre_y", "payload_moment_y"),
    centre("payload_centre_z", "payload_moment_z"),
];

const fn centre(name: &'static str, of: &'static str) -> Ratio {
    Ratio { name, unit: "m", of, over: "payload_mass" }
}

/// How large a load can be expected to be: as heavy as a tenth of the arm, and a rod a third as long as its reach.
const TOOL_MASS: f64 = 0.1;
const TOOL_LENGTH: f64 = 1.0 / 3.0;

/// From xx, yy, zz, xy, xz, yz.
fn symmetric(i: &[f64]) -> Matrix3<f64> {
    Matrix3::new(i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2])
}

/// The nearest inertia that a body can have: its second moment tr(I) 1 / 2 - I is nowhere negative
/// (Traversaro et al., IROS 2016), so that no principal moment is larger than the others together.
fn possible(inertia: Matrix3<f64>) -> Matrix3<f64> {
    let second = SymmetricEigen::new(Matrix3::identity() * (0.5 * inertia.trace()) - inertia);
    if second.eigenvalues.iter().all(|s| *s >= 0.0) {
        return inertia;
    }
    let axes = second.eigenvectors;
    let kept =
        axes * Matrix3::from_diagonal(&second.eigenvalues.map(|s| s.max(0.0))) * axes.transpose();
    Matrix3::identity() * kept.trace() - kept
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

/// The last body's ten inertial parameters per unit of each component of a load's inertia about its centre.
fn rotational(flange: &Placement) -> [[f64; 10]; 6] {
    std::array::from_fn(|k| {
        let unit: [f64; 6] = std::array::from_fn(|i| f64::from(i == k));
        let i = flange.rotation * symmetric(&unit) * flange.rotation.transpose();
        [0.0, 0.0, 0.0, 0.0, i.m11, i.m12, i.m22, i.m13, i.m23, i.m33]
    })
}

/// From mass, first moment and second moment S (integral of x x^T dm): inertia = tr(S) 1 - S.
fn parameters(mass: f64, h: Vector3<f64>, s: Matrix3<f64>) -> [f64; 10] {
    let i = Matrix3::identity() * s.trace() - s;
    [mass, h.x, h.y, h.z, i.m11, i.m12, i.m22, i.m13, i.m23, i.m33]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice as heavy, twice the moments and inertia; before a mass is found, those of a tenth of the arm.
    #[test]
    fn what_is_expected_of_a_load_follows_its_mass() {
        let robot = crate::robot::builtin("ur5").unwrap();
        let of = |reference: &[f64]| Payload.expected(&robot, 0, reference);
        let (light, heavy) = (of(&[0.0, 0.0, 0.0, 0.5]), of(&[0.0, 0.0, 0.0, 1.0]));
        let usual = of(&[]);
        for i in MOMENT.start..INERTIA.end {
            assert!((heavy[i] / light[i] - 2.0).abs() < 1e-12, "{i}: {heavy:?}");
        }
        assert!(light[0].is_infinite() && usual[..MOMENT.end].iter().all(|s| s.is_infinite()));
        let tool = of(&[0.0, 0.0, 0.0, TOOL_MASS * robot.mass()]);
        assert_eq!(usual[INERTIA], tool[INERTIA]);
    }

    /// A thin plate has the largest moment that the two others allow; more is taken back to it, and what
    /// is possible stays.
    #[test]
    fn no_inertia_is_one_that_no_body_has() {
        let kept = |inertia: [f64; 6]| {
            let mut values = [&[2.0, 0.0, 0.0, 0.1], &inertia[..], &[0.0, 0.0, 0.05]].concat();
            Payload.keep_physical(&mut values);
            symmetric(&values[INERTIA])
        };
        let plate = [0.01, 0.02, 0.03, 0.0, 0.0, 0.0];
        assert_eq!(kept(plate), symmetric(&plate));
        for wrong in [[0.01, 0.02, 0.3, 0.0, 0.0, 0.0], [-0.01, 0.02, 0.02, 0.001, 0.0, 0.03]] {
            let mut moments: Vec<f64> =
                kept(wrong).symmetric_eigenvalues().iter().copied().collect();
            moments.sort_by(f64::total_cmp);
            assert!(moments[0] >= -1e-12, "{moments:?}");
            assert!(moments[2] <= moments[0] + moments[1] + 1e-12, "{moments:?}");
        }
    }
}
