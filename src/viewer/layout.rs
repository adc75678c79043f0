//! How the views of a comparison are arranged.

use super::blueprint::{Node, arms, columns, grid, rows, stack, tabs, text, time_series};
use super::plots::{self, Quantity};
use super::{Comparison, arm};

/// Entity path of the text panel.
pub const SUMMARY: &str = "summary";

pub fn root(c: &Comparison) -> Node {
    let frame = arm::frame(&c.robot, &c.recorded.q);
    let view_3d = arms("Recorded (solid) and simulated (translucent)", &frame);
    let left = rows("Arm", vec![view_3d, text("Summary", SUMMARY)], vec![3.0, 2.0]);
    let mut signals = vec![over_joints("Torques", c, &plots::TORQUE)];
    signals.push(over_joints("Residuals", c, &plots::RESIDUAL));
    signals.push(over_joints("Angles", c, &plots::ANGLE));
    signals.push(over_joints("Tracking", c, &plots::TRACKING));
    signals.extend((0..c.robot.dof()).map(|j| joint_tab(c, j)));
    columns("Comparison", vec![left, tabs("Signals", signals)], vec![2.0, 3.0])
}

/// One quantity of all joints.
fn over_joints(name: &str, c: &Comparison, quantity: &'static Quantity) -> Node {
    grid(name, (0..c.robot.dof()).map(|j| plot(c, j, quantity)).collect())
}

/// All quantities of one joint.
fn joint_tab(c: &Comparison, joint: usize) -> Node {
    let views = plots::QUANTITIES.iter().map(|quantity| plot(c, joint, quantity)).collect();
    stack(&format!("Joint {}", joint + 1), views)
}

fn plot(c: &Comparison, joint: usize, quantity: &Quantity) -> Node {
    let name = format!("{} {}: {}", joint + 1, joint_name(&c.robot, joint), quantity.label);
    time_series(name, plots::entity(joint, quantity), quantity.legend)
}

/// As its URDF has it, without what says that it is one.
pub fn joint_name(robot: &crate::robot::Robot, joint: usize) -> &str {
    robot.bodies[joint].joint.name.trim_end_matches("_joint")
}
