//! The stepper beside rapier, and values that come back through it.

mod columns;
mod limits;
mod steps;
mod time_offset;
mod tracks;

use super::choice::Sifted;
use super::fit::weigh;
use super::folds::{Folds, Halved};
use super::judge::rms_rad;
use super::problem::Problem;
use super::refit::Refits;
use super::screen::{Other, starts};
use super::sift::Sieve;
use super::yardstick::Yardstick;
use super::*;
use crate::diagnosis::{Change, Offer, Stands, Value};
use crate::identification::levenberg_marquardt::Residuals;
use crate::signals::{Conditioning, condition};
use crate::simulation::{Scenario, Simulation};
use crate::twin::Twin;

const SERVOS: &str = "
rate_hz = 250
step_s = 0.0004
[drive]
rotor_inertia = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14]
[servo]
gain = [9000, 9000, 6000, 900, 900, 900]
damping = [500, 500, 400, 40, 40, 40]
delay = 0.012
[noise]
position_rad = 0
velocity_rad_s = 0
[quantisation]
position_rad = 0
[motion]
duration_s = 6
rest_s = 0.5
[effects.coulomb]
coulomb = [9, 10, 8, 3, 2, 2]
[effects.viscous]
viscous = [9, 11, 7, 1.9, 1.4, 1.1]
[effects.load_friction]
load_friction = 0.05
";

/// The arm that rapier moved, as a twin, and what was recorded of it.
fn by_rapier(scenario: &str) -> (Twin, Track) {
    let scenario = Scenario::parse(scenario, "test").unwrap();
    let made = scenario.work_out("test").unwrap();
    let mut simulation = Simulation::new(&made.setup).unwrap();
    let run = simulation.run(&made.fit, 1, 0, &mut |_| true).unwrap();
    let names: Vec<&str> = run.recording.channels.iter().map(|c| c.name.as_str()).collect();
    assert!(names.iter().all(|n| n.contains("_q_")), "no torque is recorded: {names:?}");
    let mut twin = Twin { drive: made.setup.drive.clone(), effects: vec![], ..Twin::default() };
    for injection in &made.setup.effects {
        let about = injection.effect.about();
        twin.effects.push(about.name.into());
        for (i, p) in about.parameters.iter().enumerate() {
            twin.values.insert(p.name.into(), injection.values.iter().map(|v| v[i]).collect());
        }
    }
    let samples = condition(&run.recording, &twin.drive, 6, &Conditioning::default()).unwrap();
    let track = Track::new(&samples, &twin).unwrap();
    (twin, track)
}

/// rapier steps at 0.4 ms and hears its command 500 times a second; the stepper takes 2 ms. Measured: 0.1 to
/// 0.2 mrad apart in motions of 0.9 rad, along which the arm lags its command by 20 mrad and more.
#[test]
fn the_stepper_goes_where_rapier_goes() {
    let (twin, track) = by_rapier(SERVOS);
    let simulated = replay(&twin, &track, &track.stretches(f64::INFINITY)).unwrap();
    let gap = PositionGap::new(&track, &simulated);
    for j in &gap.joints {
        assert!(j.rms_rad < 5e-4 && j.r2 > 0.99999, "{gap:?}");
    }
    // And without friction it goes elsewhere.
    let smooth = Twin { effects: vec![], values: Default::default(), ..twin };
    let other = replay(&smooth, &track, &track.stretches(f64::INFINITY)).unwrap();
    assert!(PositionGap::new(&track, &other).rms_rad() > 5.0 * gap.rms_rad(), "{gap:?}");
}

