//! Transmissions that give way: rapier against two masses on a spring by Runge-Kutta.

use nalgebra::{DMatrix, DVector};

use super::books::{Gears, stored};
use super::*;
use crate::effects::Transmission;
use crate::robot::{Workspace, inverse_dynamics, mass_matrix};

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
        let mut gears = Gears::default();
        let end = |plant: &Plant| {
            let [ql, vl, _] = plant.link_motion();
            stored(&mechanism, [plant.q(), plant.v()], [ql, vl])
        };
        let before = end(&plant);
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
                heat += VISCOUS[j] * v * v * h;
                heat += gears.loss(j, &law, [qm[j] - ql[j], v - link], h) * h;
                wound[j] = f64::max(wound[j], (qm[j] - ql[j]).abs());
            }
        }
        let gained = end(&plant) - before;
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
