//! Round trips of every built-in arm and of random ones, and what bad files are told.

use nalgebra::{Matrix3, Rotation3, Vector3};

mod chains;
mod golden;
mod wild;

use super::*;
use crate::robot::tables::Table;
use crate::robot::{BUILT_IN, GRAVITY, Placement, Robot, builtin, flange_placement};

/// The arm of a text that needs no choice.
fn robot_of(text: &str) -> Robot {
    read(text, "test.urdf", &Chain::default()).unwrap().robot
}

fn assert_same(a: &Robot, b: &Robot, tolerance: f64) {
    let near = |x: f64, y: f64| x == y || (x - y).abs() <= tolerance;
    let near_place = |p: &Placement, q: &Placement| {
        (p.rotation - q.rotation).amax() <= tolerance
            && (p.translation - q.translation).amax() <= tolerance
    };
    assert_eq!(a.dof(), b.dof());
    assert!(near_place(&a.flange, &b.flange), "flange");
    for (a, b) in a.bodies.iter().zip(&b.bodies) {
        assert_eq!((&a.name, a.parent, &a.joint.name), (&b.name, b.parent, &b.joint.name));
        assert!(near_place(&a.joint.placement, &b.joint.placement), "{}", a.joint.name);
        assert!((a.joint.axis.into_inner() - b.joint.axis.into_inner()).amax() <= tolerance);
        let (l, m) = (&a.joint.limits, &b.joint.limits);
        assert!(near(l.lower, m.lower) && near(l.upper, m.upper), "{l:?} {m:?}");
        assert!(near(l.velocity, m.velocity) && near(l.effort, m.effort), "{l:?} {m:?}");
        assert!(near(a.inertia.mass, b.inertia.mass), "{}", a.name);
        assert!((a.inertia.com - b.inertia.com).amax() <= tolerance, "{}", a.name);
        assert!((a.inertia.about_com - b.inertia.about_com).amax() <= tolerance, "{}", a.name);
    }
}

#[test]
fn built_in_arms_survive_their_urdf() {
    for table in BUILT_IN {
        let robot = table.robot();
        let back = robot_of(&write(&robot));
        assert_same(&robot, &back, 1e-12);
        assert_eq!(back.name, table.name);
    }
}

#[test]
fn odd_frames_survive_their_urdf_even_at_pitch_of_a_right_angle() {
    let mut robot = builtin("ur5").unwrap();
    let right = std::f64::consts::FRAC_PI_2;
    let angles = [[0.3, right, 1.1], [0.3, -right, 1.1], [3.0, 1.5, -3.0], [-2.0, 0.1, 2.5]];
    for (body, [r, p, y]) in robot.bodies.iter_mut().zip(angles) {
        body.joint.placement.rotation = *Rotation3::from_euler_angles(r, p, y).matrix();
        body.inertia.about_com += Matrix3::new(0.0, 1e-4, 2e-4, 1e-4, 0.0, -1e-4, 2e-4, -1e-4, 0.0);
    }
    robot.flange.rotation = *Rotation3::from_euler_angles(0.1, right - 1e-9, 0.2).matrix();
    assert_same(&robot, &robot_of(&write(&robot)), 1e-12);
}

#[test]
fn committed_files_are_what_the_tables_give() {
    for table in BUILT_IN {
        let path = format!("{}/urdf/{}.urdf", env!("CARGO_MANIFEST_DIR"), table.name);
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            committed == write(&table.robot()),
            "{path} is out of step: armtwin urdf --robot {0} -o urdf/{0}.urdf",
            table.name
        );
    }
}

/// T_1 ... T_6 straight from the definition of the DH parameters.
fn dh_chain(t: &Table, q: &[f64; 6]) -> Placement {
    let turn = |axis, angle| Rotation3::from_axis_angle(&axis, angle).into_inner();
    let move_to =
        |x, z| Placement { translation: Vector3::new(x, 0.0, z), ..Placement::identity() };
    (0..6).fold(Placement::identity(), |base, i| {
        let about_z =
            Placement { rotation: turn(Vector3::z_axis(), q[i]), ..Placement::identity() };
        let about_x =
            Placement { rotation: turn(Vector3::x_axis(), t.alpha[i]), ..Placement::identity() };
        base.compose(&about_z).compose(&move_to(t.a[i], t.d[i])).compose(&about_x)
    })
}

