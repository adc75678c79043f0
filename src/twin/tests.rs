//! Reading, refusing, writing back, and the torque of a twin.

use std::path::{Path, PathBuf};

use super::*;

fn parse(text: &str) -> Result<Twin, String> {
    Twin::parse(text, Path::new("some/TWIN.toml")).map_err(|e| e.to_string())
}

/// The message for a bad file names the file and each of `parts`.
fn assert_refused(text: &str, parts: &[&str]) {
    let message = parse(text).expect_err(text);
    for part in ["some/TWIN.toml"].iter().chain(parts) {
        assert!(message.contains(part), "{text}\n{message}\nlacks {part}");
    }
}

#[test]
fn what_is_left_out_is_the_ur5() {
    assert_eq!(parse("").unwrap(), Twin::default());
    let twin = Twin::default();
    assert_eq!((twin.robot.name.as_str(), twin.robot.dof()), ("ur5", 6));
    assert_eq!(twin.drive.torque_per_ampere(1), 101.0 * 0.136);
    assert_eq!(twin.open().count(), 2);
    assert_eq!(twin.known().count(), 0);
}

#[test]
fn a_number_stands_for_all_joints() {
    let twin = parse(
        "[drive]\nrotor_inertia = 1\n[twin]\neffects = [\"coulomb\", \"payload\"]\n\
         [twin.values]\ncoulomb = 5\npayload_mass = 2.5\n",
    )
    .unwrap();
    assert_eq!(twin.drive.rotor_inertia, [1.0; 6]);
    assert_eq!(twin.drive.torque_constant, Twin::default().drive.torque_constant);
    assert_eq!(twin.values["coulomb"], [5.0; 6]);
    assert_eq!(twin.values["payload_mass"], [2.5]);
    let known: Vec<_> = twin.known().map(|e| e.about().name).collect();
    let open: Vec<_> = twin.open().map(|e| e.about().name).collect();
    assert_eq!((known, open), (vec!["coulomb"], vec!["payload"]));
}

#[test]
fn bad_files_are_refused_by_key() {
    assert_refused("robot = ", &["line 1"]);
    assert_refused("robto = \"ur5\"", &["robto", "robot", "drive"]);
    assert_refused("robot = \"ur6\"", &["robot", "ur6", "ur10e"]);
    assert_refused("robot = \"ur10e\"", &["[drive]", "torque_constant", "ur10e"]);
    assert_refused("[drive]\ngear = 3", &["gear", "gear_ratio"]);
    assert_refused("[drive]\ngear_ratio = \"high\"", &["gear_ratio", "a number for all joints"]);
    assert_refused("[drive]\ngear_ratio = [101, 101]", &["gear_ratio", "2", "6"]);
    assert_refused("[drive]\ntorque_constant = 0", &["torque_constant", "joint 1"]);
    assert_refused("[drive]\nrotor_inertia = nan", &["rotor_inertia"]);
    let two = "[twin]\neffects = [\"coulomb\", \"coulomb\"]";
    assert_refused(two, &["twin.effects", "twice"]);
    let unknown = "[twin]\neffects = [\"magic\"]";
    assert_refused(unknown, &["twin.effects", "magic", "viscous_cubic"]);
    assert_refused("[twin.values]\nmagic = 1", &["twin.values.magic", "coulomb, viscous"]);
    assert_refused("[twin.values]\ncoulomb = [1, 2]", &["twin.values.coulomb", "2", "6"]);
    assert_refused("[twin.values]\ncoulomb = -1", &["twin.values.coulomb", "-1", "0 to"]);
    assert_refused("[twin.values]\nviscous = inf", &["twin.values.viscous", "inf"]);
}

