//! The guide's chapter on the effects, worked out from the catalogue: nothing of it is typed by hand.

use std::fmt::Write as _;

use super::example::example;
use super::typical::{bare, typical};
use super::words::{by_hand, comes_back, number, on, range, shows_as};
use crate::effects::{About, CATALOGUE, DriveKind, Effect, Motion, Scope, Seen};
use crate::export::{Target, export};
use crate::robot::gravity_torque;
use crate::robot::{Workspace, inverse_dynamics_series};
use crate::series::JointSeries;
use crate::twin::Twin;

const DT: f64 = 0.005;
const SAMPLES: usize = 6000;
/// An effect whose torque is not explained by this much of a quantity is not said to follow it.
const FOLLOWS: f64 = 0.25;

pub fn chapter() -> String {
    let mut text = String::from(
        "# The effects\n\nPrinted by `armtwin effects --guide` from the catalogue. Laws say what the drive must \
         supply on top of the rigid body, N.m. *Looks like* is worked out at typical values on a \
         motion of 30 s of the built-in UR5 (sines of every joint, slow and fast): how large, on \
         which joint most, and how much of it (R2) goes with a single quantity of that joint. \
         `scenarios/effects/NAME.toml` hides each in a simulated arm; *Comes back* is what is found of it \
         there. *By hand* is a number that the code is held against. The last table shows what is \
         recorded of joint 2, before and after the effect, as all joints turn around once.\n",
    );
    let motion = Sines::new();
    for effect in CATALOGUE {
        text += &section(*effect, &motion);
    }
    text
}

fn section(effect: &dyn Effect, motion: &Sines) -> String {
    let about = effect.about();
    let mut text = format!("\n## {}\n\n`{}` on {}.\n\n", about.name, about.law, on_what(about));
    let _ = writeln!(text, "* **Comes from** {}.", about.cause);
    let _ = writeln!(text, "* **Looks like** {}.", looks(effect, motion));
    let _ = writeln!(text, "* **Mend** by this: {}.", about.remedy);
    let _ = writeln!(
        text,
        "* **Other simulators**: MJCF {}, URDF {}.",
        held(about, Target::Mjcf),
        held(about, Target::Urdf)
    );
    let _ = writeln!(text, "* **Source**: {}.", about.source);
    let proofs = [("By hand", by_hand(effect)), ("Comes back", comes_back(effect))];
    for (label, proof) in proofs.into_iter().filter_map(|(label, p)| Some((label, p?))) {
        let _ = writeln!(text, "* **{label}**: {proof}.");
    }
    text += "\n| parameter | symbol | unit | range | typical |\n|---|---|---|---|---|\n";
    for p in about.parameters.iter().filter(|p| !p.is_reference()) {
        let (range, typical) = (range(p), number(p.typical));
        let _ =
            writeln!(text, "| `{}` | {} | {} | {range} | {typical} |", p.name, p.symbol, p.unit);
    }
    text += &before_and_after(effect);
    text
}

/// The example, as a table.
fn before_and_after(effect: &dyn Effect) -> String {
    let Some(example) = example(effect) else { return String::new() };
    let rows = example.rows();
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let rule = vec!["---".to_string(); rows[0].len()];
    let text: String = rows[1..].iter().map(|row| line(row)).collect();
    format!("\n{}{}{text}", line(&rows[0]), line(&rule))
}

fn on_what(about: &About) -> &'static str {
    match about.scope {
        Scope::Link => "each link, felt by all joints",
        _ => on(about),
    }
}

fn held(about: &About, target: Target) -> &'static str {
    let without = export(&bare(about), target, "").text;
    let exported = export(&typical(about), target, "");
    let body = |text: &str| text.split_once("-->").map(|(_, body)| body.to_string());
    let named = exported.left.iter().any(|l| l.effect == about.name);
    match (body(&exported.text) != body(&without), named) {
        (true, true) => "holds it in part",
        (true, false) => "holds it",
        _ => "cannot hold it",
    }
}