/// Springs and gaps between motors and links, rapier at 0.1 ms. The encoders are at the motors, and show what the links
/// do to them: without springs and gaps the stepper goes elsewhere. Of gaps motors with heavy rotors feel little.
#[test]
fn links_that_hang_behind_their_motors_go_where_rapier_goes() {
    let soft = "[effects.joint_flexibility]\njoint_compliance = [0, 1e-3, 1e-3, 0, 0, 0]\n\
                joint_damping = 2.0\njoint_hardening = 1e5\njoint_hysteresis = 3.0\n\
                hysteresis_width = 1e-2\n";
    let slack = "[effects.backlash]\nbacklash_gap = [0.02, 0, 0.02, 0.02, 0, 0]\n\
                 backlash_stiffness = 2e4\nbacklash_damping = 20.0\n";
    for (own, times) in [(soft, 4.0), (slack, 2.0)] {
        let fine = SERVOS
            .replace("step_s = 0.0004", "step_s = 0.0001")
            .replace("inertia = [1.1, 1.1, 1.1,", "inertia = [0.2, 0.2, 0.2,")
            .replace("gain = [9000, 9000, 6000,", "gain = [2000, 4000, 3000,")
            .replace("damping = [500, 500, 400,", "damping = [50, 100, 80,");
        let (twin, track) = by_rapier(&format!("{fine}{own}"));
        let simulated = replay(&twin, &track, &track.stretches(f64::INFINITY)).unwrap();
        let gap = PositionGap::new(&track, &simulated);
        let rigid = Twin {
            effects: twin.effects.iter().filter(|e| !own.contains(e.as_str())).cloned().collect(),
            ..twin
        };
        let other = replay(&rigid, &track, &track.stretches(f64::INFINITY)).unwrap();
        let other = PositionGap::new(&track, &other);
        assert!(other.rms_rad() > times * gap.rms_rad(), "{other:?} {gap:?}");
    }
}

/// How soft a joint is, from command and position alone; what is not fitted of its spring is usual.
#[test]
fn a_spring_between_motor_and_link_comes_back() {
    let fine = SERVOS.replace("step_s = 0.0004", "step_s = 0.0001");
    let soft = "[effects.joint_flexibility]\njoint_compliance = [0, 0, 2e-3, 0, 0, 0]\n\
                joint_damping = 5.0\njoint_hardening = 0\njoint_hysteresis = 0\n\
                hysteresis_width = 1e-3\n";
    let (truth, track) = by_rapier(&format!("{fine}{soft}"));
    let mut twin = truth.clone();
    twin.effects.retain(|e| e != "joint_flexibility");
    twin.values.retain(|name, _| !soft.contains(name.as_str()));
    let mut free = free_parameters(&twin, &["joint_flexibility".to_string()]).unwrap();
    free.retain(|f| f.joint == Some(2));
    let names: Vec<&str> = free.iter().map(|f| f.parameter.name).collect();
    assert_eq!(names, ["joint_compliance", "joint_damping"]);
    let settings = Settings { horizon_s: 2.0, ..Settings::default() };
    let found = identify(&twin, &[&track], &free, &settings, &()).unwrap();
    let compliance = found.estimates[0].value;
    assert!((compliance - 2e-3).abs() < 1e-4, "{:?}", found.estimates);
    assert_eq!(found.twin.values["joint_hysteresis"], [0.0; 6]);
}

/// Friction, gain and delay of a servo that its twin has otherwise, from command and position alone.
#[test]
fn values_come_back_from_command_and_position() {
    let (truth, track) = by_rapier(SERVOS);
    let mut twin = truth.clone();
    twin.values.insert("coulomb".into(), vec![1.0; 6]);
    let servo = twin.drive.servo.as_mut().unwrap();
    servo.gain.iter_mut().for_each(|k| *k *= 0.8);
    servo.delay.fill(0.0);
    let effects = ["coulomb", "servo_gain", "servo_delay"].map(String::from);
    let free = free_parameters(&twin, &effects).unwrap();
    let settings = Settings { horizon_s: 2.0, ..Settings::default() };
    let found = identify(&twin, &[&track], &free, &settings, &()).unwrap();
    assert!(found.stop.converged(), "{:?}", found.stop);
    for e in &found.estimates {
        let j = e.joint.unwrap() - 1;
        let (wanted, near) = match e.name {
            "coulomb" => (truth.values["coulomb"][j], 0.6),
            // 2 % of the gain: rapier's servos look at their error 500 times a second only.
            "servo_gain_error" => (0.25, 0.03),
            _ => (0.012, 0.002),
        };
        assert!((e.value - wanted).abs() < near && e.identifiable, "{wanted}: {e:?}");
        assert!(e.low <= e.value && e.value <= e.high, "{e:?}");
    }
    let [before, after] = [&found.before[0], &found.after[0]].map(PositionGap::rms_rad);
    assert!(after < 0.05 * before, "{before} -> {after}");
}