#[test]
fn the_flange_is_where_the_dh_table_puts_it() {
    let q = [0.3, -1.2, 0.8, 2.0, -0.7, 1.9];
    for table in BUILT_IN {
        let (ours, dh) = (flange_placement(&table.robot(), &q), dh_chain(table, &q));
        assert!((ours.translation - dh.translation).amax() < 1e-13, "{}", table.name);
        assert!((ours.rotation - dh.rotation).amax() < 1e-13, "{}", table.name);
    }
}

/// A known posture: UR5 stretched along -x at q = 0, from the DH parameters by hand.
#[test]
fn ur5_at_zero_reaches_where_its_lengths_add_up() {
    let at = flange_placement(&builtin("ur5").unwrap(), &[0.0; 6]).translation;
    let expected = Vector3::new(-0.425 - 0.39225, -0.109915 - 0.0823, 0.089159 - 0.09465);
    assert!((at - expected).amax() < 1e-12, "{at}");
}

#[test]
fn fixed_links_are_merged_and_tool0_is_found() {
    let text = write(&builtin("ur5").unwrap()).replace(
        "  <link name=\"tool0\"/>",
        "  <link name=\"camera\"><inertial><origin xyz=\"0 0 0.1\"/><mass value=\"0.5\"/><inertia \
         ixx=\"1e-3\" ixy=\"0\" ixz=\"0\" iyy=\"1e-3\" iyz=\"0\" izz=\"1e-3\"/></inertial></link>\
         <joint name=\"mount\" type=\"fixed\"><origin xyz=\"0 0.02 0\"/>\
         <parent link=\"wrist_3_link\"/><child link=\"camera\"/></joint>\
         <link name=\"tool0\"/>",
    );
    let robot = robot_of(&text);
    let com = Vector3::new(0.0, 0.02, 0.1);
    let expected = builtin("ur5").unwrap().with_payload(0.5, com, Matrix3::identity() * 1e-3);
    assert_same(&expected, &robot, 1e-12);
    assert_eq!(robot.gravity.z, -GRAVITY);
}

#[test]
fn continuous_joints_turn_without_end() {
    let robot = robot_of(&write(&builtin("ur3").unwrap()));
    assert_eq!(robot.bodies[5].joint.limits.upper, f64::INFINITY);
    assert_eq!(robot.bodies[4].joint.limits.upper, std::f64::consts::TAU);
    let unlimited =
        with_wrist_2_limit("").replace("wrist_2_joint\" type=\"revolute", "x\" type=\"continuous");
    let robot = robot_of(&unlimited);
    assert_eq!(robot.bodies[4].joint.limits.velocity, f64::INFINITY);
    assert_same(&robot, &robot_of(&write(&robot)), 1e-12);
}

/// What URDFs in the wild carry along: a world link, meshes, transmissions, foreign elements,
/// axes of any length, no effort, elements in any order, a moving link called `base`.
const WILD: &str = r#"<robot name="wild &amp; small" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <material name="blue"><color rgba="0 0 1 1"/></material>
  <joint name="lift" type="continuous"><parent link="base"/><child link="arm"/>
    <origin xyz="0 0 .4"/><axis xyz="1 0 0"/></joint>
  <link name="world"/>
  <joint name="stand" type="fixed"><parent link="world"/><child link="foot"/>
    <origin xyz="0 0 1"/></joint>
  <link name="foot"><visual><geometry><mesh filename="package://x/y.dae"/></geometry></visual></link>
  <joint name="pan" type="revolute"><parent link="foot"/><child link="base"/>
    <origin xyz="0 0 .1"/><axis xyz="0 0 2"/><limit lower="-1" upper="1" velocity="2"/>
    <dynamics damping="0.1" friction="0"/><safety_controller k_velocity="1"/></joint>
  <link name="base"><inertial><mass value="1"/><origin xyz="0 0 .2"/>
    <inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial></link>
  <link name="arm"><inertial><mass value="1"/>
    <inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial></link>
  <link name="tip"/>
  <joint name="end" type="fixed"><parent link="arm"/><child link="tip"/>
    <origin xyz="0 0 .5"/></joint>
  <transmission name="t"><type>x</type><joint name="pan"/><actuator name="m"/></transmission>
  <gazebo reference="base"><material>Gazebo/Blue</material></gazebo>
</robot>"#;

#[test]
fn what_urdfs_in_the_wild_carry_along_does_no_harm() {
    let robot = robot_of(WILD);
    assert_eq!(robot.bodies[0].joint.placement.translation.z, 1.1);
    assert_eq!(robot.bodies[0].joint.axis, Vector3::z_axis());
    assert_eq!(robot.bodies[0].joint.limits.effort, f64::INFINITY);
    assert_eq!(robot.flange.translation.z, 0.5);
    assert_same(&robot, &robot_of(&write(&robot)), 1e-12);
}

