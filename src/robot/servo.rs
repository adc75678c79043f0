//! A position servo: a motor that is told an angle, and what torque it then gives.
//!
//! ```text
//! tau = clip(K dead_zone(c(t - d) + o - q, w), -limit, limit) - B qd      while it is powered
//! ```
//!
//! The servo turns the difference e of command and position into a share of its supply voltage, at most
//! all of it; a motor of resistance R gives k V / R less the k^2 qd / R of its own voltage. So K is the
//! gain register's share of voltage per radian times the torque at standstill, which grows with the
//! supply, and B does not.

use super::RobotError;
use crate::series::{JointSeries, at_place};

/// No servo is stiffer or stronger, nor its inverse, N.m/rad and N.m.
const LARGEST: f64 = 1e9;
/// Longest delay of a command, s, and widest dead band, rad, that are no slip of units.
const LONGEST_S: f64 = 1.0;
const WIDEST_RAD: f64 = 1.0;

/// One entry per joint, base to wrist.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Servo {
    /// K, N.m/rad, at the gain register in `register`.
    pub gain: Vec<f64>,
    /// Value of the gain register that `gain` is for; recordings may say another one.
    pub register: Option<Vec<f64>>,
    /// B, N.m.s/rad at the joint: the motor's own voltage.
    pub damping: Vec<f64>,
    /// mu: dry friction of the gear, as a share of the motor's torque.
    #[serde(default)]
    pub friction: Vec<f64>,
    /// Torque at standstill with all of the supply, N.m; infinite is unlimited.
    #[serde(with = "unlimited")]
    pub max_torque: Vec<f64>,
    /// w, rad to either side of the command.
    pub dead_band: Vec<f64>,
    /// d, s: how long a command takes to arrive.
    pub delay: Vec<f64>,
    /// o, rad: the command as the servo takes it less as it was recorded.
    pub offset: Vec<f64>,
}

/// Infinite limits: JSON has no such number, so that they are null there.
mod unlimited {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(limits: &[f64], to: S) -> Result<S::Ok, S::Error> {
        let finite: Vec<Option<f64>> =
            limits.iter().map(|l| Some(*l).filter(|l| l.is_finite())).collect();
        finite.serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
        let limits = Vec::<Option<f64>>::deserialize(from)?;
        Ok(limits.into_iter().map(|l| l.unwrap_or(f64::INFINITY)).collect())
    }
}

/// What servos were told and made of it, at uniform instants.
#[derive(Debug, Clone, PartialEq)]
pub struct Told {
    /// s
    pub dt: f64,
    /// Command as it was noted, rad.
    pub command: JointSeries,
    /// By how much later than noted it was sent beside the position, s: what a logger notes in one row is not of one instant.
    pub late: f64,
    /// Command as it arrived, with offset, less position, rad.
    pub error: JointSeries,
    /// Torque of the position loop were there no limit, N.m.
    pub asked: JointSeries,
    /// Torque of the position loop, N.m.
    pub pull: JointSeries,
    /// Its slope over the error, N.m/rad: 0 where the servo is off, in its dead band or at its limit.
    pub slope: JointSeries,
    /// 1 where the servo is powered, else 0.
    pub powered: JointSeries,
    /// Gain, N.m/rad; 0 where the servo is off.
    pub gain: JointSeries,
    /// Largest torque of the position loop at each joint, N.m; infinite is unlimited.
    pub limit: Vec<f64>,
    /// Position as recorded, rad.
    pub q: JointSeries,
    /// False in gaps of the recording.
    pub recorded: Vec<bool>,
    /// Smallest step between recorded positions, rad per joint: what the encoder resolves.
    pub resolution: Vec<f64>,
}

impl Told {
    /// The command at joint `j` as it arrives, `delay` seconds after it was sent, rad.
    pub fn arrived(&self, j: usize, delay: f64) -> Vec<f64> {
        arrived(self.command.joint(j), self.late + delay, self.dt)
    }
}