/// Values a fit or a slip of units can give are read, others are not; links keep a mass.
#[test]
fn absurd_values_are_refused() {
    let with = |effect: &str, values: &str| {
        format!("[twin]\neffects = [\"{effect}\"]\n[twin.values]\n{values}")
    };
    assert_refused(&with("coulomb", "coulomb = 1e300"), &["twin.values.coulomb", "1e300"]);
    let load = |kg: &str| {
        let moments = "payload_moment_x = 0\npayload_moment_y = 0\npayload_moment_z = 0";
        with("payload", &format!("payload_mass = {kg}\n{moments}"))
    };
    assert!(parse(&load("40")).is_ok(), "beyond the catalogue's range, but no nonsense");
    assert_refused(&load("1e300"), &["twin.values.payload_mass"]);
    let spread =
        |zz: &str| load(&format!("2\npayload_inertia_xx = 0.01\npayload_inertia_zz = {zz}"));
    assert!(parse(&spread("0.01")).is_ok(), "a rod");
    assert_refused(&spread("0.05"), &["twin.values.payload_inertia", "no body", "the nearest"]);
    let links = |kg: &str| {
        let moments = "link_moment_x = 0\nlink_moment_y = 0\nlink_moment_z = 0";
        with("link_inertia", &format!("link_mass = [0, {kg}, 0, 0, 0, 0]\n{moments}"))
    };
    assert!(parse(&links("-3")).is_ok());
    assert_refused(&links("-80"), &["twin.values.link_mass", "link 2's mass", "nothing is left"]);
    assert_refused("[drive]\ngear_ratio = 1e300", &["gear_ratio of joint 1", "1e9 at most"]);
    assert_refused("[drive]\ntorque_constant = 1e-300", &["torque_constant of joint 1"]);
}

#[test]
fn a_missing_file_is_named() {
    let message = Twin::load(Path::new("no/such.toml")).unwrap_err().to_string();
    assert!(message.contains("no/such.toml"), "{message}");
}

#[test]
fn writes_what_it_reads() {
    let mut twin = Twin::default();
    twin.effects.push("stribeck".into());
    twin.drive.rotor_inertia = vec![1.1, 1.1, 1.1, 0.14, 0.14, 0.1 + 0.2];
    twin.drive.torque_limit = Some(vec![150.0; 6]);
    for (name, value) in [("coulomb", 1.0 / 3.0), ("stribeck_velocity", 0.05)] {
        twin.values.insert(name.into(), vec![value; 6]);
    }
    assert_eq!(parse(&twin.to_toml()).unwrap(), twin, "{}", twin.to_toml());
}

#[test]
fn a_urdf_counts_from_the_folder_of_the_twin() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = crate::robot::urdf::write(&Twin::default().robot);
    std::fs::write(folder.path().join("arm.urdf"), urdf).unwrap();
    let file = folder.path().join("twin.toml");
    let drive = "[drive]\ngear_ratio = 100\ntorque_constant = 0.1\n";
    std::fs::write(&file, format!("robot = \"arm.urdf\"\n{drive}")).unwrap();
    let twin = Twin::load(&file).unwrap();
    assert_eq!(twin.robot.dof(), 6);
    let elsewhere = tempfile::tempdir().unwrap();
    let saved = elsewhere.path().join("saved.toml");
    twin.save(&saved).unwrap();
    assert_eq!(Twin::load(&saved).unwrap(), twin);
}

#[test]
fn a_saved_twin_names_its_urdf_from_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("twins")).unwrap();
    let urdf = crate::robot::urdf::write(&Twin::default().robot);
    for (arm, beside, below) in
        [("arm.urdf", "arm.urdf", "../arm.urdf"), ("ur5", "./ur5", "../ur5")]
    {
        let source = folder.path().join(arm);
        std::fs::write(&source, &urdf).unwrap();
        let twin = Twin { source: source.display().to_string(), ..Twin::default() };
        for (file, name) in [("a.toml", beside), ("twins/a.toml", below)] {
            let text = twin.to_toml_at(&folder.path().join(file));
            assert!(text.contains(&format!("robot = {name:?}")), "{text}");
        }
        // Nothing that could be moved holds both.
        let apart = twin.to_toml_at(Path::new("/proc/a.toml"));
        assert!(apart.contains(&format!("robot = {:?}", twin.source)), "{apart}");
    }
    assert!(Twin::default().to_toml_at(&folder.path().join("a.toml")).contains("robot = \"ur5\""));
}

