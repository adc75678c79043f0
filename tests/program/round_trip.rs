//! Every effect injected in rapier and found again: fitted values beside the truth, and what cannot
//! be fitted shown where it shows.

use std::collections::BTreeMap;
use std::path::Path;

use armtwin::effects::{CATALOGUE, Effect, Parameter, Role, RoundTrip, Scope};
use armtwin::identification::{
    self, ArmProblem, Method, MethodResult, ParameterEstimate, Settings, Terms, assemble,
};
use armtwin::recording::Recording;
use armtwin::servo::{self, Track, free_parameters};
use armtwin::signals::{Conditioning, Derivatives, Samples, condition};
use armtwin::simulation::{Experiment, Run, Scenario, Simulation};
use armtwin::twin::{PerJoint, Twin};
use rayon::prelude::*;

const DURATION_S: f64 = 30.0;

struct Case {
    effect: &'static dyn Effect,
    scenario: Scenario,
    made: Experiment,
    run: Run,
}

impl Case {
    /// The effect's own scenario, its linear values times `strength`.
    fn new(effect: &'static dyn Effect, strength: f64) -> Self {
        Self::changed(effect, strength, |_| ())
    }

    fn changed(
        effect: &'static dyn Effect,
        strength: f64,
        change: impl FnOnce(&mut Scenario),
    ) -> Self {
        let about = effect.about();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/effects");
        let file = folder.join(about.name).with_extension("toml");
        let mut scenario = Scenario::load(&file).unwrap();
        scenario.shorten(DURATION_S);
        let table = scenario.effects.get_mut(about.name).unwrap();
        about
            .parameters
            .iter()
            .filter(|p| p.is_reference())
            .for_each(|p| drop(table.remove(p.name)));
        for p in about.parameters.iter().filter(|p| p.role == Role::Linear) {
            let Some(value) = table.get(p.name) else { continue };
            let scaled = match value {
                PerJoint::All(x) => PerJoint::All(strength * x),
                PerJoint::Each(x) => PerJoint::Each(x.iter().map(|x| strength * x).collect()),
            };
            table.insert(p.name.into(), scaled);
        }
        change(&mut scenario);
        let made = scenario.work_out("test").unwrap();
        let mut simulation = Simulation::new(&made.setup).unwrap();
        let run = simulation.run(&made.fit, 1, 0, &mut |_| true).unwrap();
        Self { effect, scenario, made, run }
    }

    /// The nominal arm that is told the nonlinear parameters.
    fn twin(&self) -> Twin {
        let about = self.effect.about();
        let mut values = BTreeMap::new();
        for p in about.parameters.iter().filter(|p| p.role == Role::Nonlinear) {
            let count = if about.scope == Scope::Arm { 1 } else { 6 };
            values.insert(p.name.to_string(), self.truth(p, p.typical)[..count].to_vec());
        }
        Twin {
            drive: self.made.setup.drive.clone(),
            effects: self.scenario.effects.keys().cloned().collect(),
            values,
            ..Twin::default()
        }
    }

    /// Per joint, `absent` where the effect does not act.
    fn truth(&self, p: &Parameter, absent: f64) -> Vec<f64> {
        let about = self.effect.about();
        let at = about.parameters.iter().position(|q| q.name == p.name).unwrap();
        let setup = &self.made.setup;
        let named = |i: &&armtwin::simulation::Injection| i.effect.about().name == about.name;
        let mut all = vec![absent; 6];
        let Some(injection) = setup.effects.iter().find(named) else { return all };
        for (row, joint) in injection.values.iter().zip(&injection.joints) {
            all[*joint] = row[at];
        }
        all
    }

    fn problem(&self, twin: &Twin) -> ArmProblem {
        // A longer guard loses the slow sliding that shows Stribeck friction.
        let motion_cutoff_hz = match self.effect.round_trip() {
            Some(RoundTrip::Fitted { motion_cutoff_hz, .. }) => motion_cutoff_hz,
            _ => Conditioning::default().motion_cutoff_hz,
        };
        let how = Conditioning { guard_s: 0.05, motion_cutoff_hz, ..Conditioning::default() };
        let samples = condition_with(&self.run.recording, twin, &how);
        let terms = Terms::named(self.scenario.effects.keys().map(String::as_str)).unwrap();
        assemble(&samples, twin, &terms, &BTreeMap::new()).unwrap()
    }

