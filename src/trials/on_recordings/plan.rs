//! Which cases a trial on recordings has: all pairs untouched, and effects by strength at random
//! pairs; shuffled, so that a number tells nothing.

use rand::SeedableRng;
use rand::seq::{IndexedRandom, SliceRandom};
use rand_chacha::ChaCha8Rng;

use super::{DrawOn, Ground, foreign};
use crate::effects::{CATALOGUE, DriveKind, Effect, Seen};
use crate::trials::case::case_name;
use crate::trials::plan::graded;
use crate::trials::{Kind, TrialError};
use crate::twin::Twin;

/// An effect and how strong it is to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wanted {
    pub effect: &'static str,
    pub strength: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    pub number: usize,
    /// Recordings to fit and to check.
    pub pair: [usize; 2],
    pub graft: Option<Wanted>,
    /// The case with the same pair untouched.
    pub base: Option<String>,
}

impl Plan {
    pub fn name(&self) -> String {
        case_name(self.number)
    }

    /// Random generator of this case alone.
    pub fn rng(&self, seed: u64) -> ChaCha8Rng {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(1 + self.number as u64);
        rng
    }
}

/// All cases in random order. Where `only` does not ask for untouched ones, the pairs that grafts
/// need.
///
/// # Errors
/// If a strength is none.
pub fn plans(
    how: &DrawOn,
    names: &[&'static str],
    recordings: usize,
) -> Result<Vec<Plan>, TrialError> {
    if let Some(bad) = how.strengths.iter().find(|s| !(s.is_finite() && **s > 0.0)) {
        return Err(TrialError::Usage(format!("--strengths {bad}: give numbers above 0")));
    }
    let mut rng = ChaCha8Rng::seed_from_u64(how.seed);
    let pairs = ordered_pairs(recordings);
    let mut graded = graded(Kind::Grafted, names, &how.strengths, &mut rng);
    graded.retain(|p| !p.effects.is_empty());
    let count = how.cases.unwrap_or(graded.len()) * usize::from(!graded.is_empty());
    let wanted = graded.iter().cycle().take(count).filter_map(|p| {
        let (effect, strength) = *p.effects.first()?;
        Some(Wanted { effect, strength: strength? })
    });
    let mut all: Vec<([usize; 2], Option<Wanted>)> = Vec::new();
    for wanted in wanted {
        let pair = *pairs.choose(&mut rng).unwrap_or(&[0, 0]);
        all.push((pair, Some(wanted)));
    }
    let every = how.only.is_empty() || how.only.iter().any(|o| o == Kind::Untouched.name());
    let used = |pair: &[usize; 2]| every || all.iter().any(|(p, _)| p == pair);
    let bases: Vec<_> = pairs.iter().copied().filter(used).map(|pair| (pair, None)).collect();
    all.extend(bases);
    all.shuffle(&mut rng);
    Ok(numbered(all))
}

fn numbered(all: Vec<([usize; 2], Option<Wanted>)>) -> Vec<Plan> {
    let base = |pair: &[usize; 2]| {
        let number = all.iter().position(|(p, graft)| p == pair && graft.is_none());
        number.map(case_name)
    };
    let plan = |(number, (pair, graft)): (usize, &([usize; 2], Option<Wanted>))| Plan {
        number,
        pair: *pair,
        graft: *graft,
        base: graft.and_then(|_| base(pair)),
    };
    all.iter().enumerate().map(plan).collect()
}

fn ordered_pairs(n: usize) -> Vec<[usize; 2]> {
    let others = |i: usize| (0..n).filter(move |k| *k != i).map(move |k| [i, k]);
    (0..n).flat_map(others).collect()
}

/// Names of the effects to graft.
///
/// # Errors
/// If `only` holds a name that is neither a kind nor an effect that can be grafted.
pub fn graftable(
    how: &DrawOn,
    twin: &Twin,
    grounds: &[Ground],
) -> Result<Vec<&'static str>, TrialError> {
    let open: Vec<&str> = twin.open().map(|e| e.about().name).collect();
    let catalogue = CATALOGUE.iter().copied().filter(|e| {
        let fitted = open.contains(&e.about().name);
        e.seen() != Seen::Simulation
            && !fitted
            && e.of_drive() != DriveKind::Servo
            && recorded(*e, grounds)
    });
    let named = |kind: Kind, e: &dyn Effect| (kind, e.about().name);
    let all: Vec<(Kind, &'static str)> = catalogue
        .map(|e| named(Kind::Grafted, e))
        .chain(foreign::all().map(|e| named(Kind::GraftedForeign, e)))
        .collect();
    refuse_unknown(&how.only, &all)?;
    let is_wanted = |(kind, name): &(Kind, &str)| {
        how.only.is_empty() || how.only.iter().any(|o| o == name || o == kind.name())
    };
    Ok(all.into_iter().filter(is_wanted).map(|(_, name)| name).collect())
}

/// Do the recordings hold the channels in which the effect shows?
fn recorded(effect: &dyn Effect, grounds: &[Ground]) -> bool {
    grounds.iter().all(|g| match effect.about().name {
        "temperature_friction" => g.samples.temperature.is_some(),
        "velocity_lag" => g.samples.sensed.is_some(),
        _ => true,
    })
}

fn refuse_unknown(only: &[String], all: &[(Kind, &'static str)]) -> Result<(), TrialError> {
    let kinds = Kind::ON_RECORDINGS.map(Kind::name);
    let known = |o: &&String| kinds.contains(&o.as_str()) || all.iter().any(|(_, n)| n == o);
    match only.iter().find(|o| !known(o)) {
        None => Ok(()),
        Some(name) => {
            let effects: Vec<_> = all.iter().map(|(_, n)| *n).collect();
            Err(TrialError::Usage(format!(
                "--only {name}: is neither a kind ({}) nor an effect that can be grafted onto these \
                 recordings ({})",
                kinds.join(", "),
                effects.join(", ")
            )))
        }
    }
}
