//! Which part of a robot is taken for the arm, what it carries, and what is said of that.

use nalgebra::{Matrix3, Vector3};

use super::super::{Chain, Loaded, read, write};
use crate::robot::{GRAVITY, builtin, flange_placement};

fn chain(base: &str, tip: &str) -> Chain {
    let link = |name: &str| (!name.is_empty()).then(|| name.to_string());
    Chain { base: link(base), tip: link(tip), flange: None }
}

fn loaded(text: &str, base: &str, tip: &str) -> Loaded {
    read(text, "test.urdf", &chain(base, tip)).unwrap()
}

fn refusal(text: &str, base: &str, tip: &str) -> String {
    let message = read(text, "test.urdf", &chain(base, tip)).unwrap_err().to_string();
    assert!(message.starts_with("test.urdf: ") && message.lines().count() == 1, "{message}");
    message
}

fn assert_says(words: &[&str], text: &str) {
    for word in words {
        assert!(text.contains(word), "`{word}` is not in: {text}");
    }
}

/// The one note that begins so holds all the words.
fn assert_notes(loaded: &Loaded, begins: &str, words: &[&str]) {
    let found: Vec<_> = loaded.notes.iter().filter(|n| n.starts_with(begins)).collect();
    assert_eq!(found.len(), 1, "{begins} in {:#?}", loaded.notes);
    assert_says(words, found[0]);
}

fn joints(loaded: &Loaded) -> Vec<&str> {
    loaded.robot.bodies.iter().map(|b| b.joint.name.as_str()).collect()
}

/// A link of `mass`, a ball of radius 0.1 m.
fn link(name: &str, mass: f64) -> String {
    let i = 0.4 * mass * 0.01;
    format!(
        "<link name=\"{name}\"><inertial><mass value=\"{mass}\"/><inertia ixx=\"{i}\" ixy=\"0\" \
         ixz=\"0\" iyy=\"{i}\" iyz=\"0\" izz=\"{i}\"/></inertial></link>"
    )
}

/// A joint one metre along x, which turns about z.
fn joint(name: &str, kind: &str, parent: &str, child: &str, inside: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><origin xyz=\"1 0 0\"/><parent link=\"{parent}\"/>\
         <child link=\"{child}\"/><axis xyz=\"0 0 1\"/>\
         <limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"1\"/>{inside}</joint>"
    )
}

/// Links `NAME1` to `NAMEn` of 1 kg in a row below `parent`, moved by the joints `NAME1j` and so on.
fn row(name: &str, count: usize, parent: &str) -> String {
    let mut text = String::new();
    let mut parent = parent.to_string();
    for i in 1..=count {
        let child = format!("{name}{i}");
        text += &link(&child, 1.0);
        text += &joint(&format!("{child}j"), "revolute", &parent, &child, "");
        parent = child;
    }
    text
}

fn robot(parts: &[String]) -> String {
    format!("<robot name=\"r\"><link name=\"root\"/>{}</robot>", parts.concat())
}

/// An arm of four joints with a hand of 0.5 kg, a finger of 0.1 kg and one of 0.2 kg that follows.
fn arm_with_gripper(kind: &str) -> String {
    robot(&[
        row("arm", 4, "root"),
        link("hand", 0.5),
        joint("hand_joint", "fixed", "arm4", "hand", ""),
        link("finger", 0.1),
        joint("grip", kind, "hand", "finger", ""),
        link("thumb", 0.2),
        joint("follow", kind, "hand", "thumb", "<mimic joint=\"grip\"/>"),
    ])
}

#[test]
fn an_arm_with_a_gripper_needs_no_flags() {
    for kind in ["prismatic", "revolute"] {
        let found = loaded(&arm_with_gripper(kind), "", "");
        assert_eq!(joints(&found), ["arm1j", "arm2j", "arm3j", "arm4j"], "{kind}");
        assert_eq!((found.base.as_str(), found.tip.as_str()), ("root", "hand"));
        let last = &found.robot.bodies[3].inertia;
        assert!((last.mass - 1.8).abs() < 1e-12, "{kind}");
        // Masses at 0, 1 and twice 2 m along x: hand at 1, fingers at 2.
        assert!((last.com - Vector3::x() * (0.5 + 0.6) / 1.8).amax() < 1e-12, "{}", last.com);
        let held = format!("`grip` ({kind}), `follow` (mimic)");
        let carried = ["`hand`, `finger`, `thumb` (0.800 kg)", "held at zero", &held];
        assert_notes(&found, "link `arm4`: carries", &carried);
        assert_notes(&found, "the arm is taken to be the longest chain, 4 joints", &["--tip"]);
    }
}

