//! Values of changes, fitted by simulation to one recording.

use std::collections::BTreeMap;

use super::fit::{Fit, told};
use super::parameters::with_values;
use super::{Estimate, Free, ServoError, Settings, Track, free_parameters, identify};
use crate::diagnosis::{Change, changed};
use crate::effects::{Effect, Role, Scope, find};
use crate::follow::Watch;
use crate::twin::Twin;

/// Probability that an interval of a diagnosis holds the value.
const LEVEL: f64 = 0.9;

/// A twin with values fitted by simulation.
#[derive(Clone)]
pub struct Refitted {
    pub twin: Twin,
    pub estimates: Vec<Estimate>,
}

/// Fits to one recording, beginning with the twin as given, its open values fitted.
pub struct Refits<'a> {
    twin: &'a Twin,
    fit: &'a Track,
    /// Who follows the fits.
    pub watch: &'a dyn Watch,
    pub before: Refitted,
}

impl<'a> Refits<'a> {
    /// # Errors
    /// As [`identify`].
    pub fn new(twin: &'a Twin, fit: &'a Track, watch: &'a dyn Watch) -> Result<Self, ServoError> {
        let before = Refitted { twin: twin.clone(), estimates: Vec::new() };
        let mut refits = Self { twin, fit, watch, before };
        let free = refits.free(twin, &[])?;
        if !free.is_empty() {
            let fitted = identify(twin, &[fit], &free, &Settings::default(), watch)?.twin;
            refits.before = refits.all(&fitted, &[])?;
        }
        Ok(refits)
    }

    /// The twin without a change, as near as those with one are found.
    ///
    /// # Errors
    /// As [`identify`].
    pub fn none(&self) -> Result<Twin, ServoError> {
        self.fitted(Fit::FromFar, &self.before.twin, &[], None)
    }

    /// The twin with one change, about. Good along one motion, values of the change may still be none that an arm can be
    /// led with: then from where it is absent.
    ///
    /// # Errors
    /// As [`identify`].
    pub fn alone(&self, change: &Change) -> Result<Twin, ServoError> {
        let own = std::slice::from_ref(change);
        let starts = [own, &[]].map(|c| changed(self.twin, &self.open_values(), c));
        from_either(starts, |start| self.fitted(Fit::FromFar, start, own, Some(change)))
    }

    /// `current`, which has all of `changes` but the last, about with the last as well; its values begin with those in
    /// `alone`.
    ///
    /// # Errors
    /// As [`identify`].
    pub fn beside(
        &self,
        current: &Twin,
        changes: &[Change],
        alone: &Twin,
    ) -> Result<Twin, ServoError> {
        let own = changes.last().map_or(Ok(Vec::new()), |last| parameters(alone, last))?;
        let values: Vec<f64> = own.iter().map(|f| f.start).collect();
        let with_kept = with_kept(current, alone, &own);
        let starts = [with_values(&with_kept, &own, &values), current.clone()];
        from_either(starts, |start| self.fitted(Fit::FromFar, start, changes, changes.last()))
    }

    /// A twin from [`beside`](Self::beside), to be held against one without the last change.
    ///
    /// # Errors
    /// As [`identify`].
    pub fn refined(&self, twin: &Twin, changes: &[Change]) -> Result<Twin, ServoError> {
        self.fitted(Fit::About, twin, changes, changes.last())
    }

    /// `current`, which has all of `changes`, about without the `i`th.
    ///
    /// # Errors
    /// As [`identify`].
    pub fn without(
        &self,
        current: &Twin,
        changes: &[Change],
        i: usize,
    ) -> Result<Twin, ServoError> {
        let start = taken_out(current, &self.before.twin, &changes[i]);
        let mut others = changes.to_vec();
        others.remove(i);
        from_either([start, self.before.twin.clone()], |start| {
            let near = self.fitted(Fit::FromFar, start, &others, None)?;
            self.fitted(Fit::About, &near, &others, None)
        })
    }

    /// `near` with the values of what the twin leaves open, and of the changes, fitted.
    ///
    /// # Errors
    /// As [`identify`].
    pub fn all(&self, near: &Twin, changes: &[Change]) -> Result<Refitted, ServoError> {
        self.as_is(&self.fitted(Fit::Close, near, changes, None)?, changes)
    }

    /// A twin with changes as it is, and what the recording says of its values.
    ///
    /// # Errors
    /// As [`identify`].
    pub fn as_is(&self, twin: &Twin, changes: &[Change]) -> Result<Refitted, ServoError> {
        let free = self.free(twin, changes)?;
        if free.is_empty() {
            return Ok(Refitted { twin: twin.clone(), estimates: Vec::new() });
        }
        let settings = Settings { level: LEVEL, ..Settings::default() };
        let estimates = told(twin, &[self.fit], &free, &settings)?;
        Ok(Refitted { twin: twin.clone(), estimates })
    }

    /// A fit of what may be another value `around` a change; of all values, if that is none.
    fn fitted(
        &self,
        by: Fit,
        start: &Twin,
        changes: &[Change],
        around: Option<&Change>,
    ) -> Result<Twin, ServoError> {
        let mut free = self.free(start, changes)?;
        free.retain(|f| around.is_none_or(|change| is_near(f, change)));
        if free.is_empty() {
            return Ok(start.clone());
        }
        by.of(start, &[self.fit], &free, self.watch)
    }