/// What recordings say of servos from sample to sample, beside command and position.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Settings {
    /// Gain register.
    pub register: Option<JointSeries>,
    /// Powered (1) or not (0).
    pub powered: Option<JointSeries>,
}

impl Settings {
    /// N.m/rad of `servo` at joint `j` and sample `k`; 0 where it is off.
    pub fn gain(&self, servo: &Servo, j: usize, k: usize) -> f64 {
        let register = self.register.as_ref().map(|r| r.joint(j)[k]);
        self.is_on(j, k) * servo.gain_at(j, register)
    }

    /// 1 where joint `j` is powered at sample `k`, else 0.
    pub fn is_on(&self, j: usize, k: usize) -> f64 {
        let on = self.powered.as_ref().is_none_or(|p| p.joint(j)[k] > 0.5);
        if on { 1.0 } else { 0.0 }
    }
}

/// A command as it arrives, `delay` seconds late: linear between its samples, `dt` apart, and the first one
/// before it.
fn arrived(command: &[f64], delay: f64, dt: f64) -> Vec<f64> {
    let late = delay / dt;
    (0..command.len()).map(|k| at_place(command, k as f64 - late)).collect()
}

/// A servo of a kind, at one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kind {
    pub name: &'static str,
    /// Share of the supply per radian and unit of the gain register.
    pub duty_per_rad: f64,
    /// Gain register as delivered.
    pub register: f64,
    /// Largest share of the supply.
    pub most_duty: f64,
    /// Torque at standstill per volt of supply, N.m/V.
    pub torque_per_volt: f64,
    /// N.m.s/rad at the joint.
    pub damping: f64,
    /// Nominal supply, V.
    pub volts: f64,
    pub source: &'static str,
}

/// Published servos.
pub const KINDS: &[Kind] = &[
    Kind {
        name: "sts3215",
        duty_per_rad: 0.166,
        register: 32.0,
        most_duty: 0.97,
        torque_per_volt: 1.21164 / 2.67617,
        damping: 1.21164 * 1.21164 / 2.67617,
        volts: 7.4,
        source: "Feetech STS3215, 7.4 V: identified by Rhoban/bam (Apache-2.0), \
                 bam/params/feetech_sts3215_7_4V/m1.json, duty by oscilloscope; at 7.4 V these are kp 17.8 and \
                 forcerange 3.35 of SO-ARM100's joints_properties.xml (there 0.60 damping holds friction, too)",
    },
    Kind {
        name: "xl330-m288",
        duty_per_rad: 4096.0 / std::f64::consts::TAU / (256.0 * 885.0),
        register: 400.0,
        most_duty: 1.0,
        torque_per_volt: 0.52 / 5.0,
        damping: 0.52 / (103.0 * std::f64::consts::TAU / 60.0),
        volts: 5.0,
        source: "Dynamixel XL330-M288-T, ROBOTIS e-Manual: 0.52 N.m at standstill and 103 rpm without load, both \
                 at 5.0 V, PWM limit 885; divisor 256 of the gain by Rhoban/bam (the e-Manual has 128)",
    },
];

/// The servo of this name.
///
/// # Errors
/// If there is none, saying which there are.
pub fn kind(name: &str) -> Result<&'static Kind, RobotError> {
    KINDS.iter().find(|k| k.name == name).ok_or_else(|| {
        let known: Vec<&str> = KINDS.iter().map(|k| k.name).collect();
        RobotError::Servo(format!(
            "no servo is known as `{name}`; choose from {}, or give gain (N.m/rad) and damping (N.m.s/rad)",
            known.join(", ")
        ))
    })
}

impl Servo {
    /// Servos of these gains (N.m/rad), without anything else.
    pub fn new(gain: Vec<f64>) -> Self {
        let zeros = vec![0.0; gain.len()];
        Self {
            register: None,
            damping: zeros.clone(),
            friction: zeros.clone(),
            max_torque: vec![f64::INFINITY; gain.len()],
            dead_band: zeros.clone(),
            delay: zeros.clone(),
            offset: zeros,
            gain,
        }
    }