#[test]
fn fingers_of_like_length_are_no_arms() {
    let hand = [row("arm", 4, "root"), row("f", 2, "arm4"), row("g", 3, "arm4")];
    let found = loaded(&robot(&hand), "", "");
    assert_eq!((found.robot.dof(), found.tip.as_str()), (4, "arm4"));
    assert_notes(&found, "link `arm4`: carries", &["`f1`", "`g3`", "(5.000 kg)"]);
    // Asked for, a finger is part of the chain.
    let finger = loaded(&robot(&hand), "", "f2");
    assert_eq!((finger.robot.dof(), finger.tip.as_str()), (6, "f2"));
    assert_notes(&finger, "link `arm4`: carries", &["`g1`, `g2`, `g3` (3.000 kg)"]);
}

#[test]
fn a_camera_on_the_way_does_not_end_the_arm() {
    let found = loaded(&robot(&[row("arm", 3, "root"), row("cam", 1, "arm1")]), "", "");
    assert_eq!(joints(&found), ["arm1j", "arm2j", "arm3j"]);
    assert_notes(&found, "link `arm1`: carries", &["`cam1` (1.000 kg)", "`cam1j` (revolute)"]);
}

#[test]
fn of_two_arms_one_has_to_be_chosen() {
    let both = robot(&[row("l", 3, "root"), row("r", 3, "root"), row("head", 1, "root")]);
    let message = refusal(&both, "", "");
    assert_says(&["several chains of 3 joints", "`l3`, `r3`", "--tip LINK"], &message);
    let right = loaded(&both, "", "r3");
    assert_eq!(joints(&right), ["r1j", "r2j", "r3j"]);
    let left_out = ["`l1j` (revolute)", "`head1j`", "base, which stands still"];
    assert_notes(&right, "left out is what hangs on the base", &left_out);
    assert!((right.robot.mass() - 3.0).abs() < 1e-12);
}

#[test]
fn what_lies_beyond_the_tip_is_carried() {
    let found = loaded(&robot(&[row("arm", 4, "root")]), "", "arm2");
    assert_eq!((joints(&found), found.tip.as_str()), (vec!["arm1j", "arm2j"], "arm2"));
    assert!((found.robot.bodies[1].inertia.mass - 3.0).abs() < 1e-12);
    assert_notes(&found, "link `arm2`: carries", &["`arm3`, `arm4` (2.000 kg)"]);
}

/// A gripper's jaw moves beyond the flange: what is bolted there does not move with it.
#[test]
fn loads_are_bolted_to_the_link_that_is_said_to_be_the_flange() {
    let hand = "<link name=\"hand\"/><joint name=\"bolts\" type=\"fixed\"><origin xyz=\"0 0 0.1\"/>\
                <parent link=\"arm2\"/><child link=\"hand\"/></joint>";
    let text = robot(&[row("arm", 3, "root"), hand.into()]);
    let with = |flange: &str| Chain { flange: Some(flange.into()), ..chain("", "arm3") };
    let found = read(&text, "test.urdf", &with("hand")).unwrap().robot;
    assert_eq!((found.dof(), found.carrier()), (3, Some(1)));
    let laden = found.with_payload(2.0, Vector3::zeros(), Matrix3::zeros());
    let masses: Vec<f64> = laden.bodies.iter().map(|b| b.inertia.mass).collect();
    assert_eq!(masses, [1.0, 3.0, 1.0]);
    let height = |q: &[f64]| flange_placement(&found, q).translation;
    assert_eq!(height(&[0.3, -0.2, 0.0]), height(&[0.3, -0.2, 1.0]));
    let written = Chain { flange: Some("tool0".into()), ..Chain::default() };
    let again = read(&write(&found), "again.urdf", &written).unwrap().robot;
    assert_eq!((again.carrier(), again.flange), (Some(1), found.flange));
    // The last link as ever, said or not.
    let last = read(&text, "test.urdf", &with("arm3")).unwrap();
    assert_eq!(last, loaded(&text, "", "arm3"));
    let refused = |flange: &str| read(&text, "test.urdf", &with(flange)).unwrap_err().to_string();
    assert_says(&["link `root`", "is no flange", "leave `flange` out"], &refused("root"));
    assert_says(&["no link `wrist`", "flange"], &refused("wrist"));
}