    /// What the twin leaves open, and the parameters of the changes where they act, with their values in `start`. They are
    /// expected near those, beside changes near those before, as far off as such effects usually are or as a search
    /// has them: what the recording does not tell stays there (friction of a joint that hardly moves).
    fn free(&self, start: &Twin, changes: &[Change]) -> Result<Vec<Free>, ServoError> {
        let open: Vec<String> = self.twin.open().map(|e| e.about().name.to_string()).collect();
        let all = |twin: &Twin| -> Result<Vec<Free>, ServoError> {
            let mut free = free_parameters(twin, &open)?;
            for change in changes {
                let mut own = parameters(twin, change)?;
                own.retain(|f| !free.iter().any(|g| is_same(f, g)));
                free.extend(own);
            }
            Ok(free)
        };
        let own = all(start)?;
        if changes.is_empty() {
            return Ok(own.into_iter().map(|f| f.near_start(start)).collect());
        }
        let before = all(&self.before.twin)?.into_iter().map(|f| f.near_start(start));
        let placed = |(before, own): (Free, Free)| {
            let linear = own.parameter.role == Role::Linear;
            let expected = if linear { before.expected } else { own.start };
            let spread = before.spread.max((own.start - expected).abs());
            Free { start: own.start, expected, spread, ..before }
        };
        Ok(before.zip(own).map(placed).collect())
    }

    /// Fitted values of what the twin leaves open.
    fn open_values(&self) -> BTreeMap<String, Vec<f64>> {
        let open = self.twin.open().flat_map(|e| e.about().parameters).map(|p| p.name);
        let fitted = &self.before.twin.values;
        open.filter_map(|name| Some((name.into(), fitted.get(name)?.clone()))).collect()
    }
}

/// The twin with what it leaves open fitted to a recording.
///
/// # Errors
/// As [`identify`].
pub fn open_fitted(twin: &Twin, fit: &Track, watch: &dyn Watch) -> Result<Twin, ServoError> {
    Ok(Refits::new(twin, fit, watch)?.before.twin)
}

/// Has a change that was fitted a value at the end of its range?
///
/// # Errors
/// If the change has no parameters that can be fitted.
pub fn is_at_bound(fitted: &Twin, change: &Change) -> Result<bool, ServoError> {
    Ok(parameters(fitted, change)?.iter().any(|f| f.is_bound(f.start)))
}

/// `twin` with those values of the effects of `own` that no fit moves, as `found` has them, where it has none.
fn with_kept(twin: &Twin, found: &Twin, own: &[Free]) -> Twin {
    let mut with = twin.clone();
    for name in own.iter().flat_map(|f| f.effect.kept()) {
        if let Some(values) = found.values.get(*name) {
            with.values.entry((*name).into()).or_insert_with(|| values.clone());
        }
    }
    with
}

fn is_same(a: &Free, b: &Free) -> bool {
    (a.parameter.name, a.joint) == (b.parameter.name, b.joint)
}

/// Does a value act where the change does? A joint's own hardly move other joints.
fn is_near(f: &Free, change: &Change) -> bool {
    let is_of_joint = |effect: &dyn Effect| effect.about().scope == Scope::Joint;
    let changes_one = find(&change.effect).is_some_and(is_of_joint) && !change.joints.is_empty();
    let elsewhere = |j: usize| !change.joints.contains(&(j + 1));
    !(changes_one && is_of_joint(f.effect) && f.joint.is_some_and(elsewhere))
}

/// Parameters of a change where it acts, with their values in `twin`: one value for all joints in the whole arm.
fn parameters(twin: &Twin, change: &Change) -> Result<Vec<Free>, ServoError> {
    let all = free_parameters(twin, std::slice::from_ref(&change.effect))?;
    let acts = |joint: usize| match change.joints.is_empty() {
        true => joint == 0,
        false => change.joints.contains(&(joint + 1)),
    };
    let own = all.into_iter().filter(|f| f.joint.is_none_or(acts));
    let alike = |f: Free| Free { joint: f.joint.filter(|_| !change.joints.is_empty()), ..f };
    Ok(own.map(alike).collect())
}

/// `mended` with the values of one change as `twin` has them, all others as they are.
pub fn taken_out(mended: &Twin, twin: &Twin, change: &Change) -> Twin {
    let mut without = mended.clone();
    let acts = |joint: usize| change.joints.is_empty() || change.joints.contains(&(joint + 1));
    let Some(effect) = find(&change.effect) else { return without };
    if let Some(part) = effect.stands_for() {
        let joints = (0..twin.robot.dof()).filter(|j| acts(*j));
        joints.for_each(|j| without.drive.part_mut(part)[j] = twin.drive.part(part)[j]);
    }
    for p in effect.about().parameters.iter().filter(|p| p.null.is_finite()) {
        let Some(values) = without.values.get_mut(p.name) else { continue };
        for (j, value) in values.iter_mut().enumerate().filter(|(j, _)| acts(*j)) {
            *value = twin.values.get(p.name).and_then(|v| v.get(j)).copied().unwrap_or(p.null);
        }
    }
    without
}

/// What comes of the first start, of the second where the twin runs away from the first.
fn from_either<T>(
    [near, far]: [Twin; 2],
    fit: impl Fn(&Twin) -> Result<T, ServoError>,
) -> Result<T, ServoError> {
    match fit(&near) {
        Err(ServoError::Diverged { .. }) => fit(&far),
        fitted => fitted,
    }
}