/// What a bad file is told must name the place and the way out.
fn assert_refused(text: &str, words: &[&str]) {
    let message = read(text, "bad.urdf", &Chain::default()).unwrap_err().to_string();
    for word in words.iter().chain(&["bad.urdf"]) {
        assert!(message.contains(word), "`{word}` is not in: {message}");
    }
    assert_eq!(message.lines().count(), 1, "{message}");
}

fn with(from: &str, to: &str) -> String {
    let text = write(&builtin("ur5").unwrap());
    assert!(text.contains(from), "{from} is not in the UR5's URDF");
    text.replacen(from, to, 1)
}

const WRIST_2_LIMIT: &str = "    <child link=\"wrist_2_link\"/>\n    <axis xyz=\"0 0 1\"/>\n    \
                             <limit lower=\"-6.283185307179586\" upper=\"6.283185307179586\" \
                             velocity=\"3.141592653589793\" effort=\"28\"/>\n";

fn with_wrist_2_limit(limit: &str) -> String {
    let to = format!("<child link=\"wrist_2_link\"/><axis xyz=\"0 0 1\"/>{limit}");
    with(WRIST_2_LIMIT, &to)
}

#[test]
fn bad_structure_is_refused() {
    assert_refused("", &["not a valid URDF"]);
    assert_refused("<robot name=\"x\"><link name=\"a\">", &["not a valid URDF"]);
    assert_refused("<robot name=\"x\"></robot>", &["no links"]);
    assert_refused("<robot name=\"x\"><link name=\"a\"/></robot>", &["no moving joint"]);
    assert_refused(
        &with("<mass value=\"2.33\"/>", ""),
        &["link `forearm_link`", "no <mass", "add it"],
    );
    assert_refused(
        &with("type=\"revolute\"", "type=\"hinge\""),
        &["joint `shoulder_pan_joint`", "is hinge", "revolute", "--base shoulder_link"],
    );
    let loop_back = "<joint name=\"back\" type=\"fixed\"><parent link=\"tool0\"/>\
                     <child link=\"NAME\"/></joint></robot>";
    let closed = |link| with("</robot>", &loop_back.replace("NAME", link));
    assert_refused(
        &closed("forearm_link"),
        &["link `forearm_link`", "elbow_joint", "back", "loop"],
    );
    assert_refused(&closed("base"), &["loop", "remove one joint"]);
    assert_refused(
        &with("</robot>", "<link name=\"table\"/></robot>"),
        &["several root links", "base, table"],
    );
    assert_refused(
        &with("<parent link=\"forearm_link\"/>", "<parent link=\"arm\"/>"),
        &["joint `wrist_1_joint`", "parent link `arm` does not exist"],
    );
    assert_refused(
        &with("<link name=\"wrist_1_link\">", "<link name=\"wrist_2_link\">"),
        &["link `wrist_2_link`", "twice"],
    );
}

#[test]
fn joints_that_are_no_arm_are_refused() {
    assert_refused(
        &with("name=\"elbow_joint\" type=\"revolute\"", "name=\"elbow_joint\" type=\"prismatic\""),
        &["joint `elbow_joint`", "prismatic", "--tip upper_arm_link", "--base forearm_link"],
    );
    assert_refused(
        &with_wrist_2_limit("<limit lower=\"2\" upper=\"-2\" velocity=\"1\" effort=\"1\"/>"),
        &["joint `wrist_2_joint`", "lower limit 2", "upper limit -2"],
    );
    assert_refused(
        &with_wrist_2_limit("<limit lower=\"-2\" upper=\"2\" velocity=\"fast\"/>"),
        &["joint `wrist_2_joint`", "velocity=\"fast\"", "give a number"],
    );
    assert_refused(
        &with("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>"),
        &["joint `shoulder_pan_joint`", "axis is zero"],
    );
}

#[test]
fn impossible_inertias_are_refused() {
    let mass = |m: &str| with("<mass value=\"2.33\"/>", &format!("<mass value=\"{m}\"/>"));
    assert_refused(&mass("0"), &["link `forearm_link`", "elbow_joint", "no mass"]);
    assert_refused(&mass("-2.33"), &["link `forearm_link`", "-2.33 kg", "positive"]);
    assert_refused(&mass("nan"), &["link `forearm_link`", "value=\"nan\"", "finite number"]);
    assert_refused(
        &with("ixx=\"0.0017\" ixy=\"0\"", "ixx=\"0.0017\" ixy=\"0.3\""),
        &["link `forearm_link`", "not positive definite", "eigenvalues"],
    );
}
