//! Defects of URDFs as they are found: each is read with a note, or refused with one message.

use nalgebra::Matrix3;

use super::super::{Chain, Loaded, read, read_file, write};

/// An arm of two joints; `LIMIT`, `ORIGIN` and the like are filled in by [`arm`].
const ARM: &str = r#"<robot name="wild">
  <link name="base"/>
  <joint name="pan" type="revolute">ORIGIN<parent link="base"/><child link="upper"/>AXIS LIMIT</joint>
  <link name="upper">INERTIAL</link>
  <joint name="lift" type="revolute"><origin xyz="0 0 0.3"/><parent link="upper"/>
    <child link="lower"/><axis xyz="1 0 0"/>LIMIT</joint>
  <link name="lower">INERTIAL</link>
</robot>"#;

const ORIGIN: &str = r#"<origin xyz="0 0 0.1"/>"#;
const AXIS: &str = r#"<axis xyz="0 0 1"/>"#;
const LIMIT: &str = r#"<limit lower="-1" upper="1" velocity="2" effort="30"/>"#;
const INERTIAL: &str = r#"<inertial><origin xyz="0 0 0.1"/><mass value="2"/>
  <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/></inertial>"#;

/// URDF of the usual arm with `instead` in place of its `what`.
fn arm(what: &str, instead: &str) -> String {
    let usual = [("ORIGIN", ORIGIN), ("AXIS", AXIS), ("LIMIT", LIMIT), ("INERTIAL", INERTIAL)];
    assert!(usual.iter().any(|(name, _)| *name == what), "{what}");
    usual.iter().fold(ARM.to_string(), |text, (name, usual)| {
        text.replace(name, if *name == what { instead } else { usual })
    })
}

fn sound() -> String {
    arm("ORIGIN", ORIGIN)
}

fn loaded(text: &str) -> Loaded {
    read(text, "wild.urdf", &Chain::default()).unwrap()
}

fn refusal(text: &str) -> String {
    let message = read(text, "wild.urdf", &Chain::default()).unwrap_err().to_string();
    assert!(message.contains("wild.urdf") && message.lines().count() == 1, "{message}");
    message
}

fn assert_says(words: &[&str], text: &str) {
    for word in words {
        assert!(text.contains(word), "`{word}` is not in: {text}");
    }
}

/// Read as `same` is, with one note that holds all the words.
fn assert_like(text: &str, same: &str, words: &[&str]) -> Loaded {
    let (ours, same) = (loaded(text), loaded(same));
    assert_eq!(ours.robot, same.robot);
    assert_one_note(&ours, words);
    ours
}

fn assert_one_note(loaded: &Loaded, words: &[&str]) {
    assert_eq!(loaded.notes.len(), 1, "{:#?}", loaded.notes);
    assert_says(words, &loaded.notes[0]);
}

#[test]
fn a_sound_file_needs_no_note() {
    assert_eq!(loaded(&sound()).notes, [""; 0]);
}