/// Mass and first moments of a load that the twin does not carry: what is usually none (a moment aside) and what a
/// search would begin without (a mass) are found all the same.
#[test]
fn a_load_comes_back_from_command_and_position() {
    let load = "[effects.payload]\npayload_mass = 2.0\npayload_moment_x = 0.1\npayload_moment_y = 0\n\
                payload_moment_z = 0.2\n";
    let (truth, track) = by_rapier(&format!("{SERVOS}{load}"));
    let mut twin = truth.clone();
    twin.effects.retain(|e| e != "payload");
    twin.values.retain(|name, _| !name.starts_with("payload"));
    let free = free_parameters(&twin, &["payload".to_string()]).unwrap();
    let settings = Settings { horizon_s: 2.0, ..Settings::default() };
    let found = identify(&twin, &[&track], &free, &settings, &()).unwrap();
    for (name, wanted, near) in [
        ("payload_mass", 2.0, 0.1),
        ("payload_moment_x", 0.1, 0.02),
        ("payload_moment_z", 0.2, 0.05),
    ] {
        let e = found.estimates.iter().find(|e| e.name == name).unwrap();
        assert!((e.value - wanted).abs() < near && e.low < wanted && wanted < e.high, "{e:?}");
    }
    // However light, its centre is no further away than the arm reaches.
    let values: Vec<f64> = free
        .iter()
        .map(|f| if f.parameter.name == "payload_mass" { f.min } else { f.max })
        .collect();
    let light = super::parameters::with_values(&twin, &free, &values);
    let [moment, mass] = ["payload_moment_x", "payload_mass"].map(|name| light.values[name][0]);
    assert!(moment <= mass * twin.robot.reach() * (1.0 + 1e-12) && mass > 0.0);
}

/// Told to go no further than its friction lets it, a joint does not creep.
#[test]
fn a_servo_within_its_friction_stands() {
    let (twin, _) = by_rapier(SERVOS);
    let mut plant = Plant::new(&twin, 0.0).unwrap();
    let gain = plant.servo().gain.clone();
    plant.set_state(0.0, &[0.0; 6], &[0.0; 6]);
    // Settles where gravity and friction let it, then the base is asked for half its breakaway.
    (0..2000).for_each(|_| plant.step(0.002, &[0.0; 6], &gain));
    let before = plant.shown(0);
    let mut command = [0.0; 6];
    command[0] = before + 0.5 * 9.0 / gain[0];
    (0..2000).for_each(|_| plant.step(0.002, &command, &gain));
    assert_eq!(plant.shown(0), before);
    command[0] = before + 2.0 * 9.0 / gain[0];
    (0..200).for_each(|_| plant.step(0.002, &command, &gain));
    assert!(plant.shown(0) > before + 0.2 * 9.0 / gain[0]);
}

#[test]
fn what_cannot_be_simulated_says_why() {
    let refused = |twin: &Twin| Plant::new(twin, 0.0).err().map(|e| e.to_string()).unwrap();
    assert!(refused(&Twin::default()).contains("[servo]"));
    let (mut twin, _) = by_rapier(SERVOS);
    twin.effects.push("backlash".into());
    twin.drive.rotor_inertia.fill(0.0);
    let values = [("backlash_gap", 0.01), ("backlash_stiffness", 2e4), ("backlash_damping", 1.0)];
    values.into_iter().for_each(|(name, v)| drop(twin.values.insert(name.into(), vec![v; 6])));
    assert!(refused(&twin).contains("joint 1 gives way between motor and link"));
    let term = |name: &str| free_parameters(&twin, &[name.into()]).err().unwrap().to_string();
    assert!(term("magic").contains("no such effect"));
}

#[test]
fn what_is_fitted_at_one_joint_leaves_the_drive_at_others() {
    let (twin, _) = by_rapier(SERVOS);
    let all = free_parameters(&twin, &["rotor_inertia".to_string()]).unwrap();
    let mut heavier = super::parameters::with_values(&twin, &all[3..4], &[0.5]);
    heavier.settle_drive();
    assert_eq!(heavier.drive.rotor_inertia, [1.1, 1.1, 1.1, 0.5, 0.14, 0.14]);
}

/// What a cause takes off an arm that runs away without it is no reason to say nothing.
#[test]
fn what_runs_away_has_no_error() {
    let (twin, track) = by_rapier(SERVOS);
    assert!(rms_rad(&twin, &track).unwrap().is_some_and(|rms| rms < 1e-2));
    let mut wild = twin.clone();
    wild.effects.push("viscous_cubic".into());
    wild.values.insert("viscous_cubic".into(), vec![-1e4; 6]);
    assert_eq!(rms_rad(&wild, &track).unwrap(), None);
    let mut none = twin;
    none.drive.servo = None;
    assert!(rms_rad(&none, &track).is_err());
}

