//! Base parameters: the combinations of inertial parameters that torque depends on.
//!
//! The columns of the regressor over random states are taken from the base to the tip; a column that
//! depends on those before it adds its parameter to theirs (Gautier, *Numerical calculation of the
//! base inertial parameters of robots*, J. Robotic Systems 8(4), 1991). Taken in this order the rules
//! of Gautier and Khalil come out: of every link Iyy, m cz and m go to links nearer the base.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::parameters::{self, PER_LINK};
use crate::kernels::dot;
use crate::regression::qr::{Qr, back_substitute};
use crate::robot::{Robot, Workspace, regressor};

/// beta = G pi, and what a joint's rotor inertia takes in besides.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameters {
    /// The parameters that stand for their group, by place in [`parameters::of`].
    pub independent: Vec<usize>,
    /// Parameters that have no effect on any torque, by place in [`parameters::of`].
    pub unseen: Vec<usize>,
    /// G, one row per base parameter.
    pub grouping: DMatrix<f64>,
    /// One row per joint: what cannot be told from its rotor's inertia; zero where that is known.
    pub rotors: DMatrix<f64>,
}

/// Random states for the dependencies: several times as many rows as columns.
const STATES_PER_JOINT: usize = 40;
/// A column that others explain to this share of its length depends on them, and smaller coefficients
/// are none. A right angle that a URDF rounds to 1.5708 rad leaves 4e-6, an offset of 1 mm on an arm of
/// 1 m leaves 1e-3.
const ROUNDING: f64 = 1e-4;
/// Order of the parameters within a link: what the rules group away comes last.
const ORDER: [usize; PER_LINK] = [1, 2, 4, 5, 7, 8, 9, 6, 3, 0];

impl BaseParameters {
    /// Base parameters of `robot`; `rotors`: are the joints' rotor inertias to be identified as well?
    pub fn of(robot: &Robot, rotors: bool) -> Self {
        let dof = robot.dof();
        let leading = if rotors { dof } else { 0 };
        let order: Vec<usize> =
            (0..dof).flat_map(|link| ORDER.map(|k| PER_LINK * link + k)).collect();
        let qr = Qr::within(columns(robot, leading, &order), ROUNDING);
        let is_independent = |column: usize| qr.r[(column, column)] != 0.0;
        let kept: Vec<usize> = (0..order.len()).filter(|i| is_independent(leading + i)).collect();
        let mut base = Self {
            independent: kept.iter().map(|&i| order[i]).collect(),
            unseen: Vec::new(),
            grouping: DMatrix::zeros(kept.len(), order.len()),
            rotors: DMatrix::zeros(dof, order.len()),
        };
        for (i, &parameter) in order.iter().enumerate() {
            let shares = shares(&qr, leading + i);
            if shares.iter().all(|s| *s == 0.0) {
                base.unseen.push(parameter);
            }
            for (row, &k) in kept.iter().enumerate() {
                base.grouping[(row, parameter)] = shares[leading + k];
            }
            for (joint, share) in shares[..leading].iter().enumerate() {
                base.rotors[(joint, parameter)] = *share;
            }
        }
        base.unseen.sort_unstable();
        base
    }

    pub fn len(&self) -> usize {
        self.independent.len()
    }

    pub fn is_empty(&self) -> bool {
        self.independent.is_empty()
    }

    /// Values of the base parameters for a robot's parameters.
    pub fn values(&self, parameters: &DVector<f64>) -> DVector<f64> {
        &self.grouping * parameters
    }

    /// How large each base parameter could be for links of the robot's mass and extent.
    pub fn sizes(&self, robot: &Robot) -> DVector<f64> {
        self.grouping.abs() * parameters::sizes(robot)
    }

    /// `Ixx_2 - Iyy_2 + 0.18 m_3`
    pub fn group(&self, row: usize) -> String {
        let lead = self.independent[row];
        let rest = self.grouping.row(row);
        let others = (0..rest.len()).filter(|&i| i != lead && rest[i] != 0.0);
        let terms = others.map(|i| term(rest[i], &parameters::name(i)));
        std::iter::once(parameters::name(lead)).chain(terms).collect::<Vec<_>>().join(" ")
    }

    /// What a joint's rotor inertia is identified with, `Izz_1 + Iyy_2 ..`; empty where it is alone.
    pub fn beside_rotor(&self, joint: usize) -> String {
        let row = self.rotors.row(joint);
        let all = (0..row.len()).filter(|&i| row[i] != 0.0);
        let terms: Vec<String> = all.map(|i| term(row[i], &parameters::name(i))).collect();
        terms.join(" ").trim_start_matches("+ ").to_string()
    }
}

fn term(factor: f64, name: &str) -> String {
    let sign = if factor < 0.0 { '-' } else { '+' };
    match (factor.abs() - 1.0).abs() < ROUNDING {
        true => format!("{sign} {name}"),
        false => format!("{sign} {:.4} {name}", factor.abs()),
    }
}

