//! Known forces on a UR5 at rest and in motion come back.

use std::sync::Mutex;

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::robot::{point_jacobian, tables};

const DT: f64 = 0.05;
/// What the twin leaves, N.m: sliding, and at rest.
const SLIDING_NM: [f64; 6] = [1.5, 2.0, 1.2, 0.4, 0.4, 0.3];
const RESTING_NM: [f64; 6] = [4.0, 4.0, 3.0, 1.0, 1.0, 1.0];

/// An arm that moves or rests, and a force (N, base axes, over time in s) at a link's end.
struct Scene {
    friction: Friction,
    seed: u64,
    seconds: f64,
    link: usize,
    force: fn(f64) -> [f64; 3],
}

impl Scene {
    fn contacts(&self) -> Vec<Contact> {
        self.followed(&())
    }

    fn followed(&self, watch: &dyn Watch) -> Vec<Contact> {
        let robot = tables::ur5::TABLE.robot();
        let count = (self.seconds / DT) as usize;
        let moves = if self.friction.holds() { 0.0 } else { 0.6 };
        let pose = |j: usize, k: usize| {
            let phase = (0.5 + 0.13 * j as f64) * k as f64 * DT + j as f64;
            [0.4, -1.3, 1.2, -0.9, -1.4, 0.3][j] + moves * phase.sin()
        };
        let rows: Vec<Vec<f64>> =
            (0..6).map(|j| (0..count).map(|k| pose(j, k)).collect()).collect();
        let q = JointSeries::from_joints(&rows);
        let noise = self.noise();
        let torque = self.torque(&robot, &q, &noise);
        let left = Left {
            torque,
            holds: JointSeries::zeros(6, count),
            friction: vec![vec![self.friction; count]; 6],
        };
        let usable = vec![true; count];
        let residual = Residual {
            recording: "simulated",
            robot: &robot,
            start: 0.0,
            dt: DT,
            q: &q,
            left: &left,
            usable: &usable,
            every: 1,
            noise: &noise,
        };
        contacts(&residual, &Criteria::default(), watch)
    }

    fn noise(&self) -> Noise {
        let all = |spread: [f64; 6], lasting_s: f64| {
            let one = |nm: f64| Process { spread_nm: nm, lasting_s, white_nm: 0.05 * nm };
            spread.map(one).to_vec()
        };
        let (slides, rests) = (all(SLIDING_NM, 1.0), all(RESTING_NM, 10.0));
        let (holding, changing) = (rests.clone(), slides.clone());
        Noise { sliding: slides, holding, resting: rests, changing }
    }

