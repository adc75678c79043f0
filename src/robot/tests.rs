//! Loading arms by name and path, and their drives.

use super::*;
use crate::series::JointSeries;

#[test]
fn every_table_is_found_by_its_name_and_tells_its_source() {
    for table in BUILT_IN {
        let robot = load(table.name, &Chain::default()).unwrap().robot;
        assert_eq!((robot.name.as_str(), robot.dof()), (table.name, 6));
        assert!(table.source.len() > 40, "{}", table.name);
        assert!(robot.bodies.iter().all(|b| b.inertia.about_com.cholesky().is_some()));
    }
    assert!(builtin("ur7").is_none());
}

#[test]
fn the_printed_ur5_differs_in_the_twist_of_joint_4_alone() {
    let (right, printed) = (builtin("ur5").unwrap(), builtin("ur5-as-printed").unwrap());
    assert_eq!(right.bodies[..3], printed.bodies[..3]);
    let (r, p) = (&right.bodies[4].joint.placement, &printed.bodies[4].joint.placement);
    assert_eq!(r.rotation, p.rotation.transpose());
    assert_eq!(right.bodies[5], printed.bodies[5]);
}

#[test]
fn unknown_names_and_missing_files_say_what_to_give() {
    let unknown = load("ur7", &Chain::default()).unwrap_err().to_string();
    assert!(unknown.contains("`ur7`") && unknown.contains("ur5e") && unknown.contains("URDF"));
    let missing = load("arms/none.urdf", &Chain::default()).unwrap_err().to_string();
    assert!(missing.contains("arms/none.urdf") && missing.contains("cannot read"), "{missing}");
}

#[test]
fn ur5_currents_become_torques_and_come_back() {
    let drive = Drive::for_robot("ur5", 6).unwrap();
    drive.check(6).unwrap();
    assert!((drive.torque(1, 2.0) - 2.0 * 101.0 * 0.136).abs() < 1e-12);
    let current = JointSeries::from_joints(&vec![vec![-1.5, 0.0, 2.0]; 6]);
    let back = drive.current_series(&drive.torque_series(&current));
    for j in 0..6 {
        let pairs = back.joint(j).iter().zip(current.joint(j));
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-15));
    }
}

#[test]
fn a_drive_delivers_no_more_than_its_tighter_limit() {
    let mut drive = Drive::new(vec![100.0], vec![0.1]);
    assert_eq!(drive.limited(0, 1e6), 1e6);
    drive.torque_limit = Some(vec![28.0]);
    assert_eq!(drive.limited(0, -50.0), -28.0);
    drive.current_limit = Some(vec![1.0]);
    assert_eq!(drive.limited(0, 50.0), 10.0);
    assert_eq!(drive.limited(0, 9.0), 9.0);
}

#[test]
fn arms_without_published_drive_and_bad_drives_name_the_key() {
    let unknown = Drive::for_robot("ur10e", 6).unwrap_err().to_string();
    assert!(unknown.contains("`ur10e`") && unknown.contains("[drive]"), "{unknown}");
    let mut drive = Drive::for_robot("ur5", 6).unwrap();
    drive.torque_constant[3] = 0.0;
    let bad = drive.check(6).unwrap_err().to_string();
    assert!(bad.contains("torque_constant of joint 4"), "{bad}");
    let few = Drive::new(vec![101.0; 5], vec![0.1; 6]).check(6).unwrap_err().to_string();
    assert!(few.contains("gear_ratio has 5 values"), "{few}");
}
