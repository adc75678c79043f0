//! Grafts on recordings made by hand: a UR5 along sums of sines.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use tempfile::TempDir;

use super::plan::Wanted;
use super::shape::{self, placed};
use super::{DrawOn, Ground, Planned, Sources, draw_on, graft, size};
use crate::effects::{CATALOGUE, Seen, Size, find};
use crate::recording::{Channel, Provenance, Recording, read};
use crate::robot::{builtin, inverse_dynamics_series};
use crate::series::JointSeries;
use crate::signals::{Samples, condition};
use crate::simulation::Injection;
use crate::trials::{Kind, Seals, Truth};
use crate::twin::Twin;

const RATE_HZ: f64 = 100.0;
/// Standard deviation of the current's noise, A.
const NOISE_A: f64 = 0.02;

/// Angle of a joint and its derivatives at a time: three sines of the joint and the motion.
fn motion(joint: usize, which: usize, t: f64) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for i in 0..3_usize {
        let w = TAU * (0.07 + 0.06 * i as f64 + 0.013 * ((3 * joint + which) % 7) as f64);
        let (phase, a) = ((2 * i + joint + 3 * which) as f64, 0.5 / (1.0 + i as f64));
        let (s, c) = (w * t + phase).sin_cos();
        sums = [sums[0] + a * s, sums[1] + a * w * c, sums[2] - a * w * w * s];
    }
    sums
}

/// The default twin's arm with friction, one term that the twin lacks, and noise.
fn recording(which: usize) -> Recording {
    let twin = Twin::default();
    let time: Vec<f64> = (0..2400).map(|k| 3.0 + k as f64 / RATE_HZ).collect();
    let series = |i: usize| {
        let of = |j| time.iter().map(|t| motion(j, which, *t)[i]).collect();
        JointSeries::from_joints(&(0..6).map(of).collect::<Vec<Vec<f64>>>())
    };
    let [q, qd, qdd] = [series(0), series(1), series(2)];
    let tau = inverse_dynamics_series(&twin.robot, &q, &qd, &qdd);
    let mut rng = ChaCha8Rng::seed_from_u64(which as u64);
    let current = tau.map_joints(|j, tau| {
        let drive = |k: usize| {
            let (v, noise): (f64, f64) = (qd.joint(j)[k], StandardNormal.sample(&mut rng));
            let friction = 3.0 * v.signum() + 4.0 * v + 0.4 * (2.0 * q.joint(j)[k]).sin();
            (tau[k] + friction) / twin.drive.torque_per_ampere(j) + NOISE_A * noise
        };
        (0..tau.len()).map(drive).collect()
    });
    let of = |(stem, series): (&str, &JointSeries)| {
        let channel = |j| Channel { name: format!("{stem}_{j}"), values: series.joint(j).to_vec() };
        (0..6).map(channel).collect::<Vec<_>>()
    };
    let signals = [("actual_q", &q), ("actual_qd", &qd), ("actual_current", &current)];
    let mut channels: Vec<Channel> = signals.into_iter().flat_map(of).collect();
    channels.push(Channel { name: "speed_scaling".into(), values: vec![1.0; time.len()] });
    let source = format!("run{which}.csv");
    Recording { time, channels, provenance: Provenance { source, ..Provenance::default() } }
}

fn sources() -> Sources {
    Sources::new(vec![recording(0), recording(1)]).unwrap()
}

fn grounds() -> Vec<Ground> {
    sources().grounds(&Twin::default()).unwrap()
}

fn injection(name: &str, joints: &[usize], row: &[f64]) -> Injection {
    let effect = find(name).unwrap();
    Injection { effect, joints: joints.into(), values: vec![row.to_vec(); joints.len()] }
}

/// Change of a channel of the first recording.
fn changed(injection: &Injection, channel: &str) -> Vec<f64> {
    let ground = &grounds()[0];
    let grafted = graft::onto(ground, injection, &Twin::default().drive);
    let [after, before] = [&grafted, &ground.recording].map(|r| r.channel(channel).unwrap());
    after.iter().zip(before).map(|(a, b)| a - b).collect()
}

/// Samples with their numbers, without the ends, which filters change.
fn inner(x: &[f64]) -> impl Iterator<Item = (usize, &f64)> {
    x.iter().enumerate().skip(200).take(2000)
}

#[test]
fn a_graft_adds_its_torque_to_the_current_and_nothing_else() {
    let drive = Twin::default().drive;
    let offset = injection("current_offset", &[1], &[1.5]);
    let added = changed(&offset, "actual_current_1");
    let wanted = drive.current(1, 1.5);
    assert!(added.iter().all(|a| (a - wanted).abs() < 1e-12), "{wanted}");
    for still in ["actual_current_0", "actual_q_1", "actual_qd_1", "speed_scaling"] {
        assert!(changed(&offset, still).iter().all(|d| *d == 0.0), "{still}");
    }
    // Along the conditioned motion, which is the true one but for its ends.
    let drag = injection("viscous_quadratic", &[2], &[3.0]);
    let added = changed(&drag, "actual_current_2");
    for (k, added) in inner(&added) {
        let v = motion(2, 0, 3.0 + k as f64 / RATE_HZ)[1];
        let torque = added * drive.torque_per_ampere(2);
        assert!((torque - 3.0 * v * v.abs()).abs() < 0.01, "{torque} at {v} rad/s");
    }
}

