//! Effects in rapier against Runge-Kutta twins that share nothing with it, and their energy books.

use nalgebra::{DMatrix, DVector};

use super::*;
use crate::effects::{
    ArmState, CATALOGUE, Effect, JointLoad, Mechanism, Role, Scope, Transmission,
};
use crate::robot::{Workspace, builtin, energy, inverse_dynamics, mass_matrix};

const ROTORS: [f64; 6] = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14];
const VISCOUS: [f64; 6] = [8.0, 10.0, 7.0, 1.5, 1.2, 1.0];
/// Below this nothing that lowers dry friction may fall.
const COULOMB: [f64; 6] = [3.0, 3.0, 2.0, 0.6, 0.5, 0.4];
const TORQUE: [f64; 6] = [40.0, 40.0, 25.0, 8.0, 7.0, 5.0];
const HANGING: [f64; 6] = [0.0, 1.57, 0.0, 0.0, 0.0, 0.0];
const STILL: [f64; 6] = [0.0; 6];

/// N.m, a different swing at every joint.
fn push(t: f64) -> [f64; 6] {
    std::array::from_fn(|j| TORQUE[j] * ((2.0 + 0.7 * j as f64) * t).sin())
}

fn arm() -> Mechanism {
    Mechanism::with_armature(builtin("ur5").unwrap(), ROTORS.to_vec())
}

/// The effect at every joint, weaker at the wrist, or nothing.
fn injected(effect: Option<&'static dyn Effect>) -> (Mechanism, Injections) {
    let values = |effect: &dyn Effect, joint: usize| {
        let share = if effect.about().scope == Scope::Joint && joint > 2 { 0.2 } else { 1.0 };
        let value = |p: &crate::effects::Parameter| match p.role {
            Role::Linear => share * p.typical,
            Role::Nonlinear => p.typical,
        };
        effect.about().parameters.iter().map(value).collect::<Vec<f64>>()
    };
    let injection = |effect: &'static dyn Effect| Injection {
        effect,
        joints: (0..6).collect(),
        values: (0..6).map(|j| values(effect, j)).collect(),
    };
    let injections = Injections::new(&effect.map(injection).into_iter().collect::<Vec<_>>());
    let mut mechanism = arm();
    injections.build(&mut mechanism);
    (mechanism, injections)
}

fn loads_at(
    injections: &mut Injections,
    mechanism: &Mechanism,
    [time, dt]: [f64; 2],
    [q, qd]: [&[f64]; 2],
    loads: &mut [JointLoad],
) {
    let state = ArmState {
        robot: &mechanism.robot,
        time,
        dt,
        q,
        qd,
        transmitted: &STILL,
        temperature: &[45.0; 6],
    };
    injections.loads(&state, loads);
    for (j, load) in loads.iter_mut().enumerate() {
        load.dry += COULOMB[j];
        load.damping += VISCOUS[j];
    }
}