/// Column `k` as a combination of the independent ones up to itself.
fn shares(qr: &Qr, k: usize) -> Vec<f64> {
    let mut x = vec![0.0; qr.r.ncols()];
    if qr.r[(k, k)] != 0.0 {
        x[k] = 1.0;
        return x;
    }
    x[..k].copy_from_slice(&qr.r.column(k).as_slice()[..k]);
    back_substitute(&qr.r.view((0, 0), (k, k)).into_owned(), &mut x[..k]);
    x.iter_mut().filter(|v| v.abs() < ROUNDING).for_each(|v| *v = 0.0);
    x
}

/// Torque of all joints per unit of the first `rotors` rotor inertias, then of the parameters in
/// `order`, over random states.
fn columns(robot: &Robot, rotors: usize, order: &[usize]) -> Vec<Vec<f64>> {
    let dof = robot.dof();
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut columns = vec![Vec::new(); rotors + order.len()];
    let mut workspace = Workspace::new(robot);
    for _ in 0..STATES_PER_JOINT {
        let mut random = |size: f64| -> Vec<f64> {
            (0..dof).map(|_| size * (2.0 * rng.random::<f64>() - 1.0)).collect()
        };
        let (q, qd, qdd) = (random(std::f64::consts::PI), random(3.0), random(10.0));
        let y = regressor(robot, &mut workspace, &q, &qd, &qdd);
        for joint in 0..dof {
            let (of_rotors, of_links) = columns.split_at_mut(rotors);
            for (rotor, column) in of_rotors.iter_mut().enumerate() {
                column.push(if rotor == joint { qdd[joint] } else { 0.0 });
            }
            for (column, &parameter) in of_links.iter_mut().zip(order) {
                column.push(y[(joint, parameter)]);
            }
        }
    }
    clear_rounding(&mut columns[rotors..], order);
    columns
}

/// Columns that are nothing beside the longest of their unit have no torque.
fn clear_rounding(columns: &mut [Vec<f64>], order: &[usize]) {
    let lengths: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
    for (column, (&parameter, length)) in columns.iter_mut().zip(order.iter().zip(&lengths)) {
        let alike = order.iter().zip(&lengths);
        let alike = alike.filter(|(o, _)| parameters::unit(**o) == parameters::unit(parameter));
        let longest = alike.map(|(_, l)| *l).fold(0.0, f64::max);
        if *length <= ROUNDING * longest {
            column.fill(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::builtin;

    /// The rigid body of every UR arm, whose second, third and fourth axes are parallel, has 36.
    #[test]
    fn a_ur_has_thirty_six_base_parameters() {
        for name in ["ur3", "ur5", "ur10", "ur5e", "ur10e"] {
            let base = BaseParameters::of(&builtin(name).unwrap(), false);
            assert_eq!(base.len(), 36, "{name}");
        }
    }

    /// What the base parameters do not change is no torque: G's null space moves nothing.
    #[test]
    fn torque_depends_on_the_base_parameters_alone() {
        let robot = builtin("ur5").unwrap();
        let base = BaseParameters::of(&robot, false);
        let mut workspace = Workspace::new(&robot);
        let state = |f: f64| (0..6).map(|j| (f * (j as f64 + 0.7)).sin()).collect::<Vec<_>>();
        let y = regressor(&robot, &mut workspace, &state(1.3), &state(2.1), &state(3.7));
        let own: Vec<_> = base.independent.iter().map(|&i| y.column(i)).collect();
        let by_base = DMatrix::from_columns(&own) * base.values(&parameters::of(&robot));
        assert!((by_base - &y * parameters::of(&robot)).amax() < 1e-6);
    }

    /// A rotor's acceleration is its link's about the same axis, where nothing else turns it.
    #[test]
    fn the_first_rotor_cannot_be_told_from_the_first_link() {
        let robot = builtin("ur5").unwrap();
        let base = BaseParameters::of(&robot, true);
        let beside = base.beside_rotor(0);
        assert!(beside.contains("Izz_1") || beside.contains("Iyy_1"), "{beside}");
        // A mass on the vertical first axis has no torque.
        assert!(base.unseen.contains(&0), "{:?}", base.unseen);
        assert_eq!(base.len() + 6, BaseParameters::of(&robot, false).len() + told_rotors(&base));
    }

    /// Rotors with nothing beside them.
    fn told_rotors(base: &BaseParameters) -> usize {
        (0..6).filter(|&j| base.beside_rotor(j).is_empty()).count()
    }

    #[test]
    fn groups_are_read_as_sums() {
        let base = BaseParameters::of(&builtin("ur5").unwrap(), false);
        let row = base.independent.iter().position(|&i| i == 14).unwrap();
        assert!(base.group(row).starts_with("Ixx_2 "), "{}", base.group(row));
    }
}