fn without(twin: &Twin, effect: &str) -> Twin {
    let own = crate::effects::find(effect).unwrap().about().parameters;
    let mut twin = twin.clone();
    twin.effects.retain(|e| e != effect);
    twin.values.retain(|name, _| own.iter().all(|p| p.name != name));
    twin
}

fn change(effect: &str, joints: &[usize], values: &[(&str, f64)]) -> Change {
    let value = |&(name, value): &(&str, f64)| Value {
        name: name.into(),
        joint: joints.first().copied(),
        unit: String::new(),
        value,
        low: value,
        high: value,
        at_bound: false,
    };
    let parameters = values.iter().map(value).collect();
    Change { effect: effect.into(), joints: joints.to_vec(), parameters, replaces: false }
}

/// Which of `changes` stand where the arm of `scenario` has `effect` and its twin has not, and the twin with them.
fn sifted(scenario: &str, effect: &str, open: &[&str], changes: &[Change]) -> Sifted {
    let (truth, fit) = by_rapier(scenario);
    let other = scenario.replace("rest_s = 0.5", "rest_s = 0.5\nseed = 7");
    let (_, check) = by_rapier(&other);
    let mut twin = without(&truth, effect);
    open.iter().for_each(|name| drop(twin.values.remove(*name)));
    let halved = Halved::new([fit, check]);
    let folds = Folds::new(&twin, &halved, &()).unwrap();
    let settings = crate::diagnosis::Settings::default();
    let sieve = Sieve { folds: &folds, settings: &settings };
    let offer = |change: &Change| Offer { change: change.clone(), among: 1 };
    sieve.sift(&changes.iter().map(offer).collect::<Vec<_>>()).unwrap()
}

/// A servo brakes less than its twin's by more than the joint's viscous friction, which cannot be negative.
#[test]
fn less_damping_of_a_servo_stands_where_friction_would_have_to_push() {
    let less = "[effects.servo_damping]\nservo_damping = [0, 0, 0, -9, 0, 0]\n";
    let changes = [
        change("viscous_quadratic", &[4], &[("viscous_quadratic", -0.5)]),
        change("servo_damping", &[4], &[("servo_damping", -1.0)]),
    ];
    // Long enough to move in both halves.
    let scenario = format!("{SERVOS}{less}").replace("duration_s = 6", "duration_s = 12");
    let found = sifted(&scenario, "servo_damping", &["viscous"], &changes);
    assert_eq!(found.stand, [Stands { index: 1, equals: vec![] }]);
    for half in &found.mended {
        let [own, viscous] = ["servo_damping", "viscous"].map(|name| half.values[name][3]);
        assert!((own + viscous + 7.1).abs() < 0.7, "{own} {viscous}");
    }
    // No servo drives itself on.
    let [mut twin, _] = found.mended;
    twin.drive.servo.as_mut().unwrap().damping[3] = 4.0;
    let damping = free_parameters(&twin, &["servo_damping".to_string()]).unwrap();
    assert_eq!(damping[3].min, -4.0);
}

/// A push on the flange for two seconds, in both recordings at the same time.
#[test]
fn a_contact_that_lasts_a_while_stands() {
    let window = [("contact_start", 2.5), ("contact_duration", 2.0), ("contact_height", 10.0)];
    let push = "[effects.external_contact]\ncontact_x = 20\ncontact_y = 0\ncontact_z = -60\n\
                contact_start = 2.5\ncontact_duration = 2.0\ncontact_height = 10\n";
    let values = [&[("contact_x", 1.0), ("contact_y", 1.0), ("contact_z", -10.0)][..], &window];
    let changes = [
        change("servo_offset", &[2], &[("servo_offset", 1e-3)]),
        change("external_contact", &[], &values.concat()),
    ];
    let found = sifted(&format!("{SERVOS}{push}"), "external_contact", &[], &changes);
    assert_eq!(found.stand, [Stands { index: 1, equals: vec![] }]);
    for (name, wanted) in [("contact_x", 20.0), ("contact_z", -60.0), ("contact_start", 2.5)] {
        let value = found.mended[0].values[name][0];
        assert!((value - wanted).abs() < 5.0, "{name}: {value}");
    }
}