    /// `dof` servos of a kind with a supply of `volts` and this gain register.
    pub fn of_kind(kind: &Kind, volts: &[f64], register: &[f64]) -> Self {
        let full = |v: &f64| kind.torque_per_volt * v;
        let gain = volts.iter().zip(register).map(|(v, r)| full(v) * kind.duty_per_rad * r);
        let mut servo = Self::new(gain.collect());
        servo.max_torque = volts.iter().map(|v| kind.most_duty * full(v)).collect();
        servo.damping = vec![kind.damping; volts.len()];
        servo.register = Some(register.to_vec());
        servo
    }

    pub fn dof(&self) -> usize {
        self.gain.len()
    }

    /// N.m per rad at joint `j` with this gain register, where both are known.
    pub fn gain_at(&self, j: usize, register: Option<f64>) -> f64 {
        match (register, &self.register) {
            (Some(now), Some(nominal)) if nominal[j] > 0.0 => self.gain[j] * now / nominal[j],
            _ => self.gain[j],
        }
    }

    /// Torque of the position loop at joint `j` with gain `gain` (N.m/rad) for an `error` (command less
    /// position, rad), and its slope over the error, N.m/rad: zero in the dead band and at the limit.
    pub fn pull(&self, j: usize, gain: f64, error: f64) -> [f64; 2] {
        let (asked, limit) = (self.asked(j, gain, error), self.max_torque[j]);
        match (asked == 0.0 && self.dead_band[j] > 0.0, asked.abs() >= limit) {
            (true, _) => [0.0, 0.0],
            (_, true) => [asked.clamp(-limit, limit), 0.0],
            _ => [asked, gain],
        }
    }

    /// The same torque were there no limit, N.m.
    fn asked(&self, j: usize, gain: f64, error: f64) -> f64 {
        let (e, w) = (error + self.offset[j], self.dead_band[j]);
        gain * (e - e.clamp(-w, w))
    }

    /// What the servos made of `command` (rad) where the joints were at `q` (rad) and moved with `qd`
    /// (rad/s), and their torque, N.m; samples `dt` apart.
    pub fn told(
        &self,
        command: JointSeries,
        q: &JointSeries,
        qd: &JointSeries,
        settings: &Settings,
        dt: f64,
    ) -> (Told, JointSeries) {
        let zeros = || JointSeries::zeros(q.joints(), q.samples());
        let each = |of: &dyn Fn(usize, usize) -> f64| {
            q.map_joints(|j, q| (0..q.len()).map(|k| of(j, k)).collect())
        };
        let unseen = Told {
            dt,
            command,
            late: 0.0,
            error: zeros(),
            asked: zeros(),
            pull: zeros(),
            slope: zeros(),
            powered: each(&|j, k| settings.is_on(j, k)),
            gain: each(&|j, k| settings.gain(self, j, k)),
            limit: self.max_torque.clone(),
            q: q.clone(),
            recorded: vec![true; q.samples()],
            resolution: vec![0.0; q.joints()],
        };
        let told = self.at(&unseen, q);
        let braked =
            |j: usize, k: usize| told.powered.joint(j)[k] * self.damping[j] * qd.joint(j)[k];
        let torque = each(&|j, k| told.pull.joint(j)[k] - braked(j, k));
        (told, torque)
    }