/// A chain of a URDF: read by its keys, kept with the notes when saved, and refused by key.
#[test]
fn an_arm_inside_a_larger_robot_is_named_by_base_and_tip() {
    let urdf =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/robots/cart_with_two_arms.urdf");
    let text = |chain: &str| {
        format!("robot = {urdf:?}\n{chain}\n[drive]\ngear_ratio = 100\ntorque_constant = 0.1\n")
    };
    let chain = "base = \"mast\"\ntip = \"right_3\"\nflange = \"right_2\"";
    let twin = parse(&text(chain)).unwrap();
    assert_eq!(twin.robot.carrier(), Some(1));
    let joints: Vec<_> = twin.robot.bodies.iter().map(|b| b.joint.name.as_str()).collect();
    assert_eq!(joints, ["right_pan", "right_lift", "right_elbow"]);
    assert!(twin.notes.iter().any(|n| n.contains("gravity")), "{:?}", twin.notes);
    assert_eq!(parse(&twin.to_toml()).unwrap(), twin, "{}", twin.to_toml());
    assert_refused(&text("base = \"mast\""), &["`robot`", "several chains", "left_3", "right_3"]);
    assert_refused(&text("tip = \"right_3\""), &["`robot`", "joint `lift`", "--base mast"]);
}

#[test]
fn shipped_twins_load() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/twins");
    for (name, inertia) in [("ur5", 1.1), ("ur5_paper", 0.0), ("ur10e", 0.0)] {
        let twin = Twin::load(&folder.join(name).with_extension("toml")).unwrap();
        assert!(name.starts_with(&twin.robot.name), "{name}");
        assert_eq!(twin.drive.rotor_inertia[0], inertia, "{name}");
    }
    assert_eq!(Twin::load(&folder.join("ur5_paper.toml")).unwrap(), Twin::default());
}

/// Inverse dynamics has its own tests; here, what is added to it, by hand.
#[test]
fn torque_is_rigid_body_rotor_and_known_effects() {
    let one = |x: f64| JointSeries::from_joints(&vec![vec![x]; 6]);
    let (q, qd, qdd) = (one(0.3), one(-0.5), one(2.0));
    let bare = Twin::default();
    let motion = Motion::new(&bare.robot, 0.01, &q, &qd, &qdd);
    let mut twin = bare.clone();
    twin.drive.rotor_inertia = vec![1.1; 6];
    twin.effects.push("stribeck".into());
    for (name, value) in [("coulomb", 5.0), ("stribeck_excess", 9.0)] {
        twin.values.insert(name.into(), vec![value; 6]);
    }
    let rigid = inverse_dynamics_series(&bare.robot, &q, &qd, &qdd);
    assert_eq!(bare.torque(&motion), rigid);
    for joint in 0..6 {
        // Viscous and Stribeck lack values: 1.1 x 2 - 5.
        let added = twin.torque(&motion).joint(joint)[0] - rigid.joint(joint)[0];
        assert!((added - (2.2 - 5.0)).abs() < 1e-9, "joint {}: {added}", joint + 1);
    }
    twin.effects.push("rotor_inertia".into());
    twin.values.insert("rotor_inertia".into(), vec![0.5; 6]);
    let added = twin.torque(&motion).joint(5)[0] - rigid.joint(5)[0];
    assert!((added - (1.0 - 5.0)).abs() < 1e-9, "in place of the drive's 1.1: {added}");
}

/// mu times the torque that the gear carries, 2.5 kg at the flange included.
#[test]
fn load_friction_feels_a_known_payload() {
    let one = |x: f64| JointSeries::from_joints(&vec![vec![x]; 6]);
    let (q, qd, qdd) = (one(0.3), one(0.5), one(0.0));
    let mut twin = Twin { effects: vec!["payload".into()], ..Twin::default() };
    for (name, value) in [("mass", 2.5), ("moment_x", 0.0), ("moment_y", 0.0), ("moment_z", 0.2)] {
        twin.values.insert(format!("payload_{name}"), vec![value]);
    }
    let bare = Twin::default().robot;
    let motion = Motion::new(&bare, 0.01, &q, &qd, &qdd);
    let without = twin.torque(&motion);
    twin.effects.push("load_friction".into());
    twin.values.insert("load_friction".into(), vec![0.1; 6]);
    let com = nalgebra::Vector3::z() * 0.08;
    let laden = twin.robot.with_payload(2.5, com, nalgebra::Matrix3::zeros());
    let load = inverse_dynamics_series(&laden, &q, &qd, &qdd).joint(1)[0];
    let friction = twin.torque(&motion).joint(1)[0] - without.joint(1)[0];
    assert!((friction - 0.1 * load.abs()).abs() < 1e-9, "{friction} of {load}");
}