fn looks(effect: &dyn Effect, motion: &Sines) -> String {
    if effect.seen() != Seen::Columns {
        return shows_as(effect.seen()).into();
    }
    if effect.of_drive() == DriveKind::Servo {
        return "a position that its command does not explain, where position servos are recorded"
            .into();
    }
    let twin = typical(effect.about());
    let all = &motion.samples;
    let moved = Motion::new(&twin.robot, DT, &all.q, &all.qd, &all.qdd);
    let moved = Motion { temperature: Some(&all.temperature), ..moved };
    let mut torque = twin.torque(&moved);
    let rigid = inverse_dynamics_series(&twin.robot, &all.q, &all.qd, &all.qdd);
    for j in 0..torque.joints() {
        torque.joint_mut(j).iter_mut().zip(rigid.joint(j)).for_each(|(t, r)| *t -= r);
    }
    let size = |j: &usize| rms(torque.joint(*j));
    let Some(most) = (0..torque.joints()).max_by(|a, b| size(a).total_cmp(&size(b))) else {
        return "nothing".into();
    };
    let follows = motion.follows(&twin, most, torque.joint(most));
    let with = match follows.is_empty() {
        true => "goes with no single quantity".into(),
        false => format!("goes with {}", follows.join(", ")),
    };
    format!("{:.2} N.m RMS, most of all on joint {}, where it {with}", size(&most), most + 1)
}

struct Sines {
    samples: Trajectory,
}

struct Trajectory {
    q: JointSeries,
    qd: JointSeries,
    qdd: JointSeries,
    temperature: JointSeries,
}

impl Sines {
    /// Two sines per joint, a slow wide one and a fast one, at frequencies without a common period.
    fn new() -> Self {
        let centre = [0.0, -1.4, 1.0, -0.8, -1.5, 0.0];
        let sum = |j: usize, derivative: i32, t: f64| -> f64 {
            let slow = (0.8, 0.7 + 0.11 * j as f64);
            let fast = (0.12, 4.1 + 0.37 * j as f64);
            let turn = std::f64::consts::FRAC_PI_2 * f64::from(derivative);
            let wave =
                |(a, w): (f64, f64)| a * w.powi(derivative) * (w * t + turn + j as f64).sin();
            wave(slow) + wave(fast) + if derivative == 0 { centre[j] } else { 0.0 }
        };
        let series = |derivative: i32| {
            let row = |j| (0..SAMPLES).map(|k| sum(j, derivative, DT * k as f64)).collect();
            JointSeries::from_joints(&(0..6).map(row).collect::<Vec<Vec<f64>>>())
        };
        let warming: Vec<f64> =
            (0..SAMPLES).map(|k| 25.0 + 10.0 * k as f64 / SAMPLES as f64).collect();
        let samples = Trajectory {
            q: series(0),
            qd: series(1),
            qdd: series(2),
            temperature: JointSeries::from_joints(&vec![warming; 6]),
        };
        Self { samples }
    }

    /// Quantities of a joint that `torque` goes with, the closest first.
    fn follows(&self, twin: &Twin, joint: usize, torque: &[f64]) -> Vec<String> {
        let Trajectory { q, qd, qdd, .. } = &self.samples;
        let speed = qd.joint(joint);
        let dry: Vec<f64> = speed.iter().map(|v| v.signum()).collect();
        let quantities = [
            ("the direction of motion", dry),
            ("speed", speed.to_vec()),
            ("speed without its sign", speed.iter().map(|v| v.abs()).collect()),
            ("acceleration", qdd.joint(joint).to_vec()),
            ("angle", q.joint(joint).to_vec()),
            ("the weight the joint carries", self.gravity(twin, joint)),
        ];
        let mean = torque.iter().sum::<f64>() / torque.len() as f64;
        if rms(&torque.iter().map(|t| t - mean).collect::<Vec<_>>()) < 1e-6 * rms(torque) {
            return vec!["nothing: it is constant".into()];
        }
        let mut found: Vec<(f64, &str)> =
            quantities.iter().map(|(name, x)| (r2(x, torque), *name)).collect();
        found.retain(|(r2, _)| *r2 >= FOLLOWS);
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found.iter().take(3).map(|(r2, name)| format!("{name} ({r2:.2})")).collect()
    }

    fn gravity(&self, twin: &Twin, joint: usize) -> Vec<f64> {
        let robot = &twin.robot;
        let (mut workspace, mut q, mut g) = (Workspace::new(robot), [0.0; 6], [0.0; 6]);
        let at = |k| {
            self.samples.q.sample_into(k, &mut q);
            gravity_torque(robot, &mut workspace, &q, &mut g);
            g[joint]
        };
        (0..SAMPLES).map(at).collect()
    }
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Share of the variance of y that a line in x explains.
fn r2(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let pairs = || x.iter().zip(y).map(|(x, y)| (x - mx, y - my));
    let xy: f64 = pairs().map(|(x, y)| x * y).sum();
    let (xx, yy) = pairs().fold((0.0, 0.0), |(a, b), (x, y)| (a + x * x, b + y * y));
    if xx * yy > 0.0 { xy * xy / (xx * yy) } else { 0.0 }
}
