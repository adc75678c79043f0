//! Hand-made answers, judged.

use super::goals::goals;
use super::judged::judge;
use super::rows::{brier, coverage, level, of_oracle};
use super::{Judged, Share};
use crate::diagnosis::{
    Cause, Checked, Criteria, Diagnosis, Gap, Named, Ranked, Settings, Shrink, Unexplained, Value,
    Verdict,
};
use crate::signals::Conditioning;
use crate::trials::{Answer, BaselineAnswer, Hidden, Kind, Method, Strength, TrueValue, Truth};

pub(super) fn named(effect: &str, joints: &[usize]) -> Named {
    Named { effect: effect.into(), joints: joints.into() }
}

pub(super) fn truth(kind: Kind, effects: &[Named]) -> Truth {
    let strength =
        Strength { drawn: Some(3.0), own: vec![4.0; 6], gap: vec![0.0, 3.0, 0.0, 0.0, 0.0, 0.0] };
    let hidden = |n: &Named| Hidden {
        effect: n.effect.clone(),
        joints: n.joints.clone(),
        parameters: vec![TrueValue { name: "size".into(), values: vec![2.0] }],
        strength: strength.clone(),
    };
    Truth {
        schema: String::new(),
        armtwin: String::new(),
        case: "case-0000".into(),
        kind,
        effects: effects.iter().map(hidden).collect(),
        family: String::new(),
        noise_nm: vec![],
        third: false,
        recordings: Vec::new(),
        base: None,
        made: serde_json::Value::Null,
    }
}

/// A cause with a probability of .9 and one parameter, 2.2 in 1.9 to 2.5.
pub(super) fn cause(name: &Named, equivalent: &[Named]) -> Cause {
    Cause {
        effect: name.effect.clone(),
        joints: name.joints.clone(),
        probability: 0.9,
        equivalent: equivalent.to_vec(),
        parameters: vec![Value {
            name: "size".into(),
            joint: None,
            unit: String::new(),
            value: 2.2,
            low: 1.9,
            high: 2.5,
            at_bound: false,
        }],
        shrink: Checked::default(),
        replaces: None,
        recording: None,
        found_without_check: true,
        cause: String::new(),
        remedy: String::new(),
    }
}

pub(super) fn answer(
    verdict: Verdict,
    causes: Vec<Cause>,
    ranking: &[(&str, &[usize], f64)],
) -> Answer {
    let ranked = |(effect, joints, probability): &(&str, &[usize], f64)| Ranked {
        effect: (*effect).into(),
        joints: joints.to_vec(),
        probability: *probability,
        nats: 0.0,
    };
    let diagnosis = Diagnosis {
        adjustments: vec![],
        schema: String::new(),
        armtwin: String::new(),
        by: crate::diagnosis::By::default(),
        position: None,
        verdict,
        gap: Gap::default(),
        causes,
        shrink: Shrink::default(),
        ranking: ranking.iter().map(ranked).collect(),
        untestable: vec![],
        rejected: vec![],
        unexplained: Unexplained::default(),
        criteria: Criteria::default(),
        next_experiment: String::new(),
        fitted: Default::default(),
        fitted_before: Default::default(),
        episodes: Vec::new(),
        rounds: vec![],
        notes: vec![],
    };
    Answer {
        schema: String::new(),
        armtwin: String::new(),
        case: "case-0000".into(),
        inputs: Default::default(),
        settings: Settings::default(),
        conditioning: Conditioning::default(),
        diagnosis: Some(diagnosis),
        failed: None,
        baselines: vec![BaselineAnswer {
            method: Method::Bic,
            named: Some(named("stribeck", &[2])),
        }],
    }
}

#[test]
fn the_right_name_is_right_with_its_joint_parameters_and_rank() {
    let stribeck = named("stribeck", &[2]);
    let judged = judge(
        &truth(Kind::Single, std::slice::from_ref(&stribeck)),
        &answer(Verdict::Explained, vec![cause(&stribeck, &[])], &[("stribeck", &[2], 0.9)]),
    );
    assert!(judged.top1 && judged.top1_set && judged.top2 && judged.joint && judged.right);
    assert!(!judged.wrong && !judged.abstained && !judged.silent && judged.all);
    assert_eq!((judged.set_size, judged.strength, judged.own), (1, 3.0, 4.0));
    assert!(judged.parameters[0].covers());
    assert!((judged.parameters[0].error().unwrap() - 0.1).abs() < 1e-12);
    assert!(judged.baselines[0].top1 && judged.baselines[0].joint);
    assert!((brier([&judged]).unwrap() - 0.01).abs() < 1e-12);
}

#[test]
fn an_equivalent_is_within_the_set_and_not_exact() {
    let (hidden, other) = (named("stribeck", &[2]), named("lugre", &[2]));
    let told = answer(Verdict::Explained, vec![cause(&other, std::slice::from_ref(&hidden))], &[]);
    let judged = judge(&truth(Kind::Single, &[hidden]), &told);
    assert!(!judged.top1 && judged.top1_set && judged.right && judged.joint && !judged.wrong);
    assert_eq!(judged.set_size, 2);
    assert!(judged.parameters.is_empty());
}