/// Payload and links on a tilted base: each is worked out with what is built in before it, so that
/// together they are the inverse dynamics of the arm that has them all.
#[test]
fn loads_tilt_with_the_base() {
    let series = |s: f64| {
        let joint = |j: usize| (0..9).map(|k| (s * (k * 7 + j * 3 + 1) as f64).sin()).collect();
        JointSeries::from_joints(&(0..6).map(joint).collect::<Vec<Vec<f64>>>())
    };
    let (q, qd, qdd) = (series(1.3), series(2.1), series(0.7));
    let effects = ["base_tilt", "link_inertia", "payload"].map(String::from).to_vec();
    let mut twin = Twin { effects, ..Twin::default() };
    twin.drive.rotor_inertia = vec![0.0; 6];
    for (name, values) in [
        ("payload_mass", vec![2.5]),
        ("payload_moment_x", vec![0.1]),
        ("payload_moment_y", vec![-0.1]),
        ("payload_moment_z", vec![0.2]),
        ("tilt_x", vec![0.2]),
        ("tilt_y", vec![-0.1]),
        ("link_mass", vec![0.0, 0.4, 0.0, 0.0, 0.0, 0.1]),
        ("link_moment_x", vec![0.05; 6]),
        ("link_moment_y", vec![0.0; 6]),
        ("link_moment_z", vec![0.0; 6]),
    ] {
        twin.values.insert(name.into(), values);
    }
    let torque = twin.torque(&Motion::new(&twin.robot, 0.01, &q, &qd, &qdd));
    let expected = inverse_dynamics_series(&twin.laden(), &q, &qd, &qdd);
    for j in 0..6 {
        for (a, b) in torque.joint(j).iter().zip(expected.joint(j)) {
            assert!((a - b).abs() < 1e-9, "joint {}: {a} and {b}", j + 1);
        }
    }
}

/// A file under the folder of shared recordings, which need not be there.
fn shared(path: &str) -> Option<PathBuf> {
    let root = std::env::var_os("ARMTWIN_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let file = root.join("recordings").join(path);
    if !file.exists() {
        eprintln!("skipped: {} is not here", file.display());
    }
    file.exists().then_some(file)
}

/// A standing UR10e: the twin's torque is the controller's own (which takes g = 9.82), and its
/// current, turned into torque, differs by no more than stiction can hold.
#[test]
fn ur10e_gravity_is_the_controllers_and_the_currents() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let twin = Twin::load(&here.join("twins/ur10e.toml")).unwrap();
    let map = here.join("columns/ur10e_shamilmamedov.toml");
    for pose in ["p2", "p5", "p8"] {
        let name = format!("shamilmamedov-dynamic_calibration/validation_data/ur-20_01_17-{pose}");
        let Some(file) = shared(&format!("{name}.csv.gz")) else { return };
        let recording = crate::recording::read(&file, Some(&map)).unwrap();
        let mean = |stem: &str| {
            let mean = |_, x: &[f64]| vec![x.iter().sum::<f64>() / x.len() as f64];
            recording.joints(stem).unwrap().map_joints(mean)
        };
        let (q, zero) = (mean("actual_q"), JointSeries::zeros(6, 1));
        let tau = twin.torque(&Motion::new(&twin.robot, 0.01, &q, &zero, &zero));
        let (asked, measured) =
            (mean("target_moment"), twin.drive.torque_series(&mean("actual_current")));
        for (joint, stiction) in [20.0, 20.0, 10.0, 4.0, 4.0, 4.0].into_iter().enumerate() {
            let [tau, asked, measured] = [&tau, &asked, &measured].map(|s| s.joint(joint)[0]);
            assert!(
                (tau - asked).abs() < 2e-3 * asked.abs() + 1e-3,
                "{pose} {joint}: {tau} {asked}"
            );
            assert!((tau - measured).abs() < stiction, "{pose} {joint}: {tau} {measured}");
        }
    }
}
