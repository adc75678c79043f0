//! Does every joint slide through the coming step, so that dry friction is at its level everywhere?
//!
//! Then the solver's first sweep over the friction constraints puts each at its level, all others
//! find it there, and one sweep does to the last bit what sixteen do.
//!
//! A joint slides through if the others' friction cannot stop it while the sweep passes. Rotor
//! inertia J bounds what torques tau at other joints do to joint j: M is no less than diag(J), hence
//! |(M^-1 tau)_j| <= J_j^(-1/2) sum_i J_i^(-1/2) |tau_i|.

use crate::effects::{JointLoad, Mechanism};

/// For what the bound leaves out: Coriolis and gravity torques change little in a step.
const MARGIN: f64 = 1.5;

pub struct Sliding {
    /// J^(-1/2) per joint; infinite where there is no bound, and the answer always no.
    agility: Vec<f64>,
    /// Torque less friction in the last step, N.m; NaN where there was none.
    driven: Vec<f64>,
}

impl Sliding {
    pub fn new(mechanism: &Mechanism) -> Self {
        let rigid = mechanism.transmission.iter().all(Option::is_none);
        let agility = |j: &f64| if rigid { 1.0 / j.sqrt() } else { f64::INFINITY };
        Self {
            agility: mechanism.armature.iter().map(agility).collect(),
            driven: vec![f64::NAN; mechanism.armature.len()],
        }
    }

    /// After a jump of the state.
    pub fn forget(&mut self) {
        self.driven.fill(f64::NAN);
    }

    /// To be asked at every step of length `step_s`, of the motion so far (rad/s, rad/s^2) and of
    /// `torque` (N.m, without dry friction) and `loads` of this step.
    pub fn everywhere(
        &mut self,
        [v, a]: [&[f64]; 2],
        torque: &[f64],
        loads: &[JointLoad],
        step_s: f64,
    ) -> bool {
        let mut reach = 0.0;
        for (j, load) in loads.iter().enumerate() {
            let dry = load.dry.max(0.0);
            let driven = torque[j] - v[j].signum() * dry;
            reach += self.agility[j] * (dry + (driven - self.driven[j]).abs());
            self.driven[j] = driven;
        }
        let slides =
            |j: usize| v[j].abs() > MARGIN * step_s * (a[j].abs() + self.agility[j] * reach);
        (0..loads.len()).all(|j| loads[j].dry <= 0.0 || slides(j))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::builtin;
    use crate::simulation::Plant;
    use crate::simulation::accuracy::{Bench, Friction};

    const STEP_S: f64 = 5e-4;

    /// Velocities at all steps while the joints are pushed to and fro, and the share of steps in
    /// which all of them slide.
    fn pushed(sweeps: usize, rotor: f64) -> (Vec<u64>, f64) {
        let mut bench = Bench::new(builtin("ur5").unwrap(), Friction { dry: 1.0, viscous: 1.0 });
        bench.mechanism.armature.fill(rotor);
        let mut plant = Plant::new(&bench.mechanism, STEP_S).unwrap();
        plant.sliding_sweeps = sweeps;
        plant.set_state(&[0.0, -1.6, 0.3, 0.0, 0.4, 0.0], &[1.0, -0.5, 0.8, 1.0, -1.0, 1.2]);
        let mut sliding = Sliding::new(&bench.mechanism);
        let mut loads = [JointLoad::default(); 6];
        let (mut bits, mut slid) = (Vec::new(), 0);
        for k in 0..6000 {
            let push = |j: usize| (f64::from(k) * STEP_S * (1.1 + 0.3 * j as f64)).cos();
            let tau: [f64; 6] =
                std::array::from_fn(|j| [30.0, 50.0, 30.0, 6.0, 6.0, 5.0][j] * push(j));
            bench.loads(plant.v(), &mut loads);
            let net: [f64; 6] =
                std::array::from_fn(|j| tau[j] - 0.5 * loads[j].damping * plant.v()[j]);
            slid += usize::from(sliding.everywhere([plant.v(), plant.a()], &net, &loads, STEP_S));
            plant.step(&tau, &loads);
            bits.extend(plant.v().iter().map(|v| v.to_bits()));
        }
        (bits, slid as f64 / 6000.0)
    }

    #[test]
    fn one_sweep_is_exact_where_every_joint_slides() {
        for rotor in [0.14, 1.1] {
            let ((one, slid), (sixteen, _)) = (pushed(1, rotor), pushed(16, rotor));
            assert!((0.2..0.95).contains(&slid), "{slid}");
            assert!(one == sixteen);
        }
    }

    #[test]
    fn without_rotor_inertia_nothing_is_certain() {
        assert_eq!(pushed(1, 0.0).1, 0.0);
    }
}
