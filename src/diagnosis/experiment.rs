//! The next experiment: which motion tells the two best rivals apart.
//!
//! For every motion of the menu the first rival's torque is worked out from the twin and the second
//! is fitted to it; half the sum of squares it cannot follow, over the noise, is the log-likelihood
//! by which a recording of that motion would decide.

use nalgebra::Rotation3;
use rayon::prelude::*;

use super::candidate::{Candidate, Place, describe};
use super::data::Data;
use super::fit::Fit;
use super::hypotheses::Hypothesis;
use super::observed::Observed;
use super::{Floor, Settings};
use crate::effects::{Scope, Seen};
use crate::motion::{Kind, Settings as Motion};
use crate::series::JointSeries;
use crate::signals::Samples;
use crate::twin::Twin;

/// Stands in a command for the file of the twin, which a diagnosis does not know.
pub const TWIN: &str = " --twin TWIN";

/// Length of every motion of the menu, s.
const LENGTH_S: f64 = 30.0;
/// Less than this decides nothing, nats.
const LEAST_NATS: f64 = 6.0;
/// What is changed in an experiment besides the motion.
const TILT_RAD: f64 = 0.17;
const LOAD_KG: f64 = 2.0;
const LOAD_HEIGHT_M: f64 = 0.05;
/// Temperatures from cold to warm, deg C.
const WARM_C: [f64; 2] = [25.0, 45.0];

#[derive(Clone, Copy, PartialEq)]
enum Change {
    Nothing,
    Tilt,
    Load,
    Warmth,
}

struct Experiment {
    says: &'static str,
    kind: Kind,
    acceleration_rad_s2: f64,
    change: Change,
}

const fn experiment(
    says: &'static str,
    kind: Kind,
    acceleration: f64,
    change: Change,
) -> Experiment {
    Experiment { says, kind, acceleration_rad_s2: acceleration, change }
}

const MENU: [Experiment; 9] = [
    experiment(
        "plateaus of constant speed in both directions",
        Kind::Plateaus,
        5.0,
        Change::Nothing,
    ),
    experiment("gentle reversals (1 rad/s2)", Kind::Mixed, 1.0, Change::Nothing),
    experiment("brisk reversals (4 rad/s2)", Kind::Mixed, 4.0, Change::Nothing),
    experiment("hard reversals (12 rad/s2)", Kind::Mixed, 12.0, Change::Nothing),
    experiment("sines of high frequency", Kind::RandomFrequency, 12.0, Change::Nothing),
    experiment("moves from pose to pose with rests", Kind::PointToPoint, 5.0, Change::Nothing),
    experiment("the same with a known load of 2 kg", Kind::Mixed, 4.0, Change::Load),
    experiment("the same with the base tilted by 10 degrees", Kind::Mixed, 4.0, Change::Tilt),
    experiment("the same from cold to warm", Kind::Mixed, 4.0, Change::Warmth),
];

