//! Which cases a trial has: kinds, effects, strengths; shuffled, so that a number tells nothing.

use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::asked::Family;
use super::foreign::FOREIGN;
use super::{Kind, TrialError};
use crate::effects::{CATALOGUE, DriveKind, Effect, Seen};

/// Strengths effects are drawn at.
const STRENGTHS: [f64; 4] = [0.3, 1.0, 3.0, 10.0];

/// How many of 100 cases are of each kind.
const PARTS: [(Kind, usize); 6] = [
    (Kind::Clean, 25),
    (Kind::Single, 45),
    (Kind::Pair, 10),
    (Kind::Withheld, 10),
    (Kind::Foreign, 6),
    (Kind::Unseen, 4),
];

/// What every twin has open and therefore is no gap.
const KNOWN: [&str; 2] = ["coulomb", "viscous"];

#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    pub kind: Kind,
    /// Name and strength; no strength for what torque does not show.
    pub effects: Vec<(&'static str, Option<f64>)>,
}

/// `cases` plans in random order. `only` limits them to kinds or effects, by name.
///
/// # Errors
/// If `only` holds a name that is neither.
pub fn plans(
    cases: usize,
    only: &[String],
    family: Family,
    rng: &mut ChaCha8Rng,
) -> Result<Vec<Plan>, TrialError> {
    refuse_unknown(only)?;
    let kinds: Vec<Kind> =
        Kind::SIMULATED.into_iter().filter(|k| only.iter().any(|o| o == k.name())).collect();
    let wanted = |k: Kind| kinds.is_empty() || kinds.contains(&k);
    let pools: Vec<(usize, Vec<Plan>)> = PARTS
        .into_iter()
        .filter(|(kind, _)| wanted(*kind))
        .map(|(kind, parts)| (parts, pool(kind, only, family, rng)))
        .filter(|(_, pool)| !pool.is_empty())
        .collect();
    let counts = shares(cases, &pools.iter().map(|p| p.0).collect::<Vec<_>>());
    let mut plans: Vec<Plan> = pools
        .into_iter()
        .zip(counts)
        .flat_map(|((_, pool), n)| pool.into_iter().cycle().take(n).collect::<Vec<_>>())
        .collect();
    plans.shuffle(rng);
    Ok(plans)
}

fn refuse_unknown(only: &[String]) -> Result<(), TrialError> {
    let effects = || CATALOGUE.iter().chain(FOREIGN).map(|e| e.about().name);
    let kinds = || Kind::SIMULATED.into_iter().map(Kind::name);
    match only.iter().find(|o| !effects().chain(kinds()).any(|n| n == o.as_str())) {
        None => Ok(()),
        Some(name) => {
            let (kinds, effects) = (kinds().collect::<Vec<_>>(), effects().collect::<Vec<_>>());
            Err(TrialError::Usage(format!(
                "--only {name}: is neither a kind ({}) nor an effect ({})",
                kinds.join(", "),
                effects.join(", ")
            )))
        }
    }
}

/// Effects that show in what is recorded of an arm; of servos that is command and position.
fn of_arm(family: Family) -> impl Iterator<Item = &'static dyn Effect> {
    let servos = family == Family::Servos;
    let other = if servos { DriveKind::Current } else { DriveKind::Servo };
    let shows = move |e: &&dyn Effect| {
        let recorded = e.needs().is_none() && e.seen() != Seen::Simulation;
        e.of_drive() != other && (recorded || !servos)
    };
    CATALOGUE.iter().copied().filter(shows)
}