    /// What the twin leaves, and -J^T F.
    fn torque(&self, robot: &crate::robot::Robot, q: &JointSeries, noise: &Noise) -> JointSeries {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let mut normal = || (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
        let tip = match robot.bodies.get(self.link + 1) {
            Some(next) => next.joint.placement.translation,
            None => robot.flange.translation,
        };
        let mut state: Vec<f64> = (0..6).map(|_| normal()).collect();
        let mut torque = JointSeries::zeros(6, q.samples());
        let mut pose = vec![0.0; 6];
        for k in 0..q.samples() {
            q.sample_into(k, &mut pose);
            let jacobian = point_jacobian(robot, &pose, self.link, &tip);
            let force = Vector3::from((self.force)(k as f64 * DT));
            for (j, x) in state.iter_mut().enumerate() {
                let process = noise.at(j, self.friction);
                let kept = (-DT / process.lasting_s).exp();
                *x = kept * *x + (1.0 - kept * kept).sqrt() * normal();
                let felt = jacobian.fixed_view::<3, 1>(0, j).dot(&force);
                torque.joint_mut(j)[k] =
                    process.spread_nm * *x + process.white_nm * normal() - felt;
            }
        }
        torque
    }
}

fn only(found: &[Contact]) -> &Contact {
    let [contact] = found else { panic!("{} contacts: {found:#?}", found.len()) };
    contact
}

/// The force at a time, N, and its standard deviation.
fn at(contact: &Contact, time_s: f64) -> [f64; 2] {
    let nearest = contact
        .trace
        .iter()
        .min_by(|a, b| (a.time_s - time_s).abs().total_cmp(&(b.time_s - time_s).abs()));
    let instant = nearest.unwrap();
    [instant.force_n, instant.sd_n]
}

/// Half a sine of 1 s from 10 s on, 40 N at its top.
fn push(t: f64) -> [f64; 3] {
    let inside = (10.0..11.0).contains(&t);
    let size = if inside { (std::f64::consts::PI * (t - 10.0)).sin() } else { 0.0 };
    [24.0 * size, -32.0 * size, 0.0]
}

#[test]
fn a_push_is_weighed_at_rest_and_in_motion() {
    for friction in [Friction::Rests, Friction::Slides] {
        let scene = Scene { friction, seed: 1, seconds: 30.0, link: 5, force: push };
        let found = scene.contacts();
        let contact = only(&found);
        assert!((contact.peak_n - 40.0).abs() < 3.0 * contact.peak_sd_n, "{contact:?}");
        assert!(contact.peak_sd_n < 20.0, "{contact:?}");
        assert!((contact.peak_time_s - 10.5).abs() < 0.3, "{contact:?}");
        assert!((contact.start_s - 10.0).abs() < 0.3 && (contact.end_s - 11.0).abs() < 0.3);
        assert!((contact.links.iter().sum::<f64>() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_push_at_an_early_link_is_told_from_one_further_out() {
    let scene = Scene { friction: Friction::Slides, seed: 2, seconds: 30.0, link: 1, force: push };
    let found = scene.contacts();
    let contact = only(&found);
    assert!(contact.link <= 2 && contact.link_probability > 0.5, "{contact:?}");
    assert!(contact.joints.iter().all(|j| *j <= 2), "{contact:?}");
}

/// A gripper's jaw moves beyond the flange: a push there is still one at the flange.
#[test]
fn the_flange_is_a_place_on_the_link_that_carries_it() {
    let mut robot = tables::ur5::TABLE.robot();
    (robot.flange_on, robot.flange.translation) = (Some(4), Vector3::new(0.0, 0.0, 0.2));
    let flange = places::Place { link: 4, point: robot.flange.translation };
    assert!(places(&robot).contains(&flange), "{:?}", places(&robot));
}

#[test]
fn nothing_touches_where_there_is_only_noise() {
    for (friction, seed) in [(Friction::Rests, 3), (Friction::Slides, 4), (Friction::Slides, 5)] {
        let scene = Scene { friction, seed, seconds: 60.0, link: 5, force: |_| [0.0; 3] };
        assert!(scene.contacts().is_empty(), "{:?}", scene.contacts());
    }
}

/// 20 N/s for 3 s: what is pressed against a wall that gives way.
#[test]
fn a_wall_answers_with_a_growing_force() {
    let wall =
        |t: f64| if (10.0..13.0).contains(&t) { [0.0, 0.0, 20.0 * (t - 10.0)] } else { [0.0; 3] };
    let scene = Scene { friction: Friction::Slides, seed: 6, seconds: 30.0, link: 5, force: wall };
    let found = scene.contacts();
    let contact = only(&found);
    for (time, expected) in [(11.5, 30.0), (12.0, 40.0), (12.5, 50.0)] {
        let [force, sd] = at(contact, time);
        assert!(
            (force - expected).abs() < 3.0 * sd.max(contact.peak_sd_n / 2.0),
            "{force} at {time} s"
        );
    }
    assert!((contact.end_s - 13.0).abs() < 0.3, "{contact:?}");
}

/// 25 N for 8 s. An even force is the harder to tell from drift the longer it lasts: where the arm
/// moves so that it hardly shows, its end is lost.
#[test]
fn a_drag_along_a_table_is_one_contact() {
    let drag = |t: f64| if (10.0..18.0).contains(&t) { [-20.0, 15.0, 0.0] } else { [0.0; 3] };
    let scene = Scene { friction: Friction::Slides, seed: 7, seconds: 40.0, link: 5, force: drag };
    let found = scene.contacts();
    let contact = only(&found);
    assert!((contact.start_s - 10.0).abs() < 0.3, "{}", contact.start_s);
    assert!((15.0..18.3).contains(&contact.end_s), "{}", contact.end_s);
    let [force, sd] = at(contact, 13.0);
    assert!((force - 25.0).abs() < 3.0 * sd.max(contact.peak_sd_n / 2.0), "{force} +- {sd}");
}

/// Somebody who writes down what is told.
#[derive(Default)]
struct Told(Mutex<Vec<(u64, u64)>>);

impl Watch for Told {
    fn tell(&self, _doing: &'static str, done: u64, of: u64) {
        self.0.lock().unwrap().push((done, of));
    }
}

/// Time left is told from it.
#[test]
fn how_far_the_search_is_is_told_step_by_step() {
    let scene = Scene { friction: Friction::Slides, seed: 1, seconds: 5.0, link: 5, force: push };
    let heard = Told::default();
    scene.followed(&heard);
    let told: Vec<_> = (0..100).map(|k| (k, 100)).collect();
    assert_eq!(*heard.0.lock().unwrap(), told);
}
