//! What is printed of a diagnosis made by hand.

use super::{brief, causes, page};
use crate::diagnosis::{
    Cause, Checked, Criteria, CrossValidated, Dependence, Diagnosis, Episode, Gap, JointGap,
    JointShrink, Named, Position, PositionShrink, Ranked, Regime, Replaced, Shrink,
    SimulationShrink, TorqueShrink, Unexplained, UnexplainedJoint, Untestable, Value, Verdict,
    words,
};

fn unexplained(above_noise: bool) -> Unexplained {
    let joint = |joint: usize, rms_nm: f64| UnexplainedJoint {
        joint,
        rms_nm,
        beyond_tolerances_nm: None,
        noise_floor_nm: 0.5,
        discrepancy_nm: 0.0,
        depends_on: vec![Dependence { variable: format!("q_{joint}"), share: 0.4 }],
    };
    let joints = vec![joint(1, 0.6), joint(2, 1.2)];
    Unexplained {
        rms_nm: 0.9,
        fraction: 0.1,
        above_noise,
        noise_over_floor: 1.0,
        joints,
        ..Unexplained::default()
    }
}

fn by_hand() -> Diagnosis {
    let regime = |name: &str, rms_nm: f64| Regime {
        regime: name.into(),
        rms_nm,
        low_nm: 0.9 * rms_nm,
        high_nm: 1.1 * rms_nm,
        noise_floor_nm: 0.5,
        time_fraction: 0.3,
    };
    let joint = |joint: usize, rms_nm: f64| JointGap {
        joint,
        rms_nm,
        low_nm: 0.9 * rms_nm,
        high_nm: 1.1 * rms_nm,
        rms_rad: None,
        noise_floor_rad: None,
        noise_floor_nm: 0.5,
        floor_from: "estimate".into(),
        share: rms_nm / 4.0,
        regimes: vec![regime("slow", 2.0 * rms_nm), regime("back_driven", rms_nm)],
    };
    let ranked = |effect: &str, probability: f64| Ranked {
        effect: effect.into(),
        joints: vec![],
        probability,
        nats: 812.25,
    };
    let mass = Value {
        name: "payload_mass".into(),
        joint: None,
        unit: "kg".into(),
        value: 2.805,
        low: 2.7,
        high: 2.9,
        at_bound: false,
    };
    let untestable = |joint: usize| Untestable {
        effect: "temperature_friction".into(),
        joints: vec![joint],
        why: "no temperatures are recorded".into(),
    };
    let small = |effect: &str, errors: f64| Untestable {
        effect: effect.into(),
        joints: vec![3],
        why: format!("it would be {errors} errors large, 4 are needed"),
    };
    Diagnosis {
        schema: "armtwin.diagnosis/1".into(),
        armtwin: "0.0.0".into(),
        by: crate::diagnosis::By::default(),
        position: None,
        verdict: Verdict::Explained,
        gap: Gap { joints: vec![joint(1, 1.0), joint(2, 3.0)] },
        adjustments: vec![],
        causes: vec![Cause {
            effect: "payload".into(),
            joints: vec![],
            probability: 0.97,
            equivalent: vec![Named { effect: "link_inertia".into(), joints: vec![6] }],
            parameters: vec![mass],
            shrink: Checked {
                check_before_nm: 3.2,
                check_after_nm: 0.5,
                fraction: 0.9756,
                low: 0.95,
                high: 0.98,
            },
            replaces: None,
            recording: None,
            found_without_check: true,
            cause: "a tool at the flange".into(),
            remedy: "add a body".into(),
        }],
        shrink: Shrink {
            torque: TorqueShrink {
                before_nm: 3.2,
                after_nm: 0.5,
                fraction: 0.9756,
                low: 0.95,
                high: 0.98,
                noise_floor_nm: 0.5,
                reducible: 0.999,
                joints: vec![JointShrink {
                    joint: 1,
                    before_nm: 1.0,
                    after_nm: 0.5,
                    fraction: 0.75,
                }],
            },
            simulation: Some(SimulationShrink {
                before_rad: 0.012,
                after_rad: 0.001,
                fraction: 0.993,
                window_s: 0.2,
                ..SimulationShrink::default()
            }),
        },
        ranking: vec![ranked("payload", 0.97), ranked("unknown", 0.02), ranked("none", 0.01)],
        untestable: vec![untestable(2), small("stribeck", 1.5), untestable(5), small("lugre", 0.5)],
        rejected: vec![],
        unexplained: unexplained(false),
        criteria: Criteria::default(),
        next_experiment: "slow plateaus in both directions".into(),
        fitted: Default::default(),
        fitted_before: Default::default(),
        episodes: Vec::new(),
        rounds: Vec::new(),
        notes: vec![],
    }
}