#[test]
fn of_duplicates_the_first_is_taken() {
    let twice = |tag: &str, first: &str, second: &str| arm(tag, &format!("{first}{second}"));
    let origin = twice("ORIGIN", ORIGIN, r#"<origin xyz="5 5 5" rpy="1 1 1"/>"#);
    assert_like(&origin, &sound(), &["joint `pan`: 2 <origin>; the first is taken"]);
    let axis = twice("AXIS", AXIS, r#"<axis xyz="0 1 0"/>"#);
    assert_like(&axis, &sound(), &["joint `pan`: 2 <axis>"]);
    let limit = twice("LIMIT", LIMIT, r#"<limit velocity="9"/><limit velocity="8"/>"#);
    assert_like(&limit, &sound(), &["joints `pan`, `lift`: 3 <limit>"]);
    let heavy = INERTIAL.replace("value=\"2\"", "value=\"7\"");
    let inertial = twice("INERTIAL", INERTIAL, &heavy);
    assert_like(&inertial, &sound(), &["links `upper`, `lower`: 2 <inertial>"]);
    let inside = INERTIAL.replace("<mass", "<origin xyz=\"9 9 9\"/><mass");
    assert_like(&arm("INERTIAL", &inside), &sound(), &["links `upper`, `lower`: 2 <origin>"]);
}

/// As in Drake; with another parent that is not defined, it is a mistake.
#[test]
fn the_world_need_not_be_defined() {
    let joint = r#"<joint name="weld" type="fixed"><parent link="world"/><child link="base"/>
                   <origin rpy="1.5707963267948966 0 0"/></joint></robot>"#;
    let hung = loaded(&sound().replace("</robot>", joint));
    assert_eq!(hung.base, "world");
    assert_eq!(hung.robot.bodies.len(), loaded(&sound()).robot.bodies.len());
    let [moved, own] = [&hung, &loaded(&sound())].map(|l| l.robot.bodies[0].joint.placement);
    assert!((moved.rotation - own.rotation).norm() > 1.0, "the base is turned against the world");
    let other = sound().replace("</robot>", &joint.replace("world", "wold"));
    assert!(refusal(&other).contains("`wold` does not exist"));
}

#[test]
fn missing_limits_are_none() {
    let free = loaded(&arm("LIMIT", ""));
    assert_one_note(&free, &["joints `pan`, `lift`: no <limit>; taken as free to turn"]);
    for body in &free.robot.bodies {
        let l = body.joint.limits;
        assert_eq!((l.lower, l.upper), (f64::NEG_INFINITY, f64::INFINITY));
        assert_eq!((l.velocity, l.effort), (f64::INFINITY, f64::INFINITY));
    }
    let range = loaded(&arm("LIMIT", r#"<limit velocity="2" effort="30"/>"#));
    assert_one_note(&range, &["lower and upper limit are 0 or left out", "free to turn"]);
    assert_eq!(range.robot.bodies[1].joint.limits.upper, f64::INFINITY);
    assert_eq!(range.robot.bodies[1].joint.limits.velocity, 2.0);
}

#[test]
fn rates_that_are_not_positive_are_unlimited() {
    let limits = |text: &str| {
        let found = loaded(&arm("LIMIT", &format!(r#"<limit lower="-1" upper="1" {text}/>"#)));
        (found.robot.bodies[0].joint.limits, found.notes.join("\n"))
    };
    let (both, notes) = limits(r#"velocity="0" effort="0""#);
    assert_eq!((both.velocity, both.effort, both.upper), (f64::INFINITY, f64::INFINITY, 1.0));
    assert_says(&["velocity limit of 0 rad/s; taken", "effort limit of 0 N.m; taken"], &notes);
    let (negative, notes) = limits(r#"velocity="-1" effort="5""#);
    assert_eq!((negative.velocity, negative.effort), (f64::INFINITY, 5.0));
    assert_says(&["`pan`, `lift`: velocity limit of -1 rad/s; taken as unlimited"], &notes);
    let (absent, notes) = limits(r#"effort="5""#);
    assert_eq!(absent.velocity, f64::INFINITY);
    assert_says(&["no velocity limit; taken as unlimited"], &notes);
}

/// A range survives where velocity and effort are unlimited.
#[test]
fn a_range_without_rates_survives_its_urdf() {
    let found = loaded(&arm("LIMIT", r#"<limit lower="-1" upper="1"/>"#));
    let back = loaded(&write(&found.robot));
    assert_eq!(found.robot.bodies[1].joint.limits, back.robot.bodies[1].joint.limits);
}

#[test]
fn a_missing_axis_is_x() {
    let text = sound().replace(r#"<axis xyz="1 0 0"/>"#, "");
    assert_like(&text, &sound(), &["joint `lift`: no <axis>; x is taken"]);
}

#[test]
fn the_form_of_a_file_does_not_matter() {
    let plain = loaded(&sound());
    let forms = [
        sound().replace('\n', "\r\n"),
        format!("\u{feff}<?xml version=\"1.0\"?>\n{}", sound()),
        format!("\n<!-- made by -- who knows -->\n<?xml version=\"1.0\"?>\n{}", sound()),
        sound().replace("<link name=\"base\"/>", "<!-- <link name=\"base\"/> --- --><link name='base'/>"),
        sound().replace("</robot>", "<gazebo><sensor:camera a:b=\"c\"/></gazebo></robot>"),
        sound().replace("name=\"wild\"", "name=\"wild\" xmlns:x=\"http://x\" xmlns=\"http://y\""),
        sound().replace("</robot>", "<transmission name=\"t\"><joint name=\"pan\"/></transmission></robot>"),
        sound().replace(
            "</robot>",
            "<link name=\"flag\"><visual><origin xyz=\"a b\"/><geometry><mesh \
             filename=\"package://x/y.dae\"/></geometry></visual><visual/></link><joint \
             name=\"pole\" type=\"fixed\"><parent link=\"base\"/><child link=\"flag\"/></joint></robot>",
        ),
    ];
    for text in forms {
        let found = loaded(&text);
        assert_eq!((&found.robot, &found.notes), (&plain.robot, &plain.notes), "{text}");
    }
}

#[test]
fn latin_1_is_read_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("old.urdf");
    let mut bytes = sound().into_bytes();
    bytes.extend(b"<!-- 90\xb0 -->");
    std::fs::write(&file, bytes).unwrap();
    let found = read_file(&file, &Chain::default()).unwrap();
    assert_eq!(found.robot, loaded(&sound()).robot);
}

#[test]
fn numbers_with_commas_and_quaternions_are_read() {
    let commas = arm("ORIGIN", r#"<origin xyz="0, 0,0.1"/>"#);
    assert_like(&commas, &sound(), &["joint `pan`: commas in xyz of <origin>"]);
    let half = std::f64::consts::FRAC_PI_4;
    let (s, c) = half.sin_cos();
    let quaternion = arm("ORIGIN", &format!(r#"<origin xyz="0 0 0.1" quat_xyzw="{s} 0 0 {c}"/>"#));
    let angles = arm("ORIGIN", r#"<origin xyz="0 0 0.1" rpy="1.5707963267948966 0 0"/>"#);
    let [a, b] = [quaternion, angles].map(|t| loaded(&t).robot.bodies[0].joint.placement.rotation);
    assert!((a - b).amax() < 1e-12, "{a} {b}");
}

#[test]
fn a_link_without_mass_has_that_of_what_is_fixed_to_it() {
    let shell = "<link name=\"shell\">INERTIAL</link><joint name=\"screws\" type=\"fixed\">\
                 <parent link=\"lower\"/><child link=\"shell\"/></joint></robot>";
    let shell = shell.replace("INERTIAL", INERTIAL);
    let text = sound().replace("</robot>", &shell);
    let bare =
        text.replacen(&format!("<link name=\"lower\">{INERTIAL}"), "<link name=\"lower\">", 1);
    let found = loaded(&bare);
    assert_eq!(found.robot.bodies[1].inertia.mass, 2.0);
    assert_says(&["link `lower`: no mass of its own"], &found.notes.join("\n"));
    let without = sound().replacen(&format!("lower\">{INERTIAL}"), "lower\">", 1);
    let words = ["link `lower`", "joint `lift`", "no mass", "(--tip upper)"];
    assert_says(&words, &refusal(&without));
    let kinematic = arm("INERTIAL", "");
    assert_says(&["no <inertial> in any link", "masses"], &refusal(&kinematic));
}

fn with_tensor(xx: f64, yy: f64, zz: f64) -> String {
    let tensor =
        format!("<inertia ixx=\"{xx}\" ixy=\"0\" ixz=\"0\" iyy=\"{yy}\" iyz=\"0\" izz=\"{zz}\"/>");
    arm("INERTIAL", &format!("<inertial><mass value=\"2\"/>{tensor}</inertial>"))
}

/// 2/5 m r^2 of 2 kg of aluminium, 2700 kg/m^3: r = 0.0561297 m.
const BALL: f64 = 2.520434e-3;

#[test]
fn a_tensor_of_zeros_becomes_that_of_a_ball() {
    let text = with_tensor(0.0, 0.0, 0.0);
    let found = loaded(&text);
    assert_one_note(
        &found,
        &["links `upper`, `lower`: inertia tensor is zero", "2.520e-3", "ball"],
    );
    let tensor = found.robot.bodies[0].inertia.about_com;
    assert!((tensor - Matrix3::identity() * BALL).amax() < 1e-8, "{tensor}");
    let none = arm("INERTIAL", "<inertial><mass value=\"2\"/></inertial>");
    assert_eq!(loaded(&none).robot, found.robot);
    assert_says(&["a mass but no <inertia>; taken as a point mass"], &loaded(&none).notes[0]);
}

/// A rod has no inertia about itself; as thick as a ball is too thick where all of it is less.
#[test]
fn principal_moments_that_are_zero_become_positive() {
    let rod = loaded(&with_tensor(0.0, 0.05, 0.05));
    assert_one_note(&rod, &["principal moments of zero", "2.520e-3"]);
    let expected = Matrix3::from_diagonal(&[BALL, 0.05, 0.05].into());
    assert!((rod.robot.bodies[0].inertia.about_com - expected).amax() < 1e-8);
    let thin = loaded(&with_tensor(0.0, 1e-6, 1e-6));
    let expected = Matrix3::identity() * 1e-6;
    assert!((thin.robot.bodies[0].inertia.about_com - expected).amax() < 1e-15);
}

#[test]
fn tensors_that_are_slightly_off_are_read_and_others_refused() {
    let slightly = loaded(&with_tensor(-0.001, 0.05, 0.05));
    assert_says(&["not quite positive definite", "-1.000e-3", "taken as 0"], &slightly.notes[0]);
    assert!(slightly.robot.bodies[0].inertia.about_com.cholesky().is_some());
    let unequal = loaded(&with_tensor(0.01, 0.01, 0.05));
    assert_one_note(&unequal, &["triangle inequality", "5.000e-2", "taken as written"]);
    assert_eq!(unequal.robot.bodies[0].inertia.about_com.m33, 0.05);
    let rounded = loaded(&with_tensor(0.01, 0.04, 0.0503));
    assert_eq!(rounded.notes, [""; 0], "within what two digits hold");
    let wrong = refusal(&with_tensor(-0.01, 0.05, 0.05));
    assert_says(
        &["link `upper`", "not positive definite", "-1.000e-2", "correct <inertia>"],
        &wrong,
    );
}

/// What is published and not possible is read (a rod of which one moment is given, one moment a decimal
/// point off); what is no slip any more is not.
#[test]
fn absurd_links_are_refused() {
    let toy = loaded(&with_tensor(0.0, 0.0, 1.0));
    assert_says(&["breaks the triangle inequality", "taken as written"], &toy.notes.join("\n"));
    let point = loaded(&with_tensor(0.01, 0.01, 0.2));
    assert_one_note(&point, &["breaks the triangle inequality", "taken as written"]);
    let absurd = refusal(&with_tensor(0.01, 0.01, 1.28));
    assert_says(&["link `upper`", "triangle inequality 64-fold", "correct <inertia>"], &absurd);
    assert_says(&["that of no machine"], &refusal(&with_tensor(1e9, 1e9, 1e9)));
    let heavy = |kg: &str| refusal(&sound().replace("value=\"2\"", &format!("value=\"{kg}\"")));
    for kg in ["1e300", "1e9", "inf", "nan", "-2"] {
        assert_says(&["link `upper`", "mass"], &heavy(kg));
    }
    assert_says(&["no link weighs more than 1e6 kg"], &heavy("1e9"));
    let far = refusal(&arm("ORIGIN", "<origin xyz=\"1e9 0 0\"/>"));
    assert_says(&["joint `pan`", "1.0e9 m away"], &far);
    let millimetres = loaded(&with_tensor(2e4, 2e4, 1e4));
    assert_one_note(&millimetres, &["masses 112 m away", "are its units kg.m2"]);
}

/// Links of 2 kg with hardly any inertia, and dummies of nothing at all.
#[test]
fn published_placeholders_are_read() {
    let dummy = "<link name=\"tcp\"><inertial><mass value=\"0\"/><inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" \
                 iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link><joint name=\"clip\" type=\"fixed\">\
                 <parent link=\"lower\"/><child link=\"tcp\"/></joint></robot>";
    let text = sound().replace("</robot>", dummy);
    assert_eq!(loaded(&text).robot.bodies[1].inertia.mass, 2.0);
    assert_eq!(loaded(&with_tensor(1e-6, 1e-6, 1e-6)).notes, [""; 0]);
    assert_eq!(loaded(&with_tensor(0.01, 0.01, 0.01)).notes, [""; 0]);
}

/// `count` links in a row.
fn chained(count: usize) -> String {
    let mut text = String::from("<robot name=\"long\"><link name=\"l0\"/>");
    for k in 0..count {
        text += &format!(
            "<joint name=\"j{k}\" type=\"revolute\"><parent link=\"l{k}\"/><child link=\"l{0}\"/>{AXIS}\
             {LIMIT}</joint><link name=\"l{0}\">{INERTIAL}</link>",
            k + 1
        );
    }
    text + "</robot>"
}

#[test]
fn files_without_end_are_refused() {
    assert_eq!(loaded(&chained(64)).robot.dof(), 64);
    assert_says(&["more than 64 moving joints", "--tip"], &refusal(&chained(65)));
    assert_says(&["more than 2 000 links and joints"], &refusal(&chained(10_000)));
    let nested =
        format!("<robot name=\"x\">{}{}</robot>", "<a>".repeat(20_000), "</a>".repeat(20_000));
    assert_says(&["more than 64 levels of nesting"], &refusal(&nested));
    let laughs = "<!DOCTYPE r [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;\">]><robot name=\"&b;\"/>";
    assert_says(&["defines entities", "xmllint"], &refusal(laughs));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("long.urdf");
    std::fs::write(&file, vec![b' '; (4 << 20) + 1]).unwrap();
    let message = read_file(&file, &Chain::default()).unwrap_err().to_string();
    assert_says(&["long.urdf", "more than 4 194 304 bytes in a URDF"], &message);
}

#[test]
fn a_wrong_tensor_of_what_is_only_carried_is_left_out() {
    let antenna = "<link name=\"antenna\"><inertial><mass value=\"0.5\"/><inertia ixx=\"-1\" \
                   ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link><joint \
                   name=\"clip\" type=\"fixed\"><parent link=\"lower\"/><child link=\"antenna\"/>\
                   </joint></robot>";
    let found = loaded(&sound().replace("</robot>", antenna));
    assert_eq!(found.robot.bodies[1].inertia.mass, 2.5);
    let notes = found.notes.join("\n");
    assert_says(
        &["link `antenna`: inertia tensor is not positive", "taken as a point mass"],
        &notes,
    );
    assert_says(&["link `lower`: carries `antenna` (0.500 kg)"], &notes);
}

#[test]
fn templates_and_other_formats_are_told_apart() {
    let head = "<robot name=\"x\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">";
    let template = format!("{head}\n<xacro:property name=\"a\" value=\"1\"/></robot>");
    let words = ["<xacro:property> in line 2", "run xacro first", "xacro wild.urdf > arm.urdf"];
    assert_says(&words, &refusal(&template));
    let undeclared = "<robot name=\"x\"><xacro:include filename=\"a\"/></robot>";
    assert_says(&["<xacro:include> in line 1", "run xacro"], &refusal(undeclared));
    let macros = arm("ORIGIN", "<origin xyz=\"0 0 ${height}\"/>");
    assert_says(&["joint `pan`", "xyz=\"0 0 ${height}\"", "run xacro first"], &refusal(&macros));
    let left = sound().replace("</robot>", "<xacro:sensors/></robot>");
    assert_like(&left, &sound(), &["left out", "did not expand", "`xacro:sensors`"]);
    assert_says(&["outermost element is <mujoco>", "URDF"], &refusal("<mujoco model=\"x\"/>"));
    let sdf = "<?xml version=\"1.0\"?><sdf version=\"1.6\"><model name=\"x\"/></sdf>";
    assert_says(&["outermost element is <sdf>"], &refusal(sdf));
}

#[test]
fn what_cannot_be_read_is_refused_where_it_matters() {
    let origin = |text: &str| refusal(&arm("ORIGIN", text));
    let words = ["joint `pan`", "xyz=\"0 0\"", "give 3 finite numbers"];
    assert_says(&words, &origin("<origin xyz=\"0 0\"/>"));
    assert_says(&["joint `pan`", "rpy=\"0 x 0\""], &origin("<origin rpy=\"0 x 0\"/>"));
    assert_says(&["joint `pan`", "xyz=\"0 0 1e300\""], &origin("<origin xyz=\"0 0 1e300\"/>"));
    assert_says(&["quaternion of zeros"], &origin("<origin quat_xyzw=\"0 0 0 0\"/>"));
    let nameless = sound().replace("<link name=\"lower\">", "<link>");
    assert_says(&["<link> in line 8", "no name"], &refusal(&nameless));
    let typeless = sound().replace("name=\"lift\" type=\"revolute\"", "name=\"lift\"");
    assert_says(&["joint `lift`", "no type"], &refusal(&typeless));
    let orphan = sound().replace("<parent link=\"upper\"/>", "");
    assert_says(&["joint `lift`", "no <parent"], &refusal(&orphan));
}

/// Such defects in what stands beside the arm do no harm.
#[test]
fn what_cannot_be_read_does_no_harm_beside_the_arm() {
    let beside = "<link name=\"cart\"><inertial><mass value=\"x\"/></inertial></link>\
                  <joint name=\"odd\" type=\"prismatic\"><origin xyz=\"0\"/><parent link=\"base\"/>\
                  <child link=\"cart\"/><limit lower=\"a\"/></joint></robot>";
    let found = loaded(&sound().replace("</robot>", beside));
    assert_eq!(found.robot, loaded(&sound()).robot);
}
