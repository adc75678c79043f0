//! Arms inside a larger robot against pinocchio's numbers for the whole robot
//! (`tests/golden/chain.py` makes them).

use serde::Deserialize;

use super::super::{Chain, read, write};
use crate::robot::{Workspace, flange_placement, inverse_dynamics};

const CART: &str = include_str!("../../../../scenarios/robots/cart_with_two_arms.urdf");

#[derive(Deserialize)]
struct File {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    base: String,
    tip: String,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    inverse: Vec<f64>,
    tip_translation: Vec<f64>,
    /// Row by row.
    tip_rotation: Vec<f64>,
}

impl Case {
    fn chain(&self) -> Chain {
        Chain { base: Some(self.base.clone()), tip: Some(self.tip.clone()), flange: None }
    }

    fn torque(&self, robot: &crate::robot::Robot) -> Vec<f64> {
        let mut out = vec![0.0; self.q.len()];
        let ws = &mut Workspace::new(robot);
        inverse_dynamics(robot, ws, &self.q, &self.qd, &self.qdd, &mut out);
        out
    }
}

fn cases() -> Vec<Case> {
    let text = include_str!("../../../../tests/golden/chain.json");
    serde_json::from_str::<File>(text).unwrap().cases
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

#[test]
fn torques_and_tips_of_chains_match_pinocchio() {
    for case in cases() {
        let robot = read(CART, "cart", &case.chain()).unwrap().robot;
        let what = format!("{} to {}", case.base, case.tip);
        assert!(largest_difference(&case.torque(&robot), &case.inverse) < 1e-10, "{what}");
        let tip = flange_placement(&robot, &case.q);
        let rotation: Vec<f64> = tip.rotation.transpose().iter().copied().collect();
        assert!(largest_difference(tip.translation.as_slice(), &case.tip_translation) < 1e-12);
        assert!(largest_difference(&rotation, &case.tip_rotation) < 1e-12, "{what}");
    }
}

/// The base of a written chain stands in its world as it did in the robot.
#[test]
fn a_written_chain_reads_back_with_the_same_torques() {
    for case in cases() {
        let robot = read(CART, "cart", &case.chain()).unwrap().robot;
        let back = read(&write(&robot), "chain", &Chain::default()).unwrap();
        assert!(largest_difference(&case.torque(&robot), &case.torque(&back.robot)) < 1e-12);
        let again = Chain { base: Some("base".into()), tip: Some("tool0".into()), flange: None };
        let again = read(&write(&robot), "chain", &again).unwrap().robot;
        assert!((again.gravity - robot.gravity).amax() < 1e-12, "{}", case.base);
        assert!(largest_difference(&case.torque(&robot), &case.torque(&again)) < 1e-12);
        let (tip, same) = (flange_placement(&robot, &case.q), flange_placement(&again, &case.q));
        assert!((tip.translation - same.translation).amax() < 1e-12);
    }
}