#[test]
fn a_base_below_the_root_leaves_out_what_is_above() {
    let lift = "<joint name=\"lift\" type=\"prismatic\"><origin xyz=\"0 0 1\" rpy=\"0.5 0 0\"/>\
                <parent link=\"root\"/><child link=\"torso\"/><axis xyz=\"0 0 1\"/>\
                <limit lower=\"0.2\" upper=\"1\" velocity=\"1\" effort=\"1\"/></joint>";
    let text = robot(&[link("torso", 9.0), lift.into(), row("arm", 2, "torso")]);
    let message = refusal(&text, "", "");
    assert_says(&["joint `lift`", "prismatic", "on the chain", "(--base torso)"], &message);
    assert!(!message.contains("--tip"), "no joint turns before it: {message}");
    let found = loaded(&text, "torso", "");
    assert_eq!((joints(&found), found.base.as_str()), (vec!["arm1j", "arm2j"], "torso"));
    // Turned by 0.5 rad about x: -z of the root is seen from there by Rot_x(-0.5).
    let seen = Vector3::new(0.0, -(0.5_f64.sin()), -(0.5_f64.cos())) * GRAVITY;
    assert!((found.robot.gravity - seen).amax() < 1e-12, "{}", found.robot.gravity);
    assert_notes(&found, "`torso` is the base", &["`lift` at zero", "up to `root`", "left out"]);
    assert_notes(&found, "gravity is along -z of `root`", &["(0.0000, -4.7032, -8.6091) m/s2"]);
}

#[test]
fn a_base_that_stands_level_says_nothing_of_gravity() {
    let found = loaded(&robot(&[row("arm", 3, "root")]), "arm1", "arm3");
    assert_eq!(found.robot.gravity, Vector3::new(0.0, 0.0, -GRAVITY));
    assert!(!found.notes.iter().any(|n| n.contains("gravity")), "{:#?}", found.notes);
}

/// An arm that hangs from the ceiling is written so that its gravity comes back.
#[test]
fn a_base_upside_down_survives_its_urdf() {
    let ceiling = "<joint name=\"hang\" type=\"fixed\"><origin rpy=\"3.141592653589793 0 0\"/>\
                   <parent link=\"root\"/><child link=\"plate\"/></joint><link name=\"plate\"/>";
    let found = loaded(&robot(&[ceiling.into(), row("arm", 2, "plate")]), "plate", "");
    assert!((found.robot.gravity - Vector3::z() * GRAVITY).amax() < 1e-12);
    let back = loaded(&write(&found.robot), "base", "");
    assert!((back.robot.gravity - found.robot.gravity).amax() < 1e-12, "{}", back.robot.gravity);
}

#[test]
fn chains_that_are_none_are_refused() {
    let text = arm_with_gripper("prismatic");
    let finger = refusal(&text, "", "finger");
    assert_says(&["joint `grip`", "prismatic", "(--tip hand)"], &finger);
    let thumb = refusal(&arm_with_gripper("revolute"), "", "thumb");
    assert_says(&["joint `follow`", "mimics `grip`", "(--tip hand)"], &thumb);
    assert_says(&["no link `ARM`", "tip", "`arm1`, `arm2`"], &refusal(&text, "", "ARM"));
    assert_says(&["no link `pedestal`", "base", "`root`"], &refusal(&text, "pedestal", ""));
    assert_says(&["link `arm2`", "does not hang on", "`arm4`"], &refusal(&text, "arm4", "arm2"));
    assert_says(&["no moving joint", "`arm4`", "`hand`"], &refusal(&text, "arm4", "hand"));
    assert_says(&["no moving joint"], &refusal(&text, "arm4", "arm4"));
}

#[test]
fn with_several_roots_a_base_or_tip_says_which_counts() {
    let text = robot(&[row("arm", 2, "root"), link("table", 5.0)]);
    assert_says(&["several root links (root, table)", "--base"], &refusal(&text, "", ""));
    assert_eq!(loaded(&text, "root", "").robot.dof(), 2);
    assert_eq!(loaded(&text, "", "arm2").robot.dof(), 2);
}

#[test]
fn joints_that_only_a_whole_robot_has_do_no_harm_off_the_chain() {
    for kind in ["floating", "planar", "spherical"] {
        let extra = [link("toy", 0.25), joint("odd", kind, "arm2", "toy", "")];
        let found = loaded(&robot(&[row("arm", 2, "root"), extra.concat()]), "", "");
        assert_eq!(found.robot.dof(), 2, "{kind}");
        let held = format!("`odd` ({kind})");
        assert_notes(&found, "link `arm2`: carries", &["`toy` (0.250 kg)", &held]);
    }
}

#[test]
fn a_part_of_a_built_in_arm_is_an_arm() {
    let chain = chain("shoulder_link", "wrist_1_link");
    let part = crate::robot::load("ur5", &chain).unwrap();
    assert_eq!(part.robot.dof(), 3);
    let whole = builtin("ur5").unwrap();
    let beyond: f64 = whole.bodies[3..].iter().map(|b| b.inertia.mass).sum();
    assert!((part.robot.bodies[2].inertia.mass - beyond).abs() < 1e-12);
}
