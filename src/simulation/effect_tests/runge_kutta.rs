//! Rigid arms with an effect: rapier against Runge-Kutta.

use super::driven::Driven;
use super::*;

const SECONDS: f64 = 1.5;
const STEP_S: f64 = 2.5e-4;

/// What acts at the stages of a Runge-Kutta step. Effects with memory move on from the start of the
/// step by what the arm turned since, over which their laws are solved exactly (LuGre's at the mean
/// speed): at every stage their torque is a function of time and state alone, as Runge-Kutta needs.
struct Stages {
    mechanism: Mechanism,
    /// As they are at the start of the step.
    injections: Injections,
    temperature: [f64; 6],
    time: f64,
    q: Vec<f64>,
}

impl Stages {
    fn new(effect: Option<&'static dyn Effect>) -> Self {
        let (mechanism, injections) = injected(effect);
        let temperature = [THERMAL.start_c; 6];
        Self { mechanism, injections, temperature, time: 0.0, q: HANGING.to_vec() }
    }

    /// Fills in the loads; the effects as they are then.
    fn loads(&self, time: f64, q: &[f64], v: &[f64], loads: &mut [JointLoad]) -> Injections {
        let mut effects = self.injections.clone();
        let dt = time - self.time;
        if dt > 0.0 {
            let mean: Vec<f64> = q.iter().zip(&self.q).map(|(q, from)| (q - from) / dt).collect();
            effects.loads(&self.state(self.time, dt, q, &mean), loads);
        }
        effects.loads(&self.state(time, 0.0, q, v), loads);
        add_friction(loads);
        effects
    }

    fn state<'a>(&'a self, time: f64, dt: f64, q: &'a [f64], qd: &'a [f64]) -> ArmState<'a> {
        let (robot, temperature) = (&self.mechanism.robot, &self.temperature);
        ArmState { robot, time, dt, q, qd, transmitted: &STILL, temperature }
    }

    /// The next step starts where `arm` is.
    fn arrive(&mut self, arm: &Reference) {
        let mut loads = [JointLoad::default(); 6];
        self.injections = self.loads(arm.time(), arm.q(), arm.v(), &mut loads);
        THERMAL.advance(&mut self.temperature, &loads, arm.v(), arm.time() - self.time);
        (self.time, self.q) = (arm.time(), arm.q().to_vec());
    }
}

/// Joint angles at the end.
fn by_runge_kutta(effect: Option<&'static dyn Effect>) -> Vec<f64> {
    let mut stages = Stages::new(effect);
    let mut arm = Reference::new(stages.mechanism.clone(), &HANGING);
    for _ in 0..(SECONDS / STEP_S) as usize {
        let forces =
            &mut |t: f64, q: &[f64], v: &[f64], tau: &mut [f64], loads: &mut [JointLoad]| {
                tau.copy_from_slice(&push(t));
                stages.loads(t, q, v, loads);
            };
        arm.step(STEP_S, forces);
        stages.arrive(&arm);
    }
    arm.q().to_vec()
}

fn by_rapier(effect: Option<&'static dyn Effect>) -> Vec<f64> {
    let mut arm = Driven::new(effect, STEP_S);
    for _ in 0..(SECONDS / STEP_S) as usize {
        arm.step();
    }
    arm.plant.q().to_vec()
}

/// What an effect does to the arm is the same in both, up to a thousandth of it and twice what they
/// differ by without it. Measured: 3.7e-4 rad without any; 2.2, 2.2, 1.8, 3.7 and 7.1e-4 rad with
/// presliding, LuGre, Maxwell-slip, a cable and friction that follows heat, which move it by 0.25 to
/// 0.8 rad. Of friction that follows what the gears carry Runge-Kutta's stages know nothing; elastic
/// and slack joints have a twin of their own (`transmissions`).
#[test]
fn effects_move_the_arm_as_runge_kutta_says() {
    let (without, rapier) = (by_runge_kutta(None), by_rapier(None));
    let usual = apart(&without, &rapier);
    let moves =
        |e: &&'static dyn Effect| !gives_way(*e) && (loads_joints(*e, 0.0) || changes_masses(*e));
    let effects: Vec<_> = CATALOGUE.iter().copied().filter(moves).collect();
    let remembering = effects.iter().filter(|e| e.about().memory > 0).count();
    assert!(effects.len() >= 19 && remembering >= 4, "{} {remembering}", effects.len());
    for effect in effects {
        let (reference, rapier) = (by_runge_kutta(Some(effect)), by_rapier(Some(effect)));
        let (moved, error) = (apart(&reference, &without), apart(&reference, &rapier));
        let name = effect.about().name;
        assert!(moved > 1e-3, "{name} moves the arm by {moved} rad only");
        assert!(error < 1e-3 * moved + 2.0 * usual, "{name}: {error} of {moved} rad, {usual}");
    }
}
