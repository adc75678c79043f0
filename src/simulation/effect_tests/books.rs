//! The energy books of every effect: what the motors do is stored in the arm, or taken by loads.
//!
//! Kept step by step: what is open in one step cannot be made up for in another, so that even a
//! load that gives back all it takes has to be right.

use super::driven::{Driven, Instant};
use super::*;
use crate::effects::{Transmission, find};
use crate::robot::{Workspace, energy, flange_placement};

const SECONDS: f64 = 1.5;
/// Share of the usual push: slow joints too, where friction depends on speed most.
const PUSH: f64 = 0.4;
/// Steps of a simulation of a rigid arm (0.4 ms at most) and of one that gives way, s.
const STEP_S: f64 = 2.5e-4;
const ELASTIC_STEP_S: f64 = 1e-4;

/// J: kinetic and potential, of links, rotors and what is wound up between them.
pub fn stored(mechanism: &Mechanism, [qm, vm]: [&[f64]; 2], [ql, vl]: [&[f64]; 2]) -> f64 {
    let links = energy(&mechanism.robot, &mut Workspace::new(&mechanism.robot), ql, vl).total();
    let of_motor = |j: usize| {
        let wound = mechanism.transmission[j].map_or(0.0, |law| spring(&law, qm[j] - ql[j]));
        0.5 * mechanism.armature[j] * vm[j].powi(2) + wound
    };
    links + (0..qm.len()).map(of_motor).sum::<f64>()
}

/// J: what a wound-up transmission gives back.
fn spring(law: &Transmission, w: f64) -> f64 {
    let x = w - w.clamp(-0.5 * law.gap, 0.5 * law.gap);
    0.5 * law.stiffness * x * x + 0.25 * law.hardening * x.powi(4)
}

/// What transmissions turn into heat.
#[derive(Default)]
pub struct Gears {
    bristles: [f64; 6],
}

impl Gears {
    /// W at a wind-up (rad) that changes (rad/s) through a step of `h` s.
    pub fn loss(&mut self, joint: usize, law: &Transmission, [w, rate]: [f64; 2], h: f64) -> f64 {
        let z = &mut self.bristles[joint];
        *z = law.bent(*z, rate * h);
        law.damping_at(w) * rate * rate + law.hysteresis * *z * rate
    }
}

/// W that dry friction, damping and torque take from a joint that turns at `v` (rad/s).
fn taken(load: &JointLoad, v: f64) -> f64 {
    load.torque * v + load.dry.max(0.0) * v.abs() + load.damping * v * v
}

/// The books of a mechanism, one instant after the other; J.
#[derive(Default)]
struct Books {
    /// Stored, J, and what comes in from the motors less what is taken, W, at the last instant.
    last: Option<[f64; 2]>,
    /// What does not add up, of all steps.
    open: f64,
    turned_over: f64,
}

impl Books {
    fn enter(&mut self, stored: f64, work: [f64; 6], taken: f64, h: f64) {
        let net = work.iter().sum::<f64>() - taken;
        if let Some([before, net_before]) = self.last {
            self.open += (stored - before - 0.5 * (net + net_before) * h).abs();
        }
        self.turned_over += work.iter().map(|p| p.abs()).sum::<f64>() * h;
        self.last = Some([stored, net]);
    }
}

/// The open share of the books of a pushed arm in which the effect counts `counted` times: its
/// torque, its masses, its tilt, its winding. The motion is that of the effect as it is.
fn open_share(effect: &'static dyn Effect, counted: f64) -> f64 {
    let h = if gives_way(effect) { ELASTIC_STEP_S } else { STEP_S };
    let (mut driven, nominal) = (Driven::pushed(PUSH, Some(effect), h), arm());
    let mut friction = [JointLoad::default(); 6];
    add_friction(&mut friction);
    let count = |without: f64, with: f64| without + counted * (with - without);
    let (mut books, mut gears) = (Books::default(), Gears::default());
    for _ in 0..(SECONDS / h) as usize {
        let now = driven.step();
        let energy = |mechanism| stored(mechanism, [&now.q, &now.v], [&now.link_q, &now.link_v]);
        let with = by_loads(&now, &now.loads) + by_gears(&now, &driven.mechanism, &mut gears, h);
        books.enter(
            count(energy(&nominal), energy(&driven.mechanism)),
            std::array::from_fn(|j| now.tau[j] * now.v[j]),
            count(by_loads(&now, &friction), with),
            h,
        );
    }
    books.open / books.turned_over
}

/// W
fn by_loads(now: &Instant, loads: &[JointLoad; 6]) -> f64 {
    loads.iter().zip(now.v).map(|(load, v)| taken(load, v)).sum()
}

/// W
fn by_gears(now: &Instant, mechanism: &Mechanism, gears: &mut Gears, h: f64) -> f64 {
    let heat = |(j, law): (usize, &Option<Transmission>)| {
        let wind_up = [now.q[j] - now.link_q[j], now.v[j] - now.link_v[j]];
        law.map_or(0.0, |law| gears.loss(j, &law, wind_up, h))
    };
    mechanism.transmission.iter().enumerate().map(heat).sum()
}

/// Share of what the motors turn over that may stay open; measured: up to 3.7e-5.
const OPEN: f64 = 5e-5;

/// Every effect that loads joints, has mass, turns gravity or gives way. Books that count it a
/// quarter too low stay open by more than twice as much.
#[test]
fn work_of_the_motors_is_stored_or_taken_by_the_effect() {
    let effects: Vec<_> = CATALOGUE.iter().copied().filter(|e| acts(*e)).collect();
    assert!(effects.len() >= 22, "{}", effects.len());
    for effect in effects {
        let name = effect.about().name;
        let (open, wrong) = (open_share(effect, 1.0), open_share(effect, 0.75));
        assert!(open < OPEN, "{name}: {open} is open");
        assert!(wrong > 2.0 * OPEN, "{name}: {wrong} is open where it counts a quarter too low");
    }
}

/// J^T F takes what the force does not give along the flange's path: -F (x1 - x0).
#[test]
fn a_contact_works_along_the_path_of_the_flange() {
    let contact = find("external_contact").unwrap();
    let mut driven = Driven::new(Some(contact), STEP_S);
    let instants: Vec<Instant> = (0..(SECONDS / STEP_S) as usize).map(|_| driven.step()).collect();
    let power = |now: &Instant| (0..6).map(|j| now.loads[j].torque * now.v[j]).sum::<f64>();
    let between = |w: &[Instant]| 0.5 * (power(&w[0]) + power(&w[1])) * STEP_S;
    let taken: f64 = instants.windows(2).map(between).sum();
    let at = |k: usize| flange_placement(&driven.mechanism.robot, &instants[k].q).translation;
    let path = at(instants.len() - 1) - at(0);
    let force = |axis: usize| contact.about().parameters[axis].typical;
    let given: f64 = (0..3).map(|axis| force(axis) * path[axis]).sum();
    assert!(given.abs() > 1.0 && (taken + given).abs() < 1e-3 * given.abs(), "{given} {taken}");
}
