//! Which of a message's joints are the arm's, base to wrist, whatever their order.

use std::collections::{BTreeMap, HashMap};

use crate::robot::tables::JOINTS as UR;

/// Fewer numbered joints may be a gripper's.
const FEWEST_NUMBERED: usize = 3;
/// As this program names joints: `joint_1`, ...
const OWN: &str = "joint_\0";

/// Positions of the arm's joints among `names`; `None` if this is not a message of the arm.
///
/// # Errors
/// Says what is ambiguous or missing.
pub fn find(names: &[&str], wanted: Option<&[String]>) -> Result<Option<Vec<usize>>, String> {
    match wanted {
        Some(wanted) => listed(names, wanted),
        None => match by_manufacturer(names)? {
            Some(found) => Ok(Some(found)),
            None => numbered(names),
        },
    }
}

/// Whether these are names of a Universal Robots arm, so that its gravity is known.
pub fn of_universal_robots(names: &[String]) -> bool {
    names.len() == UR.len() && names.iter().zip(UR).all(|(name, ending)| name.ends_with(ending))
}

fn listed(names: &[&str], wanted: &[String]) -> Result<Option<Vec<usize>>, String> {
    let at = |w: &String| names.iter().position(|n| n == w);
    let found: Vec<Option<usize>> = wanted.iter().map(at).collect();
    if found.iter().all(Option::is_none) {
        return Ok(None);
    }
    match found.iter().position(Option::is_none) {
        Some(missing) => {
            Err(format!("no joint {:?} (joints there: {})", wanted[missing], names.join(", ")))
        }
        None => Ok(Some(found.into_iter().flatten().collect())),
    }
}

fn by_manufacturer(names: &[&str]) -> Result<Option<Vec<usize>>, String> {
    let prefixes = names.iter().filter_map(|n| n.strip_suffix(UR[0]));
    // Of equal names the first.
    let places: HashMap<&str, usize> =
        names.iter().enumerate().rev().map(|(k, n)| (*n, k)).collect();
    let joints = |prefix: &str| -> Option<Vec<usize>> {
        let at = |ending: &&str| places.get(format!("{prefix}{ending}").as_str()).copied();
        UR.iter().map(at).collect()
    };
    let mut arms: Vec<(&str, Vec<usize>)> =
        prefixes.filter_map(|prefix| Some((prefix, joints(prefix)?))).collect();
    match arms.len() {
        0 => Ok(None),
        1 => Ok(arms.pop().map(|(_, joints)| joints)),
        _ => {
            let prefixes: Vec<_> = arms.iter().map(|(prefix, _)| format!("{prefix:?}")).collect();
            Err(format!("joints of {} arms (prefixes {})", arms.len(), prefixes.join(", ")))
        }
    }
}

/// `joint_1`, `joint_2`, ... or `arm_a0_link`, `arm_a1_link`, ...: one number that counts up.
fn numbered(names: &[&str]) -> Result<Option<Vec<usize>>, String> {
    let mut groups: BTreeMap<String, Vec<(u32, usize)>> = BTreeMap::new();
    for (at, name) in names.iter().enumerate() {
        if let Some((pattern, number)) = split_number(name) {
            groups.entry(pattern).or_default().push((number, at));
        }
    }
    groups.values_mut().for_each(|members| members.sort_unstable());
    groups.retain(|pattern, members| {
        (members.len() >= FEWEST_NUMBERED || pattern == OWN) && counts_up(members)
    });
    match groups.into_iter().collect::<Vec<_>>().as_slice() {
        [] => Ok(None),
        [(_, members)] => Ok(Some(members.iter().map(|(_, at)| *at).collect())),
        several => {
            let patterns: Vec<_> = several.iter().map(|(p, _)| p.replace('\0', "N")).collect();
            Err(format!("joints of {} arms ({})", several.len(), patterns.join(", ")))
        }
    }
}

fn counts_up(members: &[(u32, usize)]) -> bool {
    members[0].0 <= 1 && members.windows(2).all(|w| w[1].0 == w[0].0 + 1)
}

/// The last number of a name, and the name with a zero byte in its place.
fn split_number(name: &str) -> Option<(String, u32)> {
    let end = name.rfind(|c: char| c.is_ascii_digit())? + 1;
    let start = name[..end].rfind(|c: char| !c.is_ascii_digit()).map_or(0, |k| k + 1);
    // The character before may take more than one byte.
    let start = (start..end).find(|k| name.is_char_boundary(*k))?;
    let number = name[start..end].parse().ok()?;
    Some((format!("{}\0{}", &name[..start], &name[end..]), number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_are_found_by_name_in_any_order() {
        let alphabetical = [
            "a_elbow_joint",
            "a_shoulder_lift_joint",
            "a_shoulder_pan_joint",
            "a_wrist_1_joint",
            "a_wrist_2_joint",
            "a_wrist_3_joint",
        ];
        assert_eq!(find(&alphabetical, None), Ok(Some(vec![2, 1, 0, 3, 4, 5])));
        let names = alphabetical.map(|n| n.trim_start_matches("a_"));
        assert_eq!(find(&names, None), Ok(Some(vec![2, 1, 0, 3, 4, 5])));
        let panda = ["finger_joint1", "finger_joint2", "p_joint3", "p_joint1", "p_joint2"];
        assert_eq!(find(&panda, None), Ok(Some(vec![3, 4, 2])));
        assert_eq!(find(&["A0", "é1", "A1", "A2"], None), Ok(Some(vec![0, 2, 3])));
        assert_eq!(find(&["slider", "knob_1", "knob_2"], None), Ok(None));
        let wanted = ["knob_1".to_string(), "slider".to_string()];
        assert_eq!(find(&["slider", "knob_1"], Some(&wanted)), Ok(Some(vec![1, 0])));
        assert_eq!(find(&["gripper"], Some(&wanted)), Ok(None));
        assert!(find(&["slider"], Some(&wanted)).unwrap_err().contains("no joint \"knob_1\""));
    }

    #[test]
    fn two_arms_are_not_guessed_between() {
        let two: Vec<String> =
            ["left_", "right_"].iter().flat_map(|p| UR.map(|n| format!("{p}{n}"))).collect();
        let two: Vec<&str> = two.iter().map(String::as_str).collect();
        let message = find(&two, None).unwrap_err();
        assert!(message.contains("2 arms") && message.contains("\"right_\""), "{message}");
        let two = ["l1", "l2", "l3", "r1", "r2", "r3"];
        assert!(find(&two, None).unwrap_err().contains("lN, rN"));
    }
}