/// A load that the twin does not carry, beside what is not there; a search along another motion thinks it next to
/// weightless and far off the flange.
#[test]
fn of_changes_stands_what_brings_another_motion_nearer() {
    let load = "[effects.payload]\npayload_mass = 2.0\npayload_moment_x = 0.1\npayload_moment_y = 0\n\
                payload_moment_z = 0.2\n";
    let changes = [
        change("viscous_cubic", &[2], &[("viscous_cubic", 0.1)]),
        change("payload", &[], &[("payload_mass", 1e-3), ("payload_moment_x", -0.5)]),
        change("servo_offset", &[6], &[("servo_offset", 1e-3)]),
    ];
    let found = sifted(&format!("{SERVOS}{load}"), "payload", &[], &changes);
    assert_eq!(found.stand, [Stands { index: 1, equals: vec![] }]);
    let [mended, _] = found.mended;
    assert!((mended.values["payload_mass"][0] - 2.0).abs() < 0.2, "{:?}", mended.values);
    let (truth, fit) = by_rapier(&format!("{SERVOS}{load}"));
    let twin = without(&truth, "payload");
    let refits = Refits::new(&twin, vec![&fit], &()).unwrap();
    let near = refits.all(&mended, &changes[1..2]).unwrap();
    let mass = near.estimates.iter().find(|e| e.name == "payload_mass").unwrap();
    assert!((mass.value - 2.0).abs() < 0.1 && mass.identifiable, "{mass:?}");
}

/// One tangent for both says where fits begin: a load near what is hidden, and an offset that is not there near none.
#[test]
fn a_fit_begins_near_what_is_hidden() {
    let load = "[effects.payload]\npayload_mass = 2.0\npayload_moment_x = 0.1\npayload_moment_y = 0\n\
                payload_moment_z = 0.2\n";
    let (truth, fit) = by_rapier(&format!("{SERVOS}{load}"));
    let twin = without(&truth, "payload");
    let refits = Refits::new(&twin, vec![&fit], &()).unwrap();
    let changes = [
        change("payload", &[], &[("payload_mass", 0.1)]),
        change("servo_offset", &[2], &[("servo_offset", 0.01)]),
    ];
    let others = changes.each_ref().map(|change| Other { change, fitted: None });
    let found = starts(&refits, (&refits.before, &[]), &others).unwrap();
    assert!(found.iter().all(|start| start.has_tangent));
    let [mass, offset] = [("payload_mass", 0, 0), ("servo_offset", 1, 1)]
        .map(|(name, of, joint)| found[of].twin.values[name][joint]);
    assert!((mass - 2.0).abs() < 0.4 && offset.abs() < 0.01, "{mass} {offset}");
}

/// A load is itself, whether it is thought light or heavy, as far as the steps of encoders tell; a servo's offset is no load.
#[test]
fn names_are_equal_that_two_recordings_do_not_tell_apart() {
    let load = "[effects.payload]\npayload_mass = 2.0\npayload_moment_x = 0.1\npayload_moment_y = 0\n\
                payload_moment_z = 0.2\n";
    let steps =
        SERVOS.replace("[quantisation]\nposition_rad = 0", "[quantisation]\nposition_rad = 2e-4");
    let changes = [
        change("payload", &[], &[("payload_mass", 1.5)]),
        change("payload", &[], &[("payload_mass", 2.5)]),
        change("servo_offset", &[2], &[("servo_offset", 0.01)]),
    ];
    let found = sifted(&format!("{steps}{load}"), "payload", &[], &changes);
    assert_eq!(found.stand, [Stands { index: 0, equals: vec![1] }]);
}

/// A recording in halves: each sample in one of them, in stretches, however short it is.
/// What a twin leaves open is what a recording says of it, whatever another said; what it lacks stays.
#[test]
fn open_values_are_those_of_the_recording_it_is_held_against() {
    let (truth, track) = by_rapier(SERVOS);
    let mut elsewhere = truth.clone();
    elsewhere.values.get_mut("viscous").unwrap().iter_mut().for_each(|v| *v *= 10.0);
    let mut soft = elsewhere.clone();
    soft.drive.servo.as_mut().unwrap().gain.iter_mut().for_each(|k| *k *= 0.8);
    let left = |twin: &Twin, open: &[&str]| {
        let open = open.iter().map(|name| name.to_string()).collect();
        let yardstick = Yardstick { track: &track, part: &track, open };
        yardstick.left(twin).unwrap().mean_rad()
    };
    let [own, kept, lacks] =
        [left(&elsewhere, &["viscous"]), left(&elsewhere, &[]), left(&soft, &["viscous"])];
    assert!(own < 0.2 * kept, "{own} {kept}");
    assert!(lacks > 0.5 * left(&soft, &[]), "{lacks}");
}

