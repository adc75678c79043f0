//! Values of changes, fitted by simulation to recordings.

use super::fit::{Fit, told};
use super::{Estimate, Free, ServoError, Settings, Track, free_parameters};
use crate::diagnosis::Change;
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

/// Fits to recordings together, beginning with the twin as given, its open values fitted.
pub struct Refits<'a> {
    pub twin: &'a Twin,
    pub tracks: Vec<&'a Track>,
    /// Who follows the fits.
    pub watch: &'a dyn Watch,
    pub before: Twin,
}

impl<'a> Refits<'a> {
    /// # Errors
    /// As [`super::identify`].
    pub fn new(
        twin: &'a Twin,
        tracks: Vec<&'a Track>,
        watch: &'a dyn Watch,
    ) -> Result<Self, ServoError> {
        let mut refits = Self { twin, tracks, watch, before: twin.clone() };
        let far = refits.fitted(Fit::FromFar, twin, &[], None)?;
        refits.before = refits.close(&far, &[])?;
        Ok(refits)
    }

    /// Fits to one recording, beginning with the same.
    pub fn by(&self, track: &'a Track) -> Self {
        Self {
            twin: self.twin,
            tracks: vec![track],
            watch: self.watch,
            before: self.before.clone(),
        }
    }

    /// `start`, which has `changes` and one more, with the values of that one fitted, about, and all others as they are.
    ///
    /// # Errors
    /// As [`super::identify`].
    pub fn alone(
        &self,
        start: &Twin,
        changes: &[Change],
        change: &Change,
    ) -> Result<Twin, ServoError> {
        let own = self.own(start, changes, change)?;
        if own.is_empty() {
            return Ok(start.clone());
        }
        match Fit::FromFar.of(start, &self.tracks, &own, self.watch) {
            Err(ServoError::Diverged { .. }) => Ok(start.clone()),
            fitted => fitted,
        }
    }

    /// `current` with all of `changes`, the last of which it lacks: what that meets is fitted from `start`, about what is
    /// sought.
    ///
    /// # Errors
    /// As [`super::identify`].
    pub fn beside(
        &self,
        current: &Twin,
        changes: &[Change],
        start: &Twin,
    ) -> Result<Twin, ServoError> {
        self.about([start, current], changes, changes.last())
    }

    /// `current`, which has all of `changes`, about without the `i`th.
    ///
    /// # Errors
    /// As [`super::identify`].
    pub fn without(
        &self,
        current: &Twin,
        changes: &[Change],
        i: usize,
    ) -> Result<Twin, ServoError> {
        let start = taken_out(current, &self.before, &changes[i]);
        let mut others = changes.to_vec();
        others.remove(i);
        self.about([&start, &self.before], &others, None)
    }

    /// Values to be compared, from `start`; where the twin runs away from there, from where short stretches lead from `other`.
    fn about(
        &self,
        [start, other]: [&Twin; 2],
        changes: &[Change],
        around: Option<&Change>,
    ) -> Result<Twin, ServoError> {
        match self.fitted(Fit::About, start, changes, around) {
            Err(ServoError::Diverged { .. }) => {
                let far = self.fitted(Fit::FromFar, other, changes, around)?;
                self.fitted(Fit::About, &far, changes, around)
            }
            near => near,
        }
    }

    /// `near` with the values of what the twin leaves open, and of the changes, fitted.
    ///
    /// # Errors
    /// As [`super::identify`].
    pub fn all(&self, near: &Twin, changes: &[Change]) -> Result<Refitted, ServoError> {
        self.as_is(&self.close(near, changes)?, changes)
    }

    /// The same, without what the recordings say of the values.
    ///
    /// # Errors
    /// As [`super::identify`].
    pub fn close(&self, near: &Twin, changes: &[Change]) -> Result<Twin, ServoError> {
        self.fitted(Fit::Close, near, changes, None)
    }

