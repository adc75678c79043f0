//! Arms and motions on which effects are explained and injected.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::robot::{
    Body, Inertia, Joint, Limits, Placement, Servo, Told, inverse_dynamics_series, servo,
};

/// A chain of `dof` joints with random masses, axes and offsets.
pub fn random_arm(dof: usize, rng: &mut ChaCha8Rng) -> Robot {
    let mut vector = |scale: f64| {
        Vector3::from_fn(|_, _| scale * rng.random_range(-1.0..1.0)) + Vector3::x() * 0.1
    };
    let limits = Limits { lower: -3.0, upper: 3.0, velocity: 3.0, effort: 100.0 };
    let mut body = |j: usize| Body {
        name: format!("body{j}"),
        parent: j.checked_sub(1),
        joint: Joint {
            name: format!("joint{j}"),
            placement: Placement {
                rotation: Rotation3::new(vector(1.0)).into_inner(),
                translation: vector(0.4),
            },
            axis: Unit::new_normalize(vector(1.0)),
            limits,
        },
        inertia: Inertia {
            mass: 2.0 + j as f64,
            com: vector(0.2),
            about_com: Matrix3::from_diagonal(&Vector3::new(0.02, 0.03, 0.04)),
        },
    };
    let bodies = (0..dof).map(&mut body).collect();
    let flange = Placement {
        rotation: Rotation3::new(Vector3::new(0.3, -0.4, 0.5)).into_inner(),
        translation: Vector3::new(0.05, -0.02, 0.1),
    };
    Robot {
        name: "random".into(),
        bodies,
        gravity: Vector3::new(0.1, 0.2, -9.81),
        flange,
        flange_on: None,
    }
}

/// One joint about y, so that gravity pulls on what lies along x; 3 kg at 0.4 m; flange at 0.5 m.
pub fn pendulum() -> Robot {
    let mut arm = random_arm(1, &mut ChaCha8Rng::seed_from_u64(0));
    let body = &mut arm.bodies[0];
    body.joint.placement = Placement::identity();
    body.joint.axis = Unit::new_normalize(-Vector3::y());
    body.inertia =
        Inertia { mass: 3.0, com: Vector3::x() * 0.4, about_com: Matrix3::identity() * 0.01 };
    arm.gravity = Vector3::new(0.0, 0.0, -9.81);
    arm.flange = Placement { rotation: Matrix3::identity(), translation: Vector3::x() * 0.5 };
    arm
}

/// Servos of 5 N.m told to be 0.1 rad ahead and to go on at 0.5 rad/s; they are off in the first samples of many.
fn told(q: &JointSeries, qd: &JointSeries) -> Told {
    let mut servo = Servo::new(vec![20.0; q.joints()]);
    servo.max_torque.fill(5.0);
    let ahead = |q: &[f64]| -> Vec<f64> {
        q.iter().enumerate().map(|(k, q)| q + 0.1 + 0.5 * DT * k as f64).collect()
    };
    let on = |q: &[f64]| (0..q.len()).map(|k| if k + 50 < q.len() { 0.0 } else { 1.0 }).collect();
    let powered = Some(q.map_joints(|_, q| on(q)));
    let settings = servo::Settings { register: None, powered };
    servo.told(q.map_joints(|_, q| ahead(q)), q, qd, &settings, DT).0
}

/// Temperature of every joint, deg C.
const TEMPERATURE_C: f64 = 45.0;
pub const DT: f64 = 0.02;

pub struct Samples {
    pub robot: Robot,
    pub q: JointSeries,
    pub qd: JointSeries,
    pub qdd: JointSeries,
    pub temperature: JointSeries,
    /// What servos of 20 N.m/rad and 5 N.m were told; at first without power.
    pub told: Told,
}

impl Samples {
    /// Three joints that swing from rest; velocities are backward differences of the angles.
    pub fn random(seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let robot = random_arm(3, &mut rng);
        let mut swing = |_| {
            let [start, size] = [3.0, 1.0].map(|scale| scale * rng.random_range(-1.0..1.0));
            let rate = rng.random_range(1.0..4.0);
            (0..60).map(|k| start + size * (1.0 - (rate * k as f64 * DT).cos())).collect()
        };
        Self::along(robot, JointSeries::from_joints(&[0, 1, 2].map(&mut swing)))
    }

    pub fn along(robot: Robot, q: JointSeries) -> Self {
        let backward = |x: &JointSeries| {
            x.map_joints(|_, x| (0..x.len()).map(|k| (x[k] - x[k.max(1) - 1]) / DT).collect())
        };
        let (qd, temperature) = (backward(&q), q.map_joints(|_, q| vec![TEMPERATURE_C; q.len()]));
        let told = told(&q, &qd);
        Self { robot, qdd: backward(&qd), q, qd, temperature, told }
    }