#[test]
fn the_answer_says_what_where_how_sure_and_how_far() {
    let said = words::sentence(&by_hand());
    let parts = [
        "payload or link_inertia at joint 6 (payload_mass 2.81 kg; 97 % sure)",
        "from 3.20 to 0.50 N.m",
        "no more than noise",
    ];
    for part in parts {
        assert!(said.contains(part), "no {part:?} in {said}");
    }
    let replaces = Some(Replaced { parameter: "payload_mass".into(), twin: 0.14 });
    let mut changed = by_hand();
    changed.causes[0].replaces = replaces;
    changed.unexplained = unexplained(true);
    changed.verdict = Verdict::PartlyExplained;
    let said = words::sentence(&changed);
    let parts = ["2.81 kg, the twin has 0.14", "0.50 N.m stay", "joint 2, going along with q_2"];
    for part in parts {
        assert!(said.contains(part), "no {part:?} in {said}");
    }
    let none = Diagnosis { verdict: Verdict::NoGap, causes: vec![], ..by_hand() };
    assert!(words::sentence(&none).starts_with("No gap"), "{}", words::sentence(&none));
    let foreign = Diagnosis { verdict: Verdict::Unexplained, causes: vec![], ..by_hand() };
    let said = words::sentence(&foreign);
    assert!(said.contains("75 % of it on joint 2") && said.contains("any shape"), "{said}");
}

/// The arm carried something in one recording alone.
#[test]
fn what_makes_the_check_recording_worse_explains_nothing() {
    let mut worse = by_hand();
    let torque = &mut worse.shrink.torque;
    (torque.after_nm, torque.fraction, torque.low, torque.high) = (9.6, -8.0, -9.0, -7.0);
    let said = [words::headline(&worse), words::sentence(&worse), words::how_far(&worse)];
    assert!(
        said[0].starts_with("What is found on one recording makes the other worse"),
        "{}",
        said[0]
    );
    assert!(said[1].contains("the gap grows from 3.20 to 9.60 N.m"), "{}", said[1]);
    assert!(said.iter().all(|s| s.contains("makes the other worse") && !s.contains("explained")));
    worse.unexplained =
        Unexplained { rms_nm: 2.0, beyond_tolerances_nm: Some(1.5), ..unexplained(false) };
    assert_eq!(words::headline(&worse), said[0], "links that take a third hide nothing");
}

/// Most of a gap may be what the twin states within limits; what a search explains comes after it.
#[test]
fn what_links_take_within_what_they_are_known_to_comes_first() {
    let mut within = by_hand();
    within.shrink.torque.reducible = 0.3;
    within.unexplained = Unexplained { rms_nm: 2.1, ..unexplained(false) };
    let first = |d: &Diagnosis| words::headline(d);
    assert!(first(&within).starts_with("30 % of the gap above the noise is explained"));
    within.unexplained.beyond_tolerances_nm = Some(0.6);
    let said = first(&within);
    assert!(
        said.starts_with("85 % of the gap above the noise goes with links and torque"),
        "{said}"
    );
    assert!(said.contains("Besides, the twin lacks payload"), "{said}");
}

/// What comes again is told with its own cycle, and is no push.
#[test]
fn what_comes_again_with_the_motion_is_told_beside_pushes() {
    let episode = |recording: &str, every_s| Episode {
        recording: recording.into(),
        start: 11.0,
        end: 11.2,
        joints: vec![1],
        peak_nm: 7.0,
        force_n: [0.0; 3],
        explained: 0.9,
        every_s,
        touch: None,
    };
    let episodes =
        vec![episode("fit", Some(20.0)), episode("check", Some(8.0)), episode("check", None)];
    let d = Diagnosis { episodes, ..by_hand() };
    let said = words::come_again(&d);
    let told = "11.0 to 11.2 s (fit, every 20.0 s), 11.0 to 11.2 s (check, every 8.0 s)";
    assert!(said.contains(told), "{said}");
    assert!(brief::findings(&d).contains("Comes again with the motion"));
    assert_eq!(words::suspicions(&d), "11.0 to 11.2 s (check)");
}

