//! Other readings of the same columns: units, signs and orders that files come with.

use super::Doubt;
use crate::series::JointSeries;

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Joints of which every order is tried, three at a time.
const SHUFFLED: usize = 4;

/// Which column is which joint's, and what it is multiplied by.
#[derive(Debug, Clone)]
pub struct Reading {
    /// Column of the position of joint j.
    pub q: Vec<usize>,
    pub torque: Vec<usize>,
    q_scale: Vec<f64>,
    torque_scale: Vec<f64>,
    /// -1 for an arm that hangs where the twin stands.
    pub gravity: f64,
    /// What is said where this is how they should have been read.
    pub doubt: Doubt,
}

impl Reading {
    pub fn as_it_stands(dof: usize) -> Self {
        Self {
            q: (0..dof).collect(),
            torque: (0..dof).collect(),
            q_scale: vec![1.0; dof],
            torque_scale: vec![1.0; dof],
            gravity: 1.0,
            doubt: Doubt { what: String::new(), remedy: String::new() },
        }
    }

    /// A series of position, velocity or acceleration, from columns to joints.
    pub fn position(&self, columns: &JointSeries) -> JointSeries {
        columns.map_joints(|j, _| {
            columns.joint(self.q[j]).iter().map(|x| self.q_scale[j] * x).collect()
        })
    }

    pub fn torque_of(&self, columns: &JointSeries, j: usize) -> Vec<f64> {
        columns.joint(self.torque[j]).iter().map(|x| self.torque_scale[j] * x).collect()
    }

    /// Torque columns of joints that are read otherwise.
    pub fn columns(&self) -> impl Iterator<Item = usize> {
        let otherwise = |j: &usize| {
            self.q[*j] != *j
                || self.torque[*j] != *j
                || self.q_scale[*j] != 1.0
                || self.torque_scale[*j] != 1.0
        };
        (0..self.q.len()).filter(otherwise).map(|j| self.torque[j])
    }
}

/// The list, the simpler first.
pub fn alternatives(dof: usize) -> Vec<Reading> {
    let usual = Reading::as_it_stands(dof);
    let mut all = whole(&usual);
    for j in 0..dof {
        all.extend(turned(&usual, j));
    }
    for i in 0..dof {
        for j in i + 1..dof {
            all.extend(swapped(&usual, &|order: &mut Vec<usize>| order.swap(i, j)));
            for k in j + 1..dof.min(SHUFFLED) {
                for [a, b, c] in [[i, j, k], [i, k, j]] {
                    let cycle = |order: &mut Vec<usize>| {
                        let old = order.clone();
                        (order[a], order[b], order[c]) = (old[b], old[c], old[a]);
                    };
                    all.push(together(&usual, &cycle));
                }
            }
        }
    }
    all.push(together(&usual, &|order| order.reverse()));
    all
}

fn doubt(what: impl Into<String>, remedy: impl Into<String>) -> Doubt {
    Doubt { what: what.into(), remedy: format!("{} in a column map (--columns)", remedy.into()) }
}

/// What concerns all joints alike.
fn whole(usual: &Reading) -> Vec<Reading> {
    let n = usual.q.len();
    let degrees = |factor: f64, unit: &str| Reading {
        q_scale: vec![factor; n],
        doubt: doubt(
            format!(
                "the recorded torque carries the arm where actual_q is read {unit}, not as it is"
            ),
            format!("say scale = {factor:.9} for actual_q and actual_qd"),
        ),
        ..usual.clone()
    };
    let torque = Reading {
        torque_scale: vec![-1.0; n],
        doubt: doubt(
            "the recorded torque has the opposite sign at every joint: it goes along with weight and \
             friction",
            "say scale = -1 for the torque or current",
        ),
        ..usual.clone()
    };
    let positions = Reading {
        q_scale: vec![-1.0; n],
        doubt: doubt(
            "the recorded torque carries the arm where every joint counts the other way",
            "say scale = -1 for actual_q and actual_qd",
        ),
        ..usual.clone()
    };
    let hangs = Reading {
        gravity: -1.0,
        doubt: Doubt {
            what:
                "the recorded torque carries an arm that is mounted upside down, the twin's stands"
                    .into(),
            remedy: "give a twin with a URDF whose base says so".into(),
        },
        ..usual.clone()
    };
    vec![
        degrees(DEGREE, "in degrees"),
        degrees(1.0 / DEGREE, "in rad, which were scaled as degrees"),
        torque,
        positions,
        hangs,
    ]
}

/// One joint that counts the other way.
fn turned(usual: &Reading, j: usize) -> [Reading; 2] {
    let turned = |scale: &[f64]| {
        let mut scale = scale.to_vec();
        scale[j] = -1.0;
        scale
    };
    let list = turned(&usual.q_scale).iter().map(|s| s.to_string()).collect::<Vec<_>>().join(", ");
    [
        Reading {
            torque_scale: turned(&usual.torque_scale),
            doubt: doubt(
                format!(
                    "joint {}: the recorded torque has the opposite sign: it goes along with weight and \
                     friction",
                    j + 1
                ),
                format!("say scale = [{list}] for the torque or current"),
            ),
            ..usual.clone()
        },
        Reading {
            q_scale: turned(&usual.q_scale),
            doubt: doubt(
                format!(
                    "joint {}: the recorded torque carries the arm where it counts the other way",
                    j + 1
                ),
                format!("say scale = [{list}] for actual_q and actual_qd"),
            ),
            ..usual.clone()
        },
    ]
}

/// Torque alone, positions alone, or both in another order.
fn swapped(usual: &Reading, order: &dyn Fn(&mut Vec<usize>)) -> [Reading; 3] {
    let mut other = usual.q.clone();
    order(&mut other);
    let of = |what: &str| {
        doubt(
            format!(
                "the columns of {what} are in another order: the arm is carried where those of joints {} \
                 are read as joints {}",
                list(&other, &other),
                list(&usual.q, &other)
            ),
            "name the columns joint by joint, base to wrist,",
        )
    };
    [
        Reading { torque: other.clone(), doubt: of("the torque or current"), ..usual.clone() },
        Reading { q: other.clone(), doubt: of("the positions"), ..usual.clone() },
        together(usual, order),
    ]
}

fn together(usual: &Reading, order: &dyn Fn(&mut Vec<usize>)) -> Reading {
    let mut other = usual.q.clone();
    order(&mut other);
    Reading {
        doubt: doubt(
            format!(
                "the joints are in another order: the arm is carried where columns {} are read as \
                 joints {}",
                list(&other, &other),
                list(&usual.q, &other)
            ),
            "name the columns joint by joint, base to wrist,",
        ),
        q: other.clone(),
        torque: other,
        ..usual.clone()
    }
}

/// Those of `joints` that `order` moves, from 1.
fn list(joints: &[usize], order: &[usize]) -> String {
    let moved = joints.iter().enumerate().filter(|(at, _)| order[*at] != *at);
    moved.map(|(_, j)| (j + 1).to_string()).collect::<Vec<_>>().join(", ")
}