/// Joint angles after 1.5 s by Runge-Kutta and by rapier.
fn both(effect: Option<&'static dyn Effect>) -> [Vec<f64>; 2] {
    let (seconds, h) = (1.5, 2.5e-4);
    let (mechanism, mut injections) = injected(effect);
    let mut reference = Reference::new(mechanism.clone(), &HANGING);
    let forces = &mut |t: f64, q: &[f64], v: &[f64], tau: &mut [f64], loads: &mut [JointLoad]| {
        tau.copy_from_slice(&push(t));
        loads_at(&mut injections, &mechanism, [t, h], [q, v], loads);
    };
    (0..(seconds / h) as usize).for_each(|_| reference.step(h, forces));

    let (mechanism, mut injections) = injected(effect);
    let mut plant = Plant::new(&mechanism, h).unwrap();
    plant.set_state(&HANGING, &STILL);
    let mut loads = [JointLoad::default(); 6];
    for k in 0..(seconds / h) as usize {
        let t = k as f64 * h;
        loads_at(&mut injections, &mechanism, [t, h], [plant.q(), plant.v()], &mut loads);
        plant.step(&push(t), &loads);
    }
    [reference.q().to_vec(), plant.q().to_vec()]
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Does the effect act on the rigid arm as a function of its state alone?
fn acts_by_state(effect: &'static dyn Effect) -> bool {
    let (mechanism, mut injections) = injected(Some(effect));
    let mut loads = [JointLoad::default(); 6];
    loads_at(&mut injections, &mechanism, [0.5, 1e-3], [&HANGING, &[0.3; 6]], &mut loads);
    let friction = |j: usize| JointLoad { dry: COULOMB[j], damping: VISCOUS[j], torque: 0.0 };
    let acts = loads.iter().enumerate().any(|(j, load)| *load != friction(j));
    let (nominal, elastic) = (arm(), mechanism.transmission.iter().any(Option::is_some));
    let built = mechanism.robot != nominal.robot || mechanism.armature != nominal.armature;
    effect.about().memory == 0 && !elastic && (acts || built)
}

/// What an effect does to the arm is the same in both, up to a share of it and to what they differ
/// by without it.
#[test]
fn effects_move_the_arm_as_runge_kutta_says() {
    let [without, rapier] = both(None);
    let usual = apart(&without, &rapier);
    let effects: Vec<_> = CATALOGUE.iter().copied().filter(|e| acts_by_state(*e)).collect();
    assert!(effects.len() >= 13, "{}", effects.len());
    for effect in effects {
        let [reference, rapier] = both(Some(effect));
        let (moved, error) = (apart(&reference, &without), apart(&reference, &rapier));
        let name = effect.about().name;
        assert!(moved > 1e-3, "{name} moves the arm by {moved} rad only");
        assert!(error < 0.03 * moved + 2.0 * usual, "{name}: {error} of {moved} rad, {usual}");
    }
}

/// Every joint on the same transmission, weaker at the wrist.
fn elastic(law: Transmission) -> Mechanism {
    let mut mechanism = arm();
    for (j, slot) in mechanism.transmission.iter_mut().enumerate() {
        let share = if j > 2 { 0.2 } else { 1.0 };
        *slot = Some(Transmission {
            stiffness: share * law.stiffness,
            hardening: share * law.hardening,
            damping: share * law.damping,
            hysteresis: share * law.hysteresis,
            ..law
        });
    }
    mechanism
}

/// Motors, links and bristles: q_m, v_m, q_l, v_l, z below each other.
struct TwoMasses {
    mechanism: Mechanism,
    workspace: Workspace,
}

impl TwoMasses {
    fn start(&mut self) -> DVector<f64> {
        let mut carried = vec![0.0; 6];
        let robot = &self.mechanism.robot;
        crate::robot::gravity_torque(robot, &mut self.workspace, &HANGING, &mut carried);
        let law = |j: usize| self.mechanism.transmission[j].unwrap();
        let mut state = DVector::zeros(30);
        for j in 0..6 {
            state[j] = HANGING[j];
            state[12 + j] = HANGING[j] - law(j).wind_up(carried[j]);
        }
        state
    }

    fn slope(&mut self, t: f64, s: &DVector<f64>) -> DVector<f64> {
        let part = |i: usize| s.as_slice()[6 * i..6 * i + 6].to_vec();
        let (vm, ql, vl) = (part(1), part(2), part(3));
        let mut bias = vec![0.0; 6];
        let robot = &self.mechanism.robot;
        inverse_dynamics(robot, &mut self.workspace, &ql, &vl, &STILL, &mut bias);
        let m: DMatrix<f64> = mass_matrix(robot, &mut self.workspace, &ql);
        let (push, mut slope) = (push(t), DVector::zeros(30));
        let mut on_links = DVector::zeros(6);
        for j in 0..6 {
            let law = self.mechanism.transmission[j].unwrap();
            let (w, rate, z) = (s[j] - ql[j], vm[j] - vl[j], s[24 + j]);
            let torque = law.torque(w) + law.damping_at(w) * rate + law.hysteresis * z;
            slope[j] = vm[j];
            slope[6 + j] = (push[j] - VISCOUS[j] * vm[j] - torque) / ROTORS[j];
            slope[12 + j] = vl[j];
            on_links[j] = torque - bias[j];
            if law.hysteresis > 0.0 {
                slope[24 + j] = rate * (1.0 - z * rate.signum()) / law.hysteresis_width;
            }
        }
        let a = m.cholesky().unwrap().solve(&on_links);
        slope.rows_mut(18, 6).copy_from(&a);
        slope
    }

    fn run(mut self, seconds: f64, h: f64) -> DVector<f64> {
        let mut s = self.start();
        for k in 0..(seconds / h).round() as usize {
            let t = k as f64 * h;
            let k1 = self.slope(t, &s);
            let k2 = self.slope(t + 0.5 * h, &(&s + &k1 * (0.5 * h)));
            let k3 = self.slope(t + 0.5 * h, &(&s + &k2 * (0.5 * h)));
            let k4 = self.slope(t + h, &(&s + &k3 * h));
            s += (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0);
        }
        s
    }
}

/// J: what a wound-up transmission gives back.
fn spring(law: &Transmission, w: f64) -> f64 {
    let x = w - w.clamp(-0.5 * law.gap, 0.5 * law.gap);
    0.5 * law.stiffness * x * x + 0.25 * law.hardening * x.powi(4)
}

fn stored(mechanism: &Mechanism, plant: &Plant) -> f64 {
    let [ql, vl, _] = plant.link_motion();
    let links = energy(&mechanism.robot, &mut Workspace::new(&mechanism.robot), ql, vl).total();
    let of_motor = |j: usize| {
        let law = mechanism.transmission[j].unwrap();
        0.5 * ROTORS[j] * plant.v()[j].powi(2) + spring(&law, plant.q()[j] - ql[j])
    };
    links + (0..6).map(of_motor).sum::<f64>()
}

/// Elastic, hardening, with hysteresis, slack: rapier against Runge-Kutta, and the energy books.
#[test]
fn transmissions_wind_up_as_runge_kutta_says_and_keep_their_books() {
    let soft = Transmission { stiffness: 8000.0, damping: 20.0, ..Transmission::default() };
    let laws = [
        ("elastic", soft),
        ("hardening", Transmission { hardening: 1e8, ..soft }),
        ("hysteresis", Transmission { hysteresis: 5.0, hysteresis_width: 2e-3, ..soft }),
        ("slack", Transmission { gap: 2e-3, ..soft }),
    ];
    let (seconds, h) = (1.0, 1e-4);
    for (name, law) in laws {
        let mechanism = elastic(law);
        let workspace = Workspace::new(&mechanism.robot);
        let twin = TwoMasses { mechanism: mechanism.clone(), workspace }.run(seconds, 0.2 * h);
        let mut plant = Plant::new(&mechanism, h).unwrap();
        plant.set_state(&HANGING, &STILL);
        let (mut work, mut heat, mut wound) = (0.0, 0.0, [0.0; 6]);
        let mut bristles = [0.0; 6];
        let before = stored(&mechanism, &plant);
        for k in 0..(seconds / h).round() as usize {
            let tau = push(k as f64 * h);
            let loads = VISCOUS.map(|damping| JointLoad { damping, ..JointLoad::default() });
            let [ql, vl, _] = plant.link_motion().map(<[f64]>::to_vec);
            let qm = plant.q().to_vec();
            plant.step(&tau, &loads);
            for j in 0..6 {
                let law = mechanism.transmission[j].unwrap();
                let (v, link) = (plant.v_mid()[j], 0.5 * (vl[j] + plant.link_motion()[1][j]));
                work += tau[j] * v * h;
                bristles[j] = law.bent(bristles[j], (v - link) * h);
                heat += VISCOUS[j] * v * v * h
                    + law.damping_at(qm[j] - ql[j]) * (v - link).powi(2) * h
                    + law.hysteresis * bristles[j] * (v - link) * h;
                wound[j] = f64::max(wound[j], (qm[j] - ql[j]).abs());
            }
        }
        let gained = stored(&mechanism, &plant) - before;
        let open = (work - gained - heat).abs() / (gained.abs() + heat);
        assert!(heat > 1.0 && open < 5e-3, "{name}: {work} J, {gained} J and {heat} J");
        let largest = wound.iter().fold(0.0, |m: f64, w| m.max(*w));
        for (j, wound) in wound.iter().enumerate() {
            let w = plant.q()[j] - plant.link_motion()[0][j];
            let expected = twin[j] - twin[12 + j];
            let error = (w - expected).abs();
            assert!(error < 0.05 * wound + 0.01 * largest, "{name} {j}: {w} {expected} {wound}");
        }
        let moved = apart(&twin.as_slice()[..6], &HANGING);
        let error = apart(&twin.as_slice()[..6], plant.q());
        assert!(error < 5e-3 * moved, "{name}: {error} of {moved} rad");
    }
}
