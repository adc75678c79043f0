//! Hand-made answers to grafts and to the same pair untouched.

use super::super::tests::{answer, cause, named, truth};
use super::super::{Judged, Printed, Share, judge};
use super::{agreement, found, goals, hold_against_base};
use crate::diagnosis::{Cause, Named, Verdict};
use crate::trials::score::tenths::tenths;
use crate::trials::{Answer, Kind};

fn judged(case: &str, kind: Kind, hidden: &[Named], answer: &Answer) -> Judged {
    let mut truth = truth(kind, hidden);
    truth.case = case.into();
    truth.base = (kind != Kind::Untouched).then(|| "base".into());
    truth.recordings = vec!["runs/one.csv.gz".into(), "runs/two.csv.gz".into()];
    judge(&truth, answer)
}

/// The untouched pair is said to lack load friction at joint 2; `causes` are said of the graft.
fn beside_base(kind: Kind, hidden: &Named, verdict: Verdict, causes: Vec<Cause>) -> Judged {
    let untouched =
        answer(Verdict::PartlyExplained, vec![cause(&named("load_friction", &[2]), &[])], &[]);
    let grafted = answer(verdict, causes, &[]);
    let mut all = [
        judged("base", Kind::Untouched, &[], &untouched),
        judged("graft", kind, std::slice::from_ref(hidden), &grafted),
    ];
    hold_against_base(&mut all);
    assert_eq!(all[0].printed[0].holds, None, "nobody knows what an arm lacks");
    all[1].clone()
}

#[test]
fn what_the_untouched_pair_lacks_is_no_stray() {
    let (payload, known) = (named("payload", &[]), named("load_friction", &[2]));
    let causes = vec![cause(&known, &[]), cause(&payload, &[])];
    let told = beside_base(Kind::Grafted, &payload, Verdict::Explained, causes);
    assert!(found::named(&told) && told.right && told.strays.is_empty() && !told.wrong);
    assert_eq!(told.printed.iter().map(|p| p.holds).collect::<Vec<_>>(), [None, Some(true)]);
}

#[test]
fn the_same_effect_at_another_joint_is_a_stray() {
    let (payload, elsewhere) = (named("payload", &[]), named("load_friction", &[3]));
    let causes = vec![cause(&elsewhere, &[])];
    let told = beside_base(Kind::Grafted, &payload, Verdict::Explained, causes);
    assert!(!found::named(&told) && told.wrong);
    assert_eq!(told.strays, [elsewhere]);
    assert_eq!(told.printed[0].holds, Some(false));
}

/// It may be the arm's own, which shows in one pair and not in another.
#[test]
fn what_another_untouched_pair_is_told_may_be_the_arms() {
    let (payload, elsewhere) = (named("payload", &[]), named("load_friction", &[3]));
    let answer = |names: &[&Named]| {
        let causes = names.iter().map(|n| cause(n, &[])).collect();
        answer(Verdict::PartlyExplained, causes, &[])
    };
    let hidden = std::slice::from_ref(&payload);
    let mut all = [
        judged("base", Kind::Untouched, &[], &answer(&[])),
        judged("other", Kind::Untouched, &[], &answer(&[&elsewhere])),
        judged("graft", Kind::Grafted, hidden, &answer(&[&payload, &elsewhere])),
    ];
    hold_against_base(&mut all);
    let told = |p: &Printed| (p.holds, p.may_be_the_arms);
    let told: Vec<_> = all[2].printed.iter().map(told).collect();
    assert_eq!(told, [(Some(true), false), (Some(false), true)]);
    assert_eq!(all[2].strays, [elsewhere]);
    let [tenth] = &tenths(all[2].printed.iter())[9..] else { panic!("ten of them") };
    assert_eq!(
        (tenth.true_ones, tenth.at_best),
        (Share { hits: 1, of: 2 }, Share { hits: 2, of: 2 })
    );
}

#[test]
fn equals_are_no_strays() {
    let payload = named("payload", &[]);
    let equal = cause(&named("link_inertia", &[6]), std::slice::from_ref(&payload));
    let base_too = cause(&named("viscous_cubic", &[2]), &[named("load_friction", &[2])]);
    let told = beside_base(Kind::Grafted, &payload, Verdict::Explained, vec![equal, base_too]);
    assert!(found::named(&told) && !told.all && told.strays.is_empty());
}