    fn fitted(&self, twin: &Twin) -> MethodResult {
        fitted(&self.problem(twin))
    }

    /// What was fitted for a parameter of a joint (from 0), and under which name.
    fn estimate<'r>(
        &self,
        result: &'r MethodResult,
        p: &Parameter,
        joint: usize,
    ) -> (String, Option<&'r ParameterEstimate>) {
        let name = match self.effect.about().scope {
            Scope::Link => format!("{}_{}", p.name, joint + 1),
            _ => p.name.replace("current_offset", "offset"),
        };
        let of_joint = &result.joints[joint].parameters;
        let found = of_joint.iter().chain(&result.arm).find(|e| e.name == name);
        (name, found)
    }

    /// `twin` with references where a fit with it shows the effect.
    fn settled(&self, mut twin: Twin) -> Twin {
        let about = self.effect.about();
        let (linear, nonlinear): (Vec<&Parameter>, Vec<&Parameter>) =
            about.parameters.iter().partition(|p| p.role == Role::Linear);
        if !nonlinear.iter().any(|p| p.is_reference()) {
            return twin;
        }
        let result = self.fitted(&twin);
        for joint in 0..twin.values[nonlinear[0].name].len() {
            let found = linear.iter().filter_map(|p| self.estimate(&result, p, joint).1);
            let shown = found.filter(|e| e.identifiable && (e.low > 0.0 || e.high < 0.0));
            let values: Vec<f64> = shown.map(|e| e.value).collect();
            if values.len() < linear.len() {
                continue;
            }
            let mut of_joint: Vec<f64> =
                nonlinear.iter().map(|p| twin.values[p.name][joint]).collect();
            self.effect.settle(&values, &mut of_joint);
            for (p, value) in nonlinear.iter().zip(of_joint) {
                twin.values.get_mut(p.name).unwrap()[joint] = value;
            }
        }
        twin
    }

    /// (parameter and joint, truth, estimate) of every linear parameter.
    fn compared(&self) -> Vec<(String, f64, ParameterEstimate)> {
        let about = self.effect.about();
        let result = self.fitted(&self.settled(self.twin()));
        let mut rows = Vec::new();
        for p in about.parameters.iter().filter(|p| p.role == Role::Linear) {
            let drive = &self.made.setup.drive;
            for (j, truth) in self.truth(p, p.null).into_iter().enumerate() {
                let found = self.estimate(&result, p, j).1;
                if let (Some(found), true) = (found, about.scope != Scope::Arm || j == 0) {
                    let what = format!("{} of joint {}", p.name, j + 1);
                    rows.push((what, truth + self.effect.in_drive(drive, j), found.clone()));
                }
            }
        }
        rows
    }
}

/// The parameter of a row of [`Case::compared`].
fn reads_as(what: &str) -> &str {
    what.split(' ').next().unwrap_or_default()
}

fn fitted(problem: &ArmProblem) -> MethodResult {
    let settings = Settings { methods: vec![Method::Nlse], ..Settings::default() };
    identification::identify(problem, None, &settings).unwrap().remove(0)
}

fn condition_with(recording: &Recording, twin: &Twin, how: &Conditioning) -> Samples {
    condition(recording, &twin.drive, 6, how).unwrap()
}