#[test]
fn another_name_is_wrong_and_the_second_of_the_ranking_counts_for_top_2() {
    let (hidden, other) = (named("stribeck", &[2]), named("lugre", &[3]));
    let ranking: &[(&str, &[usize], f64)] =
        &[("unknown", &[], 0.05), ("stribeck", &[2], 0.3), ("lugre", &[3], 0.6)];
    let told = answer(Verdict::PartlyExplained, vec![cause(&other, &[])], ranking);
    let judged = judge(&truth(Kind::Single, &[hidden]), &told);
    assert!(judged.wrong && !judged.right && !judged.top1_set && judged.top2 && !judged.joint);
    assert!((brier([&judged]).unwrap() - 0.81).abs() < 1e-12);
}

#[test]
fn the_ranking_names_where_no_cause_is_and_abstaining_is_not_wrong() {
    let hidden = named("payload", &[]);
    let ranking: &[(&str, &[usize], f64)] = &[("unknown", &[], 0.7), ("payload", &[], 0.3)];
    let told = answer(Verdict::Unexplained, vec![], ranking);
    let judged = judge(&truth(Kind::Single, std::slice::from_ref(&hidden)), &told);
    assert!(judged.top1 && judged.abstained && !judged.wrong && !judged.right);
    let foreign = judge(&truth(Kind::Foreign, &[named("hum", &[2])]), &told);
    assert!(foreign.abstained && foreign.right && foreign.probability == 0.7);
    let clean = judge(&truth(Kind::Clean, &[]), &told);
    assert!(!clean.right && clean.causes.is_empty());
}

#[test]
fn no_gap_is_right_for_clean_and_silent_elsewhere() {
    let told = answer(Verdict::NoGap, vec![], &[("none", &[], 0.97)]);
    assert!(judge(&truth(Kind::Clean, &[]), &told).right);
    let missed = judge(&truth(Kind::Foreign, &[named("hum", &[1])]), &told);
    assert!(missed.silent && !missed.abstained && !missed.right);
    assert_eq!(missed.likeliest.unwrap().effect, "none");
}

#[test]
fn all_joints_are_the_whole_arm() {
    let told = answer(
        Verdict::Explained,
        vec![cause(&named("time_delay", &[1, 2, 3, 4, 5, 6]), &[])],
        &[],
    );
    assert!(judge(&truth(Kind::Single, &[named("time_delay", &[])]), &told).top1);
}

#[test]
fn pairs_need_both() {
    let (a, b) = (named("stribeck", &[2]), named("payload", &[]));
    let hidden = truth(Kind::Pair, &[a.clone(), b.clone()]);
    let one = judge(&hidden, &answer(Verdict::PartlyExplained, vec![cause(&b, &[])], &[]));
    assert!(one.top1 && !one.all && !one.all_set);
    let other = named("link_inertia", &[6]);
    let causes = vec![cause(&a, &[]), cause(&other, std::slice::from_ref(&b))];
    let both = judge(&hidden, &answer(Verdict::Explained, causes, &[]));
    assert!(!both.all && both.all_set);
}

#[test]
fn a_failed_diagnosis_is_not_right() {
    let mut failed = answer(Verdict::NoGap, vec![], &[]);
    failed.diagnosis = None;
    assert!(!judge(&truth(Kind::Clean, &[]), &failed).right);
}

#[test]
fn shares_have_wilson_intervals() {
    let share = Share { hits: 38, of: 40 };
    let (low, high) = share.interval();
    // Newcombe, Statistics in Medicine 17, 1998: worked out by hand from eq. 3.
    assert!((low - 0.8350).abs() < 5e-4 && (high - 0.9862).abs() < 5e-4, "{low} {high}");
    assert_eq!(share.to_string(), "0.95 (38/40, 0.83-0.99)");
    assert_eq!(Share::default().to_string(), "-");
}

#[test]
fn figures_are_held_against_their_goals() {
    let hidden = named("stribeck", &[2]);
    let told = answer(Verdict::Explained, vec![cause(&hidden, &[])], &[]);
    let mut judged = judge(&truth(Kind::Single, &[hidden]), &told);
    (judged.realised, judged.oracle) = (Some(0.9), Some(1.0));
    let all = vec![judged.clone(), Judged { top1: false, top1_set: false, wrong: true, ..judged }];
    let goals = goals(&all);
    let met = |figure: &str| goals.iter().find(|g| g.figure.starts_with(figure)).unwrap().met;
    assert_eq!(met("top-1 within"), Some(false));
    assert_eq!(met("joint"), Some(true));
    assert_eq!(met("wrong name"), Some(false));
    assert_eq!(met("false alarms"), None);
    assert_eq!(met("realised"), Some(false));
    let stands_in = |realised: f64, oracle: Option<f64>| {
        Judged { realised: Some(realised), oracle, ..all[0].clone() }.stands_in()
    };
    // As good as the truth, which closes 40 % of what a simulation leaves of this arm.
    assert!(stands_in(0.39, Some(0.4)) && !stands_in(0.36, Some(0.4)));
    // The catalogue cannot state the truth: nearly all.
    assert!(stands_in(0.97, None) && !stands_in(0.9, None));
    assert_eq!(coverage(&all), Share { hits: 2, of: 2 });
    assert_eq!(of_oracle(&all), [0.9, 0.9]);
}

#[test]
fn strengths_count_to_the_nearest_level() {
    assert_eq!([0.0, 0.5, 0.6, 1.7, 1.8, 5.0, 40.0].map(level), [0, 0, 1, 1, 2, 2, 3]);
}