    /// What the servos make of a command where the joints are at `q` (rad); all else as it was told.
    pub fn at(&self, told: &Told, q: &JointSeries) -> Told {
        let mut now = told.clone();
        for j in 0..q.joints() {
            let late = told.arrived(j, self.delay[j]);
            for (k, c) in late.into_iter().enumerate() {
                let error = c - q.joint(j)[k];
                let gain = told.gain.joint(j)[k];
                let [pull, slope] = self.pull(j, gain, error);
                now.asked.joint_mut(j)[k] = self.asked(j, gain, error);
                now.error.joint_mut(j)[k] = error + self.offset[j];
                (now.pull.joint_mut(j)[k], now.slope.joint_mut(j)[k]) = (pull, slope);
            }
        }
        now
    }

    /// Does it fit an arm of `dof` joints?
    ///
    /// # Errors
    /// Names the key of `[servo]` whose values are wrong, and the joint.
    pub fn check(&self, dof: usize) -> Result<(), RobotError> {
        let positive = |x: f64| x > 0.0 && (1.0 / LARGEST..=LARGEST).contains(&x);
        let none = Vec::new();
        type Fits<'a> = &'a dyn Fn(f64) -> bool;
        let keys: [(&str, &Vec<f64>, Fits<'_>, &str); 7] = [
            ("gain", &self.gain, &positive, "a positive number of N.m/rad"),
            (
                "gain_register",
                self.register.as_ref().unwrap_or(&none),
                &positive,
                "a positive number",
            ),
            ("damping", &self.damping, &|x| (0.0..=LARGEST).contains(&x), "0 or more N.m.s/rad"),
            ("max_torque", &self.max_torque, &|x| x > 0.0, "a positive number of N.m"),
            ("dead_band", &self.dead_band, &|x| (0.0..=WIDEST_RAD).contains(&x), "0 to 1 rad"),
            ("delay", &self.delay, &|x| (0.0..=LONGEST_S).contains(&x), "0 to 1 s"),
            ("offset", &self.offset, &|x| x.abs() <= WIDEST_RAD, "-1 to 1 rad"),
        ];
        for (key, values, fits, wanted) in keys {
            if values.len() != dof && !(key == "gain_register" && values.is_empty()) {
                let count = values.len();
                return Err(RobotError::Servo(format!(
                    "{key} has {count} values for an arm of {dof} joints; give one per joint or one for all"
                )));
            }
            if let Some(joint) = values.iter().position(|&x| !fits(x)) {
                let value = values[joint];
                return Err(RobotError::Servo(format!(
                    "{key} of joint {} is {value:e}; give {wanted}",
                    joint + 1
                )));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// kp 17.8 and forcerange 3.35 of SO-ARM100's MuJoCo model, register 32 and 7.4 V.
    #[test]
    fn the_sts3215_is_that_of_its_makers() {
        let servo = Servo::of_kind(kind("sts3215").unwrap(), &[7.4], &[32.0]);
        assert!((servo.gain[0] - 17.8).abs() < 0.05, "{servo:?}");
        assert!((servo.max_torque[0] / 0.97 - 3.35).abs() < 0.01, "{servo:?}");
        assert!((servo.gain_at(0, Some(16.0)) - 8.9).abs() < 0.03);
    }

    #[test]
    fn a_pull_stops_in_the_dead_band_and_at_the_limit() {
        let mut servo = Servo::new(vec![10.0]);
        (servo.dead_band[0], servo.max_torque[0]) = (0.01, 2.0);
        assert_eq!(servo.pull(0, 10.0, 0.005), [0.0, 0.0]);
        let [torque, slope] = servo.pull(0, 10.0, 0.11);
        assert!((torque - 1.0).abs() < 1e-12 && slope == 10.0);
        assert_eq!(servo.pull(0, 10.0, -0.5), [-2.0, 0.0]);
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let mut servo = Servo::new(vec![10.0; 2]);
        assert!(servo.check(2).is_ok());
        assert!(servo.check(3).unwrap_err().to_string().contains("gain has 2 values"));
        servo.delay[1] = 20.0;
        assert!(servo.check(2).unwrap_err().to_string().contains("delay of joint 2"));
        assert!(kind("sg90").unwrap_err().to_string().contains("xl330-m288"));
    }
}