/// What stops an arm for a moment is not simulated: the value that meets the rest of the recording best counts least.
#[test]
fn a_stop_of_the_arm_does_not_decide_a_value() {
    let (truth, mut track) = by_rapier(SERVOS);
    (600..700).for_each(|k| track.q.joint_mut(1)[k] -= 0.05);
    let mut twin = truth.clone();
    twin.drive.servo.as_mut().unwrap().gain[1] *= 0.8;
    let mut free = free_parameters(&twin, &["servo_gain".to_string()]).unwrap();
    free.retain(|f| f.joint == Some(1));
    let tracks = [&track];
    let best = |is_robust: bool| {
        let mut problem = Problem::new(&twin, &tracks, &free, 2.0);
        problem.is_robust = is_robust;
        let errors = problem.errors(&[0.25]);
        weigh(&mut problem, &errors);
        let counts = |x: f64| -> f64 {
            let mut r = vec![0.0; problem.count()];
            problem.residuals(&[x], &mut r);
            r.iter().map(|r| r * r).sum()
        };
        let values = (0..=20).map(|i| -0.25 + 0.05 * f64::from(i));
        values.min_by(|a, b| counts(*a).total_cmp(&counts(*b))).unwrap()
    };
    let [robust, by_square] = [best(true), best(false)];
    assert!((robust - 0.25).abs() < 0.06, "{robust}");
    assert!((by_square - 0.25).abs() > 0.09, "{by_square}");
}

const BENT: &str = "[effects.servo_offset]\nservo_offset = [0, 0, 0, 0, 0.02, 0]\n";

/// Fitted from two sides it comes out a little otherwise, which tells nothing.
#[test]
fn of_equals_the_most_plausible_comes_first() {
    let from = |offset: f64| change("servo_offset", &[5], &[("servo_offset", offset)]);
    for (first, second) in [(0.01, 0.03), (0.03, 0.01)] {
        let changes = [from(first), from(second)];
        let found = sifted(&format!("{SERVOS}{BENT}"), "servo_offset", &[], &changes);
        assert_eq!(found.stand, [Stands { index: 0, equals: vec![1] }], "{first}");
    }
}

/// The moments of a load are as far off as its mass lets them be; before there is one, nothing is known of them.
#[test]
fn moments_of_a_load_are_expected_to_go_with_its_mass() {
    let (mut twin, _) = by_rapier(SERVOS);
    let spread = |twin: &Twin| {
        let free = free_parameters(twin, &["payload".to_string()]).unwrap();
        let x = free.iter().find(|f| f.parameter.name == "payload_moment_x").unwrap();
        x.near_start(twin).spread
    };
    let unknown = spread(&twin);
    for name in ["payload_moment_x", "payload_moment_y", "payload_moment_z"] {
        twin.values.insert(name.into(), vec![0.0]);
    }
    let mut with = |mass: f64| {
        twin.values.insert("payload_mass".into(), vec![mass]);
        spread(&twin)
    };
    let [light, heavy] = [with(0.5), with(2.0)];
    assert!(
        (heavy / light - 4.0).abs() < 1e-9 && heavy < 0.5 * unknown,
        "{light} {heavy} {unknown}"
    );
}

/// A ripple of less than one wave a turn looks like an offset.
#[test]
fn what_fits_only_at_the_end_of_its_range_does_not_stand() {
    let waves = [("ripple_sine", 1.0), ("ripple_cosine", 1.0), ("ripple_order", 1.5)];
    let changes = [
        change("torque_ripple", &[5], &waves),
        change("servo_offset", &[5], &[("servo_offset", 1e-3)]),
    ];
    let found = sifted(&format!("{SERVOS}{BENT}"), "servo_offset", &[], &changes);
    assert_eq!(found.stand, [Stands { index: 1, equals: vec![] }]);
}