/// A lagging velocity takes no torque off: what does is told, and that it is not sure.
#[test]
fn torque_is_not_explained_by_a_velocity() {
    let mut lags = by_hand();
    lags.adjustments = std::mem::take(&mut lags.causes);
    let lag = Cause { effect: "velocity_lag".into(), ..lags.adjustments[0].clone() };
    lags.causes = vec![Cause { parameters: vec![], equivalent: vec![], ..lag }];
    let said = words::headline(&lags);
    let parts = ["goes with payload, of which none is sure", "the twin lacks velocity_lag"];
    assert!(parts.iter().all(|part| said.contains(part)), "{said}");
    lags.adjustments.clear();
    lags.unexplained.above_noise = true;
    let said = words::headline(&lags);
    assert!(
        said.starts_with("No effect surely explains the") && said.contains("velocity_lag"),
        "{said}"
    );
    lags.unexplained.above_noise = false;
    assert!(words::headline(&lags).starts_with("The twin lacks velocity_lag"));
}

#[test]
fn everything_found_is_on_the_page() {
    let text = page::findings(&by_hand());
    assert!(text.starts_with("The twin lacks payload"), "{text}");
    let parts = [
        "back driven",
        "6.000+",
        "payload_mass",
        "2.805",
        "link_inertia at joint 6",
        "no temperatures are recorded: temperature_friction (joints 2, 5)",
        "it would be .. errors large, 4 are needed: stribeck (joint 3), lugre (joint 3)",
        "99.9 %",
        "12 mrad",
        "slow plateaus",
        "0.600",
    ];
    for part in parts {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }
    let order = ["Where", "causes", "candidates", "How far", "cannot test", "What stays", "Next"];
    let places: Vec<_> =
        order.iter().map(|t| text.find(t).unwrap_or_else(|| panic!("{t}"))).collect();
    assert!(places.is_sorted(), "{places:?}\n{text}");
}

#[test]
fn what_is_not_there_has_no_title() {
    let none = Diagnosis { causes: vec![], untestable: vec![], ..by_hand() };
    let text = page::findings(&none);
    assert!(!text.contains("causes, strongest") && !text.contains("cannot test"), "{text}");
    assert_eq!(causes::section(&Diagnosis { causes: vec![], ..by_hand() }), "");
}

/// Of position servos the position counts, whatever torque along another motion says.
#[test]
fn of_position_servos_a_cause_takes_position_off() {
    let mut d = by_hand();
    let Cause { effect, joints, .. } = d.causes[0].clone();
    let (before_rad, after_rad, fraction) = (0.02, 0.012, 0.64);
    let own = PositionShrink { effect, joints, before_rad: Some(before_rad), after_rad, fraction };
    let cross_validated = CrossValidated { before_rad: 0.03, after_rad: 0.01 };
    d.position = Some(Position {
        before_rad,
        after_rad,
        fraction,
        cross_validated,
        birge_ratio: 1.0,
        time_offset: None,
        step_s: None,
        joints: vec![],
        causes: vec![own],
    });
    assert_eq!(words::takes_off(&d, &d.causes[0]), ("20.00 -> 12.00 mrad".into(), 0.64));
    let full = causes::section(&d);
    assert!(full.contains("20.00 -> 12.00 mrad") && full.contains("64 %"), "{full}");
    let short = brief::findings(&d);
    assert!(short.contains("64 %") && !short.contains("torque   "), "{short}");
    assert!(words::how_far(&d).contains("30.00 to 10.00 mrad"), "{}", words::how_far(&d));
    let own = &mut d.position.as_mut().unwrap().causes[0];
    (own.before_rad, own.fraction) = (None, 1.0);
    assert_eq!(words::takes_off(&d, &d.causes[0]), ("runs away -> 12.00 mrad".into(), 1.0));
    // Programs read what was written.
    let written = serde_json::to_string(&d).unwrap();
    assert_eq!(serde_json::from_str::<crate::diagnosis::Diagnosis>(&written).unwrap(), d);
}