#[test]
fn sensors_change_their_own_channel() {
    let recorded = recording(0);
    let current = recorded.channel("actual_current_3").unwrap();
    let more = changed(&injection("torque_constant", &[3], &[0.1]), "actual_current_3");
    assert!(more.iter().zip(current).all(|(d, x)| (d - 0.1 * x).abs() < 1e-12));
    // Three samples late.
    let late = changed(&injection("time_delay", &[3], &[0.03]), "actual_current_3");
    assert!((3..2400).all(|k| (late[k] + current[k] - current[k - 3]).abs() < 1e-9));
    let zero = injection("encoder_offset", &[1], &[0.02, 0.02]);
    assert!(changed(&zero, "actual_q_1").iter().all(|d| (d - 0.02).abs() < 1e-12));
    assert!(changed(&zero, "actual_current_1").iter().all(|d| *d == 0.0));
    // A lag shows the velocity of T ago, but for its ends.
    let lag = changed(&injection("velocity_lag", &[4], &[0.02]), "actual_qd_4");
    for (k, lag) in inner(&lag) {
        let late = -0.02 * motion(4, 0, 3.0 + k as f64 / RATE_HZ)[2];
        assert!((lag - late).abs() < 2e-3, "{lag} {late}");
    }
}

/// Strength worked out from the recordings alone, by normal equations.
fn recomputed(before: &Recording, after: &Recording) -> f64 {
    let twin = Twin::default();
    let how = crate::diagnosis::conditioning(before, 6);
    let [before, after] = [before, after].map(|r| condition(r, &twin.drive, 6, &how).unwrap());
    let rigid = inverse_dynamics_series(&twin.robot, &before.q, &before.qd, &before.qdd);
    let less = |a: &JointSeries, b: &JointSeries| {
        a.map_joints(|j, a| a.iter().zip(b.joint(j)).map(|(a, b)| a - b).collect())
    };
    let (gap, graft) = (less(&before.torque, &rigid), less(&after.torque, &before.torque));
    let ratio = |j| left(&before, j, graft.joint(j)) / left(&before, j, gap.joint(j));
    (0..6).map(ratio).fold(0.0, f64::max)
}

/// Root mean square of what Coulomb and viscous friction leave of a torque.
fn left(samples: &Samples, joint: usize, torque: &[f64]) -> f64 {
    let qd = samples.qd.joint(joint);
    let sign = qd.iter().map(|v| v.signum()).collect::<Vec<_>>();
    let mut columns = vec![sign, qd.to_vec(), torque.to_vec()];
    samples.torque_filter().unwrap().unwrap().apply_many(&mut columns);
    let rows = samples.rows(joint);
    let taken: Vec<Vec<f64>> = columns.iter().map(|c| rows.take(c)).collect();
    let a = DMatrix::from_fn(rows.len(), 2, |k, i| taken[i][k]);
    let b = DVector::from_column_slice(&taken[2]);
    let fit = (a.transpose() * &a).lu().solve(&(a.transpose() * &b)).unwrap();
    (&b - a * fit).norm() / (rows.len() as f64).sqrt()
}

fn sized(effect: &'static str, strength: f64) -> size::Graft {
    let grounds = grounds();
    let wanted = Wanted { effect, strength };
    let rng = ChaCha8Rng::seed_from_u64(4);
    size::sized(&wanted, &[], [&grounds[0], &grounds[1]], rng).unwrap()
}

#[test]
fn the_strength_is_what_was_asked_for() {
    let ground = &grounds()[0];
    for (effect, strength) in
        [("payload", 2.0), ("cable_spring", 0.5), ("torque_constant", 4.0), ("lugre", 1.0)]
    {
        let graft = sized(effect, strength);
        assert!((graft.strength.reached() / strength - 1.0).abs() < 0.01, "{effect}");
        let after = graft::onto(ground, &placed(&graft.injection, ground), &Twin::default().drive);
        let found = recomputed(&ground.recording, &after);
        assert!((found / strength - 1.0).abs() < 0.03, "{effect}: {found} for {strength}");
    }
}

/// Every effect that inverse dynamics shows can be grafted, with values inside its ranges.
#[test]
fn the_whole_catalogue_can_be_grafted() {
    let open = ["coulomb", "viscous"];
    let grafted = CATALOGUE.iter().map(|e| (e, e.about())).filter(|(e, about)| {
        let unrecorded = about.name == "temperature_friction"
            || e.of_drive() == crate::effects::DriveKind::Servo;
        e.seen() != Seen::Simulation && !open.contains(&about.name) && !unrecorded
    });
    for (_, about) in grafted {
        let graft = sized(about.name, 1.0);
        assert_eq!((graft.effect().about().name, graft.kind()), (about.name, Kind::Grafted));
        for (p, value) in graft.injection.values.iter().flat_map(|v| about.parameters.iter().zip(v))
        {
            assert!((p.min..=p.max).contains(value), "{}: {} is {value}", about.name, p.name);
        }
    }
    for effect in super::foreign::all() {
        let graft = sized(effect.about().name, 1.0);
        assert_eq!(graft.kind(), Kind::GraftedForeign);
        assert!(graft.strength.reached() > 0.9, "{}", effect.about().name);
    }
}