    /// The pendulum through q, qd, qdd, one row per sample.
    pub fn rows(rows: &[[f64; 3]]) -> Self {
        let series = |i: usize| JointSeries::from_joints(&[rows.iter().map(|r| r[i]).collect()]);
        let temperature = JointSeries::from_joints(&[vec![TEMPERATURE_C; rows.len()]]);
        let [q, qd, qdd] = [0, 1, 2].map(series);
        let told = told(&q, &qd);
        Self { robot: pendulum(), q, qd, qdd, temperature, told }
    }

    /// The first `n` samples.
    pub fn first(self, n: usize) -> Self {
        let cut = |x: &JointSeries| x.map_joints(|_, x| x[..n].to_vec());
        let Self { robot, q, qd, qdd, temperature, .. } = self;
        let (q, qd) = (cut(&q), cut(&qd));
        let told = told(&q, &qd);
        Self { robot, qdd: cut(&qdd), temperature: cut(&temperature), told, q, qd }
    }

    pub fn motion(&self) -> Motion<'_> {
        let motion = Motion::new(&self.robot, DT, &self.q, &self.qd, &self.qdd);
        Motion { temperature: Some(&self.temperature), told: Some(&self.told), ..motion }
    }

    /// Torque at every joint that the values of joint `from` (or of the whole arm) explain, N.m.
    pub fn explained(&self, effect: &dyn Effect, values: &[f64], from: usize) -> JointSeries {
        let (linear, nonlinear) = values.split_at(linear_count(effect));
        let (motion, n) = (self.motion(), self.q.samples());
        let mut sum = JointSeries::zeros(self.robot.dof(), n);
        let mut add = |joint: usize, columns: Vec<Vec<f64>>| {
            assert_eq!(columns.len(), linear.len(), "{}", effect.about().name);
            for (column, value) in columns.iter().zip(linear) {
                assert_eq!(column.len(), n, "{}", effect.about().name);
                sum.joint_mut(joint).iter_mut().zip(column).for_each(|(s, c)| *s += c * value);
            }
        };
        match effect.about().scope {
            Scope::Joint => add(from, effect.columns(&motion, from, nonlinear)),
            Scope::Arm => (0..self.robot.dof())
                .for_each(|joint| add(joint, effect.columns(&motion, joint, nonlinear))),
            Scope::Link => {
                let reach = effect.reach(&motion, from, nonlinear);
                for joint in 0..self.robot.dof() {
                    add(joint, reach.iter().map(|s| s.joint(joint).to_vec()).collect());
                }
                let own = effect.columns(&motion, from, nonlinear);
                let same = own.iter().zip(&reach).all(|(c, s)| c == s.joint(from));
                assert!(same, "{}", effect.about().name);
            }
        }
        sum
    }

    /// What `build` and `act` make the drives supply while the joints slide.
    pub fn injected(&self, effect: &dyn Effect, values: &[f64], from: usize) -> JointSeries {
        let mut mechanism = Mechanism::new(self.robot.clone());
        effect.build(values, from, &mut mechanism);
        let true_q =
            self.q.map_joints(|j, q| q.iter().map(|q| q - mechanism.encoder_zero[j]).collect());
        let before = inverse_dynamics_series(&self.robot, &self.q, &self.qd, &self.qdd);
        let after = inverse_dynamics_series(&mechanism.robot, &true_q, &self.qd, &self.qdd);
        let added = |joint: usize, after: &[f64]| {
            let acts = joint == from || effect.about().scope == Scope::Arm;
            let acting = match acts {
                true => self.acting(effect, values, joint, &before),
                false => vec![0.0; after.len()],
            };
            let armature = mechanism.armature[joint];
            let torque = (0..after.len())
                .map(|k| after[k] + acting[k] + armature * self.qdd.joint(joint)[k])
                .map(|torque| mechanism.torque_gain[joint] * torque);
            torque.zip(before.joint(joint)).map(|(after, before)| after - before).collect()
        };
        after.map_joints(added)
    }

    /// What `act` makes the drive of one joint supply while it slides.
    pub fn acting(
        &self,
        effect: &dyn Effect,
        values: &[f64],
        joint: usize,
        carried: &JointSeries,
    ) -> Vec<f64> {
        let mut memory = vec![0.0; effect.about().memory];
        let step = |k: usize| {
            let at = |series: &JointSeries| sample(series, k);
            let arm = ArmState {
                robot: &self.robot,
                time: DT * k as f64,
                dt: DT,
                q: &at(&self.q),
                qd: &at(&self.qd),
                transmitted: &at(carried),
                temperature: &at(&self.temperature),
            };
            let mut load = JointLoad::default();
            effect.act(values, &arm.joint(joint), &mut memory, &mut load);
            let qd = self.qd.joint(joint)[k];
            load.dry * coulomb::sign(qd) + load.damping * qd + load.torque
        };
        (0..self.q.samples()).map(step).collect()
    }
}

fn sample(series: &JointSeries, k: usize) -> Vec<f64> {
    let mut values = vec![0.0; series.joints()];
    series.sample_into(k, &mut values);
    values
}