/// All there is of a kind, in the order it is to be drawn.
fn pool(kind: Kind, only: &[String], family: Family, rng: &mut ChaCha8Rng) -> Vec<Plan> {
    let all = CATALOGUE.iter().chain(FOREIGN).map(|e| e.about().name);
    let chosen: Vec<&str> = all.filter(|n| only.iter().any(|o| o == n)).collect();
    let wanted = |name: &&'static str| chosen.is_empty() || chosen.contains(name);
    type Effects = Vec<&'static dyn Effect>;
    let unseen = |e: &&'static dyn Effect| e.seen() == Seen::Simulation;
    let names = |list: &[&'static dyn Effect]| -> Vec<&'static str> {
        list.iter().map(|e| e.about().name).filter(wanted).collect()
    };
    let (hidden, seen): (Effects, Effects) = of_arm(family).partition(unseen);
    let seen: Effects = seen.into_iter().filter(|e| !KNOWN.contains(&e.about().name)).collect();
    match kind {
        Kind::Clean if chosen.is_empty() || only.iter().any(|o| o == kind.name()) => {
            vec![Plan { kind, effects: vec![] }]
        }
        Kind::Clean => vec![],
        Kind::Single => graded(kind, &names(&seen), &STRENGTHS, rng),
        Kind::Withheld => graded(kind, &names(&seen), &STRENGTHS[1..], rng),
        Kind::Foreign => graded(kind, &names(FOREIGN), &STRENGTHS[1..], rng),
        Kind::Unseen => names(&hidden)
            .into_iter()
            .map(|name| Plan { kind, effects: vec![(name, None)] })
            .collect(),
        Kind::Pair => pairs(&names(&seen), rng),
        Kind::Untouched | Kind::Grafted | Kind::GraftedForeign => vec![],
    }
}

/// Round after round of all effects, each round in another order and each effect at a strength it
/// has not had yet.
pub(super) fn graded(
    kind: Kind,
    names: &[&'static str],
    strengths: &[f64],
    rng: &mut ChaCha8Rng,
) -> Vec<Plan> {
    let shuffled = |rng: &mut ChaCha8Rng| {
        let mut order = strengths.to_vec();
        order.shuffle(rng);
        order
    };
    let orders: Vec<Vec<f64>> = names.iter().map(|_| shuffled(rng)).collect();
    let mut plans = Vec::new();
    for round in 0..strengths.len() {
        let with_strength = names.iter().zip(&orders);
        let plan = |(name, order): (&&'static str, &Vec<f64>)| Plan {
            kind,
            effects: vec![(*name, Some(order[round]))],
        };
        let mut all: Vec<Plan> = with_strength.map(plan).collect();
        all.shuffle(rng);
        plans.extend(all);
    }
    plans
}

/// Every effect with the next of a shuffled list, at two strengths.
fn pairs(names: &[&'static str], rng: &mut ChaCha8Rng) -> Vec<Plan> {
    let mut names = names.to_vec();
    names.shuffle(rng);
    let strengths = [(1.0, 3.0), (3.0, 3.0), (3.0, 10.0), (10.0, 1.0)];
    let pair = |(i, (a, b)): (usize, (f64, f64))| {
        let next = |step: usize| names[(i + step) % names.len()];
        (next(0) != next(1)).then(|| Plan {
            kind: Kind::Pair,
            effects: vec![(next(0), Some(a)), (next(1), Some(b))],
        })
    };
    let n = 2 * names.len();
    strengths.into_iter().cycle().take(n).enumerate().filter_map(pair).collect()
}

/// `total` split in proportion to `parts`, by largest remainder.
fn shares(total: usize, parts: &[usize]) -> Vec<usize> {
    let sum: usize = parts.iter().sum::<usize>().max(1);
    let mut counts: Vec<usize> = parts.iter().map(|p| total * p / sum).collect();
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by_key(|i| std::cmp::Reverse(total * parts[*i] % sum));
    let rest = total - counts.iter().sum::<usize>().min(total);
    order.into_iter().cycle().take(if parts.is_empty() { 0 } else { rest }).for_each(|i| {
        counts[i] += 1;
    });
    counts
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    fn drawn(cases: usize, only: &[&str]) -> Vec<Plan> {
        let only: Vec<String> = only.iter().map(ToString::to_string).collect();
        plans(cases, &only, Family::Standard, &mut ChaCha8Rng::seed_from_u64(1)).unwrap()
    }

    #[test]
    fn a_full_trial_has_every_effect_at_every_strength_and_a_hundred_clean_cases() {
        let plans = drawn(420, &[]);
        assert_eq!(plans.len(), 420);
        let count = |kind| plans.iter().filter(|p| p.kind == kind).count();
        assert!(count(Kind::Clean) >= 100 && count(Kind::Pair) >= 40 && count(Kind::Foreign) >= 24);
        for effect in of_arm(Family::Standard).filter(|e| e.seen() != Seen::Simulation) {
            let name = effect.about().name;
            for strength in STRENGTHS {
                let hides =
                    |p: &Plan| p.kind == Kind::Single && p.effects == [(name, Some(strength))];
                assert!(KNOWN.contains(&name) || plans.iter().any(hides), "{name} at {strength}");
            }
            let withheld = |p: &Plan| p.kind == Kind::Withheld && p.effects[0].0 == name;
            assert!(KNOWN.contains(&name) || plans.iter().any(withheld), "{name} never withheld");
        }
        assert!(plans.iter().filter(|p| p.kind == Kind::Pair).all(|p| p.effects.len() == 2));
    }

    #[test]
    fn only_limits_to_kinds_and_effects() {
        assert!(drawn(7, &["clean"]).iter().all(|p| p.kind == Kind::Clean));
        let payload = drawn(9, &["single", "payload"]);
        assert_eq!(payload.len(), 9);
        assert!(payload.iter().all(|p| p.kind == Kind::Single && p.effects[0].0 == "payload"));
        let mixed = drawn(12, &["clean", "single", "payload"]);
        assert!(mixed.iter().any(|p| p.kind == Kind::Clean));
        let only = ["paylod".to_string()];
        let refused = plans(1, &only, Family::Standard, &mut ChaCha8Rng::seed_from_u64(1));
        assert!(refused.unwrap_err().to_string().contains("paylod"));
    }

    #[test]
    fn shares_add_up() {
        assert_eq!(shares(4, &[25, 45, 10, 10, 6, 4]).iter().sum::<usize>(), 4);
        assert_eq!(shares(420, &[25, 75]), [105, 315]);
        assert!(shares(3, &[]).is_empty());
    }
}