/// A joint of a strong arm is never grafted softer than such joints are: nobody could answer it.
#[test]
fn no_graft_is_larger_than_the_arm_can_have() {
    let mut strong = grounds();
    let size = Size::of(&builtin("ur10e").unwrap());
    strong.iter_mut().for_each(|ground| ground.size = size);
    let name = "joint_flexibility";
    let soft = find(name).unwrap().about().parameters[0].on(&size);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let largest = shape::draw(name, [&strong[0], &strong[1]], &mut rng).unwrap().sized(1e9);
    let compliance = largest.values[0][0];
    assert!(compliance < soft.max && compliance > 0.9 * soft.max, "{compliance} of {}", soft.max);
}

fn draw(cases: usize, seed: u64, only: &[&str]) -> TempDir {
    let out = TempDir::new().unwrap();
    let only = only.iter().map(ToString::to_string).collect();
    let how = DrawOn { cases: Some(cases), seed, only, ..DrawOn::default() };
    draw_on(&how, &Twin::default(), &sources(), out.path(), &|_| {}, &|| {}).unwrap();
    out
}

fn truths(out: &TempDir) -> Vec<Truth> {
    let seals = Seals::load(out.path()).unwrap();
    (0..seals.cases()).map(|n| seals.open(out.path(), &format!("case-{n:04}")).unwrap()).collect()
}

#[test]
fn untouched_pairs_are_the_recordings_and_grafts_name_theirs() {
    let out = draw(4, 3, &[]);
    let truths = truths(&out);
    assert_eq!(truths.len(), 2 + 4);
    for truth in &truths {
        let at = |file: &str| read(&out.path().join(&truth.case).join(file), None).unwrap();
        let same = |which: usize, file: &str| {
            let (own, found) = (recording(which), at(file));
            own.time == found.time && own.channels == found.channels
        };
        let which = usize::from(truth.recordings[0] == "run1.csv");
        let untouched = same(which, "fit.csv.gz") && same(1 - which, "check.csv.gz");
        assert_eq!(untouched, truth.kind == Kind::Untouched);
        let base = truths.iter().find(|b| Some(&b.case) == truth.base.as_ref());
        match truth.kind {
            Kind::Untouched => assert!(base.is_none() && truth.effects.is_empty()),
            _ => assert_eq!(base.unwrap().recordings, truth.recordings),
        }
    }
}

#[test]
fn the_same_seed_draws_the_same_cases() {
    let [one, again, other] = [(3, 7), (3, 7), (3, 8)].map(|(n, seed)| draw(n, seed, &[]));
    let hidden = |out: &TempDir| serde_json::to_string(&truths(out)).unwrap();
    assert_eq!(hidden(&one), hidden(&again));
    assert_ne!(hidden(&one), hidden(&other));
}

#[test]
fn somebody_pushes_while_one_recording_is_made() {
    let (twin, how) = (Twin::default(), DrawOn::default());
    let planned = Planned::new(&how, &twin, &sources()).unwrap();
    let contact = sized("external_contact", 2.0);
    let [first, second] = [true, false]
        .map(|first| planned.recording(&planned.grounds[0], Some(&contact), first) != recording(0));
    assert!(first && !second);
    // Times as the recording's clock has them.
    let start = placed(&contact.injection, &planned.grounds[0]).values[0][3];
    assert!((3.0..27.0).contains(&start), "{start}");
}

#[test]
fn only_limits_grafts_and_bad_requests_are_refused() {
    let kinds: Vec<Kind> =
        truths(&draw(2, 1, &["current_offset"])).iter().map(|t| t.kind).collect();
    assert!(kinds.contains(&Kind::Untouched) && !kinds.contains(&Kind::GraftedForeign));
    assert_eq!(truths(&draw(2, 1, &["untouched"])).len(), 2);
    let twin = Twin::default();
    for (how, says) in [
        (DrawOn { only: vec!["coulomb".into()], ..DrawOn::default() }, "--only coulomb"),
        (DrawOn { strengths: vec![0.0], ..DrawOn::default() }, "--strengths 0"),
    ] {
        let refused = Planned::new(&how, &twin, &sources()).err().unwrap().to_string();
        assert!(refused.contains(says), "{refused}");
    }
    let twice = Sources::new(vec![recording(0), recording(0)]).unwrap_err().to_string();
    assert!(twice.contains("the same samples"), "{twice}");
    assert_eq!(Sources::new(vec![recording(0)]).unwrap().grounds(&twin).unwrap().len(), 2);
}