type Effects = Vec<(&'static dyn Effect, RoundTrip)>;

/// Effects that come back in a way.
fn coming_back(how: impl Fn(&RoundTrip) -> bool) -> Effects {
    let trips = CATALOGUE.iter().map(|e| (*e, e.round_trip().expect("a round trip")));
    trips.filter(|(_, trip)| how(trip)).collect()
}

/// At both strengths that each effect names.
fn fitted_effects() -> Vec<(&'static dyn Effect, f64, &'static [&'static str])> {
    let strengths = |(effect, trip): (&'static dyn Effect, RoundTrip)| match trip {
        RoundTrip::Fitted { strengths, shows, .. } => {
            strengths.map(|s| (effect, s, shows)).to_vec()
        }
        _ => vec![],
    };
    coming_back(|_| true).into_iter().flat_map(strengths).collect()
}

/// At two strengths, at 30 dB. Of several hundred intervals of 99 % a few miss.
#[test]
fn what_was_injected_is_found_again() {
    let tables: Vec<_> = fitted_effects()
        .into_par_iter()
        .map(|(effect, strength, shows)| (effect, shows, Case::new(effect, strength).compared()))
        .collect();
    let (mut inside, mut all) = (0, 0);
    for (effect, shows, rows) in tables {
        let effect = effect.about().name;
        let told = |e: &ParameterEstimate| e.identifiable && !e.at_bound;
        for (what, truth, e) in rows.iter().filter(|(_, _, e)| told(e)) {
            let half = 0.5 * (e.high - e.low);
            assert!((e.value - truth).abs() < 1.5 * half, "{effect}: {what} is {truth}, {e:?}");
            inside += usize::from(e.low <= *truth && *truth <= e.high);
            all += 1;
        }
        for parameter in shows {
            let named = |what: &str| reads_as(what) == *parameter;
            let shown = rows.iter().filter(|(what, truth, _)| named(what) && *truth != 0.0);
            let mut shown = shown.filter(|(_, _, e)| told(e) && (e.low > 0.0 || e.high < 0.0));
            assert!(shown.next().is_some(), "{effect}: no {parameter} was found: {rows:?}");
        }
    }
    assert!(all > 300 && inside * 100 >= all * 98, "{inside} of {all} inside their intervals");
}

/// Masses of links are known only in combinations (base parameters); their torque is found.
#[test]
fn the_torque_of_a_heavier_link_is_found() {
    let effect = *CATALOGUE.iter().find(|e| e.about().name == "link_inertia").unwrap();
    let case = Case::new(effect, 1.0);
    let twin = case.twin();
    let (problem, found) = (case.problem(&twin), case.fitted(&twin).found.shared);
    let parameters = effect.about().parameters;
    let truth = |name: &str| {
        let (stem, joint) = name.rsplit_once('_').unwrap();
        let p = parameters.iter().find(|p| p.name == stem).unwrap();
        case.truth(p, 0.0)[joint.parse::<usize>().unwrap() - 1]
    };
    let truth: Vec<f64> = problem.shared.iter().map(|p| truth(&p.name)).collect();
    for joint in [1, 2] {
        let torque = |values: &[f64]| {
            let columns = &problem.shared_columns[joint];
            let at = |k: usize| columns.iter().zip(values).map(|(c, v)| c[k] * v).sum::<f64>();
            (0..columns[0].len()).map(at).collect::<Vec<f64>>()
        };
        let (true_torque, found_torque) = (torque(&truth), torque(&found));
        let errors: f64 =
            true_torque.iter().zip(&found_torque).map(|(t, f)| (t - f) * (t - f)).sum();
        let size: f64 = true_torque.iter().map(|t| t * t).sum();
        assert!(errors < 0.02 * size, "joint {}: {} of the torque", joint + 1, errors / size);
    }
}

/// Links that give way pull at each other: elastic joints come back beside a slack one that is known,
/// and the slack one beside elastic ones.
#[test]
fn elastic_and_slack_joints_are_found_beside_each_other() {
    let flexibility = CATALOGUE.iter().find(|e| e.about().name == "joint_flexibility").unwrap();
    let slack = [
        ("joints", 2.0),
        ("backlash_gap", 0.002),
        ("backlash_stiffness", 2e4),
        ("backlash_damping", 40.0),
    ];
    let case = Case::changed(*flexibility, 1.0, |scenario| {
        let table = slack.map(|(key, value)| (key.to_string(), PerJoint::All(value)));
        scenario.effects.insert("backlash".into(), table.into());
        let elastic = scenario.effects.get_mut("joint_flexibility").unwrap();
        elastic.insert("joints".into(), PerJoint::Each(vec![1.0, 3.0]));
    });
    let (gaps, compliances) = ([0.0, 0.002, 0.0], [6e-5, 0.0, 6e-5]);
    let mut twin = case.twin();
    for (key, value) in &slack[2..] {
        twin.values.insert((*key).into(), vec![*value; 6]);
    }
    let rest = [0.0; 3];
    for (sought, truth, known, values) in [
        ("joint_compliance", compliances, "backlash_gap", gaps),
        ("backlash_gap", gaps, "joint_compliance", compliances),
    ] {
        let mut twin = twin.clone();
        twin.values.insert(known.into(), [values, rest].concat());
        let effect = CATALOGUE.iter().find(|e| e.about().parameters[0].name == sought).unwrap();
        let samples = condition_with(&case.run.recording, &twin, &Conditioning::default());
        let terms = Terms::named(["coulomb", "viscous", effect.about().name]).unwrap();
        let found = fitted(&assemble(&samples, &twin, &terms, &BTreeMap::new()).unwrap()).arm;
        for (joint, truth) in truth.into_iter().enumerate() {
            let name = format!("{sought}_{}", joint + 1);
            let e = found.iter().find(|e| e.name == name).unwrap();
            assert!(e.low <= truth && truth <= e.high, "{name} is {truth}, {e:?}");
            let shown = sought != "backlash_gap" || (e.low > 0.9 * truth && e.high < 1.1 * truth);
            assert!(shown || truth == 0.0, "{name} is {truth}, {e:?}");
        }
    }
}

/// What gears carry includes the load that is fitted with it.
#[test]
fn load_friction_is_found_together_with_a_payload() {
    let payload = CATALOGUE.iter().find(|e| e.about().name == "payload").unwrap();
    let friction = BTreeMap::from([("load_friction".to_string(), PerJoint::All(0.06))]);
    let case = Case::changed(*payload, 1.0, |scenario| {
        scenario.effects.insert("load_friction".into(), friction);
    });
    let result = case.fitted(&case.twin());
    for joint in [1, 2] {
        let found = result.joints[joint].parameters.iter().find(|e| e.name == "load_friction");
        let found = found.unwrap();
        assert!(found.low < 0.06 && 0.06 < found.high, "joint {}: {found:?}", joint + 1);
        assert!(found.high - found.low < 0.03, "joint {}: {found:?}", joint + 1);
    }
    let mass = &result.arm[0];
    assert!((mass.value - 2.0).abs() < 0.03, "{mass:?}");
}

/// Left by the baseline law, N.m per joint, where the twin knows all values of the effect, or none.
fn left(case: &Case, knows: bool, how: &Conditioning) -> Vec<f64> {
    let about = case.effect.about();
    let mut twin = case.twin();
    twin.effects = vec!["coulomb".into(), "viscous".into()];
    if knows {
        twin.effects.push(about.name.into());
    }
    let samples = condition_with(&case.run.recording, &twin, how);
    let terms = Terms::named(["coulomb", "viscous"]).unwrap();
    let problem = assemble(&samples, &twin, &terms, &BTreeMap::new()).unwrap();
    let settings = Settings { methods: vec![Method::Nlse], ..Settings::default() };
    let result = identification::identify(&problem, None, &settings).unwrap().remove(0);
    result.joints.iter().map(|j| j.cost).collect()
}

fn without(effect: &'static dyn Effect) -> Case {
    Case::changed(effect, 1.0, |scenario| drop(scenario.effects.remove(effect.about().name)))
}

fn mean_ratio(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a / b).sum::<f64>() / a.len() as f64
}

#[test]
fn known_delays_and_lags_are_taken_out() {
    for (effect, trip) in coming_back(|trip| matches!(trip, RoundTrip::Corrected { .. })) {
        let name = effect.about().name;
        let derivatives = match trip {
            RoundTrip::Corrected { of_velocity: true } => Derivatives::Recorded,
            _ => Derivatives::Position,
        };
        let how = Conditioning { derivatives, ..Conditioning::default() };
        let case = Case::new(effect, 1.0);
        let (blind, knowing) = (left(&case, false, &how), left(&case, true, &how));
        let clean = left(&without(effect), false, &how);
        let (blind, knowing) = (mean_ratio(&blind, &clean), mean_ratio(&knowing, &clean));
        assert!(blind > 1.1 && knowing < 1.05, "{name}: {blind} and {knowing} of the clean rms");
    }
}

/// A limit or another controller moves the arm differently, and inverse dynamics cannot tell.
#[test]
fn what_inverse_dynamics_cannot_see_shows_in_the_motion() {
    for (effect, trip) in coming_back(|trip| matches!(trip, RoundTrip::Strays { .. })) {
        let RoundTrip::Strays { joint, times } = trip else { continue };
        let name = effect.about().name;
        let (case, clean) = (Case::new(effect, 1.0), without(effect));
        let how = Conditioning::default();
        let torque = mean_ratio(&left(&case, false, &how), &left(&clean, false, &how));
        // Jerkier motion is conditioned a little worse; nothing systematic is left.
        assert!((0.8..1.5).contains(&torque), "{name}: {torque} of the clean rms");
        let [off, usual] = [&case, &clean].map(|c| tracking_error(&c.run.recording, joint));
        assert!(off > times * usual, "{name}: {off} rad off its command, {usual} without");
    }
}

/// RMS, rad.
fn tracking_error(recording: &Recording, joint: usize) -> f64 {
    let channel = |stem| recording.channel(&format!("{stem}_{joint}")).unwrap();
    let both = channel("actual_q").iter().zip(channel("target_q"));
    let squares: Vec<f64> = both.map(|(a, t)| (a - t) * (a - t)).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn rounded_channels_lie_on_their_steps() {
    for (effect, trip) in coming_back(|trip| matches!(trip, RoundTrip::Steps { .. })) {
        let RoundTrip::Steps { channel, joint, parameter } = trip else { continue };
        let case = Case::new(effect, 1.0);
        let p = effect.about().parameters.iter().find(|p| p.name == parameter).unwrap();
        let step = case.truth(p, f64::NAN)[joint];
        let x = case.run.recording.channel(&format!("{channel}_{joint}")).unwrap();
        assert!(x.iter().all(|x| (x / step - (x / step).round()).abs() < 1e-9), "{step}");
        assert!(x.iter().any(|other| *other != x[0]));
    }
}

/// Simulated along its command the joint goes where it was recorded, with the values that were hidden in it.
#[test]
fn what_servos_are_other_than_assumed_is_found_by_simulation() {
    for (effect, trip) in coming_back(|trip| matches!(trip, RoundTrip::Followed { .. })) {
        let RoundTrip::Followed { within } = trip else { continue };
        let name = effect.about().name;
        let case = Case::changed(effect, 1.0, |scenario| {
            // In the first seconds it moves too little to tell a gain.
            (scenario.rate_hz, scenario.motion.duration_s) = (125.0, 20.0);
        });
        let mut twin = case.twin();
        twin.effects = vec!["viscous".into()];
        let viscous = case.made.setup.effects.iter().find(|i| i.effect.about().name == "viscous");
        let viscous = viscous.unwrap().values.iter().map(|v| v[0]).collect();
        twin.values = BTreeMap::from([("viscous".to_string(), viscous)]);
        let samples = condition_with(&case.run.recording, &twin, &Conditioning::default());
        let track = Track::new(&samples, &twin).unwrap();
        let free = free_parameters(&twin, &[name.to_string()]).unwrap();
        let settings = servo::Settings { horizon_s: 2.0, ..servo::Settings::default() };
        let found = servo::identify(&twin, &[&track], &free, &settings, &()).unwrap();
        let parameter = &effect.about().parameters[0];
        for (j, truth) in case.truth(parameter, parameter.null).into_iter().enumerate() {
            let e = found.estimates.iter().find(|e| e.joint == Some(j + 1)).unwrap();
            assert!((e.value - truth).abs() < within * truth.abs(), "{name}: {truth}, {e:?}");
        }
    }
}
