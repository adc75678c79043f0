//! Which effects are fitted: names from the catalogue.

use super::error::IdentificationError;
use crate::effects::{self, Effect, Parameter, Role, Scope, Seen};
use crate::robot::DrivePart;
use crate::twin::Twin;

/// The paper's Eq. 1.
pub const PAPER_LAW: [&str; 5] =
    ["coulomb", "stribeck", "viscous", "viscous_quadratic", "viscous_cubic"];

/// What a real arm needs beside it.
pub const BESIDE: [&str; 2] = ["rotor_inertia", "current_offset"];

/// Effects whose parameters are searched for, in the order of the catalogue.
#[derive(Clone)]
pub struct Terms {
    fitted: Vec<&'static dyn Effect>,
    /// Are parameters fitted that refine an effect?
    details: bool,
}

impl Terms {
    /// Terms by catalogue name; `paper` is short for Eq. 1 and `offset` for `current_offset`; with
    /// `payload_inertia` a payload is no point at its centre. Where a Stribeck curve is fitted, so is the Coulomb
    /// level it bends.
    ///
    /// # Errors
    /// For a name that is not in the catalogue, or none at all.
    pub fn named<'a>(
        names: impl IntoIterator<Item = &'a str>,
    ) -> Result<Self, IdentificationError> {
        let mut wanted = Vec::new();
        let mut details = false;
        for name in names {
            match name.trim() {
                "paper" => wanted.extend(PAPER_LAW),
                "offset" => wanted.push("current_offset"),
                "stribeck" => wanted.extend(["stribeck", "coulomb"]),
                "payload_inertia" => {
                    details = true;
                    wanted.push("payload");
                }
                other => wanted.push(other),
            }
        }
        if let Some(unknown) = wanted.iter().find(|n| effects::find(n).is_none()) {
            let known = format!("{}, payload_inertia, paper, offset", effects::names());
            return Err(IdentificationError::UnknownTerm { name: unknown.to_string(), known });
        }
        let is_wanted = |e: &&'static dyn Effect| wanted.contains(&e.about().name);
        let fitted: Vec<_> = effects::CATALOGUE.iter().copied().filter(is_wanted).collect();
        if fitted.is_empty() {
            Err(IdentificationError::NoTerms)
        } else {
            Ok(Self { fitted, details })
        }
    }

    /// Eq. 1, rotor inertia and current offset: what a real arm needs at least.
    ///
    /// # Errors
    /// None as long as the catalogue holds these names.
    pub fn usual() -> Result<Self, IdentificationError> {
        Self::named(PAPER_LAW.into_iter().chain(BESIDE))
    }

    /// What `twin` models and gives no values for, and `more`.
    ///
    /// # Errors
    /// As [`Terms::named`].
    pub fn of_twin(twin: &Twin, more: &[String]) -> Result<Self, IdentificationError> {
        let unknown = |name: &&String| {
            let parameters = effects::find(name).map_or(&[][..], |e| e.about().parameters);
            parameters.is_empty() || parameters.iter().any(|p| !twin.values.contains_key(p.name))
        };
        let of_twin = twin.effects.iter().filter(unknown);
        Self::named(of_twin.chain(more).map(String::as_str))
    }

    /// Effects none of whose nonlinear parameters the twin gives; the Stribeck curve, which has a
    /// search of its own, is not among them.
    pub fn open_nonlinear(&self, twin: &Twin) -> Vec<&'static dyn Effect> {
        let seen = |e: &&'static dyn Effect| e.seen() == Seen::Columns;
        let other = |e: &&'static dyn Effect| e.about().name != "stribeck";
        let fitted = self.fitted.iter().copied().filter(|e| is_open(*e, twin));
        fitted.filter(seen).filter(other).collect()
    }

    /// The Stribeck curve where its velocity is searched for.
    pub fn curve_of(&self, twin: &Twin) -> Option<&'static dyn Effect> {
        let is_curve = |e: &&'static dyn Effect| e.about().name == "stribeck" && is_open(*e, twin);
        self.fitted.iter().copied().find(is_curve)
    }

    /// Effects with nonlinear parameters all of which the twin gives, with their values at `joint`.
    pub fn given_nonlinear(
        &self,
        twin: &Twin,
        joint: usize,
    ) -> Vec<(&'static dyn Effect, Vec<f64>)> {
        let given = |e: &'static dyn Effect| {
            let value = |p: &Parameter| twin.values.get(p.name)?.get(joint).copied();
            let values: Option<Vec<f64>> =
                nonlinear(e).map(|p| value(p).or(p.left_out())).collect();
            values.filter(|v| !v.is_empty()).map(|v| (e, v))
        };
        self.fitted.iter().copied().filter(|e| !is_open(*e, twin)).filter_map(given).collect()
    }

    /// The twin without values for these terms; of the terms it has those that are linear.
    pub fn left_open(&self, twin: &Twin) -> Twin {
        let mut open = twin.clone();
        self.effects().for_each(|effect| open.forget(effect));
        open.effects.retain(|name| !self.contains(name));
        let linear = self.fitted.iter().filter(|e| nonlinear(**e).next().is_none());
        open.effects.extend(linear.map(|e| e.about().name.to_string()));
        open
    }

    pub fn effects(&self) -> impl Iterator<Item = &'static dyn Effect> + '_ {
        self.fitted.iter().copied()
    }

    /// Is a part of the drive fitted?
    pub fn fits(&self, part: DrivePart) -> bool {
        self.effects().any(|e| e.stands_for() == Some(part))
    }

    /// Is this parameter of a term fitted?
    pub fn tells(&self, parameter: &Parameter) -> bool {
        self.details || !parameter.is_detail()
    }

    pub fn names(&self) -> Vec<&'static str> {
        self.fitted.iter().map(|e| e.about().name).collect()
    }

    pub fn contains(&self, name: &str) -> bool {
        self.names().contains(&name)
    }

    /// Effects of one joint or of the whole arm.
    pub fn with_scope(&self, scope: Scope) -> impl Iterator<Item = &'static dyn Effect> + '_ {
        self.fitted.iter().copied().filter(move |e| e.about().scope == scope)
    }
}

fn nonlinear(effect: &'static dyn Effect) -> impl Iterator<Item = &'static Parameter> {
    effect.about().parameters.iter().filter(|p| p.role == Role::Nonlinear)
}

/// Has it nonlinear parameters that cannot be left out, and does the twin give none of them?
fn is_open(effect: &'static dyn Effect, twin: &Twin) -> bool {
    let mut own = nonlinear(effect).filter(|p| p.left_out().is_none()).peekable();
    own.peek().is_some() && own.all(|p| !twin.values.contains_key(p.name))
}