/// The motion that separates `rivals` best, and how to make it, in words.
pub fn next(
    check: &Observed<'_>,
    floor: &[Floor],
    rivals: [&Hypothesis<'_>; 2],
    settings: &Settings,
) -> String {
    let names = rivals.map(|h| describe(h.trial.candidate));
    let nats: Vec<f64> = MENU
        .par_iter()
        .map(|e| separation(check, floor, rivals, e, settings.seed).unwrap_or(0.0))
        .collect();
    let best = (0..MENU.len()).max_by(|&a, &b| nats[a].total_cmp(&nats[b])).unwrap_or(0);
    let [first, second] = names;
    if nats[best] < LEAST_NATS {
        return format!(
            "none of the built-in motions would tell {first} from {second}: they are the same as \
             far as joint torques go"
        );
    }
    let Experiment { says, kind, acceleration_rad_s2, .. } = &MENU[best];
    let kind = serde_json::to_string(kind).unwrap_or_default();
    format!(
        "to tell {first} from {second}: {says} (evidence of {:.0} nats in {LENGTH_S:.0} s, where 3 are odds of 20 to 1); in a scenario of \
         `armtwin simulate`: [motion] kind = {kind}, acceleration_rad_s2 = {acceleration_rad_s2}{}",
        nats[best],
        designed(rivals.map(|h| h.trial.candidate), &MENU[best])
    )
}

/// The command that designs a motion for it, where the motion is all that changes and torque shows
/// both.
fn designed(rivals: [Candidate; 2], experiment: &Experiment) -> String {
    let by_torque =
        |c: &Candidate| c.effect.seen() == Seen::Columns && !matches!(c.place, Place::Links(_));
    let [one, other] = rivals.map(|c| match c.place {
        Place::Joint(j) if c.effect.about().scope != Scope::Arm => {
            format!("{}@{}", c.name(), j + 1)
        }
        _ => c.name().to_string(),
    });
    match rivals.iter().all(by_torque) && experiment.change == Change::Nothing {
        true => format!(
            "; a motion made for it: `armtwin excite{TWIN} --apart {one},{other} --seconds \
             {LENGTH_S:.0} -o next.csv`"
        ),
        false => String::new(),
    }
}

/// Log-likelihood, nats, by which a recording of the experiment would favour the first rival if it
/// is right; `None` where the arm cannot make the motion.
fn separation(
    check: &Observed<'_>,
    floor: &[Floor],
    [first, second]: [&Hypothesis<'_>; 2],
    experiment: &Experiment,
    seed: u64,
) -> Option<f64> {
    let twin = changed(check.twin, experiment.change);
    let samples = planned(&twin, check.samples, experiment, seed)?;
    let mut observed = Observed::new(0, &twin, &samples, floor).ok()?;
    let mut torque = first.fit.held_against(&observed);
    torque.0.iter_mut().flatten().for_each(|v| *v = -*v);
    observed.torque = torque;
    let data = Data::plain(vec![&observed]);
    let fit = Fit::plain(&data, second.fit.model.clone());
    let nats = |(s, sigma): (&f64, &f64)| 0.5 * s / sigma.powi(2).max(f64::MIN_POSITIVE);
    Some(fit.squares.iter().zip(&observed.sigma).map(nats).sum())
}

fn changed(twin: &Twin, change: Change) -> Twin {
    let mut twin = twin.clone();
    match change {
        Change::Tilt => {
            let turn = Rotation3::new(nalgebra::Vector3::x() * TILT_RAD);
            twin.robot.gravity = turn * twin.robot.gravity;
        }
        Change::Load => {
            let centre = nalgebra::Vector3::z() * LOAD_HEIGHT_M;
            twin.robot = twin.robot.with_payload(LOAD_KG, centre, nalgebra::Matrix3::zeros());
        }
        Change::Nothing | Change::Warmth => {}
    }
    twin
}

/// The motion as it would be recorded, without torque.
fn planned(twin: &Twin, like: &Samples, experiment: &Experiment, seed: u64) -> Option<Samples> {
    let motion = Motion {
        kind: experiment.kind,
        acceleration_rad_s2: experiment.acceleration_rad_s2,
        duration_s: LENGTH_S,
        seed,
        ..Motion::default()
    };
    let trajectory = motion.trajectory(&twin.robot).ok()?;
    let (dof, n) = (twin.robot.dof(), (LENGTH_S / like.dt) as usize);
    let mut series = [(); 3].map(|()| JointSeries::zeros(dof, n));
    let mut state = [(); 3].map(|()| vec![0.0; dof]);
    for k in 0..n {
        let [q, qd, qdd] = &mut state;
        trajectory.at(k as f64 * like.dt, q, qd, qdd);
        series.iter_mut().zip(&state).for_each(|(s, x)| s.set_sample(k, x));
    }
    let warm = |k: usize| WARM_C[0] + (WARM_C[1] - WARM_C[0]) * k as f64 / n as f64;
    let temperature = (experiment.change == Change::Warmth)
        .then(|| JointSeries::from_joints(&vec![(0..n).map(warm).collect(); dof]));
    let [q, qd, qdd] = series;
    Some(Samples {
        start: 0.0,
        q,
        qd,
        qdd,
        torque: JointSeries::zeros(dof, n),
        told: None,
        response: None,
        sensed: None,
        smoothed_further: None,
        temperature,
        usable: vec![true; n],
        notes: Vec::new(),
        dt: like.dt,
        conditioning: like.conditioning.clone(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::find;

    /// What is offered can be run, by the words of the command line.
    #[test]
    fn the_command_names_both_rivals() {
        let at = |name: &str, place| Candidate::new(find(name).unwrap(), place);
        let pair = [at("payload", Place::Arm), at("link_inertia", Place::Joint(5))];
        let says = designed(pair, &MENU[0]);
        let rivals = says.split("--apart ").nth(1).unwrap().split(' ').next().unwrap();
        assert_eq!(rivals, "payload,link_inertia@6");
        let loaded = MENU.iter().find(|e| e.change == Change::Load).unwrap();
        assert_eq!(designed(pair, loaded), "", "a motion alone does not load the arm");
        let late = [at("payload", Place::Arm), at("time_delay", Place::Arm)];
        assert_eq!(designed(late, &MENU[0]), "", "no column of torque");
    }
}