#[test]
fn a_graft_of_what_is_lacking_anyway_proves_nothing() {
    let known = named("load_friction", &[2]);
    let told = beside_base(Kind::Grafted, &known, Verdict::Explained, vec![cause(&known, &[])]);
    assert!(told.in_base && found::asked(&[told]).is_empty());
}

#[test]
fn a_foreign_graft_is_to_be_left_unnamed_and_not_called_explained() {
    let (rubbing, known) = (named("rubbing", &[4]), named("load_friction", &[2]));
    let told = |verdict, names: &[&Named]| {
        let causes = names.iter().map(|n| cause(n, &[])).collect();
        beside_base(Kind::GraftedForeign, &rubbing, verdict, causes)
    };
    assert!(told(Verdict::PartlyExplained, &[&known]).right);
    assert!(told(Verdict::Unexplained, &[]).right);
    assert!(!told(Verdict::Explained, &[&known]).right);
    let other = told(Verdict::PartlyExplained, &[&known, &named("stribeck", &[4])]);
    assert!(other.wrong && !other.right);
}

fn untouched(verdict: Verdict, causes: Vec<Cause>, fraction: f64) -> Judged {
    let mut told = answer(verdict, causes, &[]);
    told.diagnosis.as_mut().unwrap().shrink.torque.fraction = fraction;
    judged("case-0000", Kind::Untouched, &[], &told)
}

#[test]
fn untouched_pairs_agree_by_their_first_cause_or_its_equals() {
    let (known, other) = (named("load_friction", &[2]), named("viscous_cubic", &[2]));
    let explained = |c: Cause| untouched(Verdict::Explained, vec![c, cause(&other, &[])], 0.5);
    let all = [
        explained(cause(&known, &[])),
        explained(cause(&known, &[])),
        explained(cause(&other, std::slice::from_ref(&known))),
        explained(cause(&named("load_friction", &[3]), &[])),
        untouched(Verdict::Unexplained, vec![], 0.4),
        untouched(Verdict::Unexplained, vec![], 0.1),
    ];
    let found = agreement(&all);
    assert_eq!((found.same, found.leading), (Share { hits: 3, of: 6 }, Some(known)));
    assert_eq!(found.unexplained, Share { hits: 1, of: 6 });
    let quiet = untouched(Verdict::NoGap, vec![], 0.0);
    assert_eq!(agreement(&[quiet.clone(), quiet]).same, Share { hits: 2, of: 2 });
}

#[test]
fn grafts_are_held_against_the_goal_of_their_strength() {
    let payload = named("payload", &[]);
    let told = |strength: f64, causes: Vec<Cause>| {
        let mut told = beside_base(Kind::Grafted, &payload, Verdict::Explained, causes);
        (told.drawn, told.strength) = (Some(strength), 0.9 * strength);
        told
    };
    let all = [
        told(1.0, vec![cause(&payload, &[])]),
        told(4.0, vec![cause(&payload, &[])]),
        told(4.0, vec![cause(&named("base_tilt", &[]), &[])]),
    ];
    let goals = goals(&all);
    let met = |figure: &str| goals.iter().find(|g| g.figure.ends_with(figure)).unwrap().met;
    assert_eq!([met("strength .5"), met("strength 1")], [None, Some(true)]);
    assert_eq!([met("strength 4"), met("strays, grafts")], [Some(false); 2]);
    assert_eq!(met("same leading cause"), None);
    let glance = found::by_effect(&all);
    assert!(glance.contains("| payload | 1 / 1 | 1 / 2 | 2 / 3 |"), "{glance}");
}

#[test]
fn a_tenth_that_is_off_is_flagged_where_it_has_causes_enough() {
    let printed = |probability: f64, holds: Option<bool>| Printed {
        named: named("payload", &[]),
        equivalent: vec![],
        probability,
        holds,
        may_be_the_arms: false,
    };
    let mut all = vec![printed(0.95, Some(true)); 28];
    all.extend(vec![printed(0.95, Some(false)); 2]);
    all.extend(vec![printed(0.15, Some(true)); 30]);
    all.extend(vec![printed(0.35, Some(true)); 29]);
    all.extend(vec![printed(1.0, None); 50]);
    let tenths = tenths(all.iter());
    assert_eq!(tenths[9].true_ones, Share { hits: 28, of: 30 });
    assert_eq!([9, 1, 3, 5].map(|i| tenths[i].is_off()), [Some(false), Some(true), None, None]);
}