    /// A twin with changes as it is, and what the recording says of its values.
    ///
    /// # Errors
    /// As [`super::identify`].
    pub fn as_is(&self, twin: &Twin, changes: &[Change]) -> Result<Refitted, ServoError> {
        let free = self.free(twin, changes)?;
        if free.is_empty() {
            return Ok(Refitted { twin: twin.clone(), estimates: Vec::new() });
        }
        let settings = Settings { level: LEVEL, ..Settings::default() };
        let estimates = told(twin, &self.tracks, &free, &settings)?;
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
        by.of(start, &self.tracks, &free, self.watch)
    }

    /// Effects whose values the twin, as given, leaves open.
    pub fn open(&self) -> Vec<String> {
        self.twin.open().map(|e| e.about().name.to_string()).collect()
    }

    /// What the twin leaves open, and the parameters of the changes where they act, with their values in `start`. They are
    /// expected near those, beside changes near those before, as far off as such effects usually are, or as a
    /// search has them: what the recording does not tell stays there (friction of a joint that hardly moves).
    ///
    /// # Errors
    /// If a change has values that cannot be fitted.
    pub fn free(&self, start: &Twin, changes: &[Change]) -> Result<Vec<Free>, ServoError> {
        let open = self.open();
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
        let placed = |(before, own): (Free, Free)| {
            let linear = own.parameter.role == Role::Linear;
            let expected = if linear { before.expected } else { own.start };
            let off = changes.iter().find_map(|change| off(change, &before)).unwrap_or(0.0);
            let Free { spread, .. } = Free { start: off, ..before }.near_start(start);
            Free { start: own.start, expected, spread, ..before }
        };
        Ok(all(&self.before)?.into_iter().zip(own).map(placed).collect())
    }

    /// The parameters of a change beside `changes`, with their values in `start`: without those that these move already.
    ///
    /// # Errors
    /// If a change has values that cannot be fitted.
    pub fn own(
        &self,
        start: &Twin,
        changes: &[Change],
        change: &Change,
    ) -> Result<Vec<Free>, ServoError> {
        let with: Vec<Change> = changes.iter().chain([change]).cloned().collect();
        let others = self.free(start, changes)?.len();
        Ok(self.free(start, &with)?.split_off(others))
    }
}

/// The twin with what it leaves open fitted to a recording.
///
/// # Errors
/// As [`super::identify`].
pub fn open_fitted(twin: &Twin, fit: &Track, watch: &dyn Watch) -> Result<Twin, ServoError> {
    Ok(Refits::new(twin, vec![fit], watch)?.before)
}

/// Has a change that was fitted a value at the end of its range, beyond which it would be another effect?
///
/// # Errors
/// If the change has no parameters that can be fitted.
pub fn is_at_bound(fitted: &Twin, change: &Change) -> Result<bool, ServoError> {
    let is_out = |f: &Free| f.is_bound(f.start) && !f.parameter.is_shape();
    Ok(parameters(fitted, change)?.iter().any(is_out))
}

fn is_same(a: &Free, b: &Free) -> bool {
    (a.parameter.name, a.joint) == (b.parameter.name, b.joint)
}

/// How far from where it is expected a search has a value that a change has.
fn off(change: &Change, f: &Free) -> Option<f64> {
    let acts = |joint: usize| change.joints.is_empty() || change.joints.contains(&(joint + 1));
    if change.effect != f.effect.about().name || !f.joint.is_none_or(acts) {
        return None;
    }
    let here = |joint: Option<usize>| joint.is_none_or(|j| f.joint.is_none_or(|own| own + 1 == j));
    let found = change.parameters.iter().find(|v| v.name == f.parameter.name && here(v.joint))?;
    Some(if change.replaces { found.value - f.expected } else { found.value })
}

/// Does a value act where the change does? A joint's own hardly move other joints.
fn is_near(f: &Free, change: &Change) -> bool {
    let is_of_joint = |effect: &dyn Effect| effect.about().scope == Scope::Joint;
    let changes_one = find(&change.effect).is_some_and(is_of_joint) && !change.joints.is_empty();
    let elsewhere = |j: usize| !change.joints.contains(&(j + 1));
    !(changes_one && is_of_joint(f.effect) && f.joint.is_some_and(elsewhere))
}

/// Parameters of a change where it acts, with their values in `twin`: one value for all joints in the whole arm.
pub fn parameters(twin: &Twin, change: &Change) -> Result<Vec<Free>, ServoError> {
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
