//! What is fitted: the twin's open effects and causes beside them.

use nalgebra::DVector;

use super::candidate::{Candidate, Place, Term};
use crate::effects::{Effect, Mechanism, Scope};
use crate::robot::Robot;
use crate::twin::Twin;

#[derive(Debug, Clone)]
pub struct Model {
    pub open: Vec<Term>,
    pub causes: Vec<Term>,
    /// What the gears carry: the twin's robot with known and accepted loads.
    pub laden: Robot,
}

impl Model {
    /// The twin alone; nonlinear parameters of its open effects as it states them, else typical.
    pub fn of(twin: &Twin) -> Self {
        let open = |effect: &'static dyn Effect| -> Vec<Term> {
            let places: Vec<Place> = match effect.about().scope {
                Scope::Arm => vec![Place::Arm],
                _ => (0..twin.robot.dof()).map(Place::Joint).collect(),
            };
            let term = |(joint, place)| {
                Term::new(Candidate::new(effect, place), twin.nonlinear_at(effect, joint))
            };
            places.into_iter().enumerate().map(term).collect()
        };
        let open = twin.open().flat_map(open).collect();
        Self { open, causes: Vec::new(), laden: twin.laden() }
    }

    pub fn with(&self, cause: Term) -> Self {
        let mut more = self.clone();
        more.causes.push(cause);
        more
    }

    /// The model without cause `i`.
    pub fn without(&self, i: usize) -> Self {
        let mut fewer = self.clone();
        fewer.causes.remove(i);
        fewer
    }

    pub fn has(&self, candidate: Candidate) -> bool {
        self.causes.iter().any(|t| t.candidate == candidate)
    }

    /// Has it the same causes as another?
    pub fn has_causes_of(&self, other: &Self) -> bool {
        let theirs = |t: &Term| other.has(t.candidate);
        self.causes.len() == other.causes.len() && self.causes.iter().all(theirs)
    }

    pub fn terms(&self) -> impl Iterator<Item = &Term> {
        self.open.iter().chain(&self.causes)
    }

    /// Where the linear parameters of cause `i` are among all.
    pub fn range(&self, i: usize) -> std::ops::Range<usize> {
        let before = self.open.iter().chain(&self.causes[..i]);
        let start = before.map(|t| t.candidate.linear()).sum();
        start..start + self.causes[i].candidate.linear()
    }

    /// Takes over the values `x` of all terms, and what the causes weigh.
    pub(super) fn carry(&mut self, twin: &Twin, x: &DVector<f64>) {
        let mut values = x.iter().copied();
        for term in self.open.iter_mut().chain(&mut self.causes) {
            term.linear = values.by_ref().take(term.candidate.linear()).collect();
        }
        self.laden = self.laden_with(twin, |_| true);
    }

    /// The twin's robot with known loads and those of the causes that `which` asks for.
    pub(super) fn laden_with(&self, twin: &Twin, which: impl Fn(&Candidate) -> bool) -> Robot {
        let mut mechanism = Mechanism::new(twin.laden());
        let fitted = self.causes.iter().filter(|t| !t.linear.is_empty() && which(&t.candidate));
        let mut causes: Vec<&Term> = fitted.collect();
        causes.sort_by_key(|t| t.candidate.order());
        for term in causes {
            let values: Vec<f64> = term.linear.iter().chain(&term.nonlinear).copied().collect();
            term.candidate.build(&values, &mut mechanism);
        }
        mechanism.robot
    }

    /// Is a cause a load?
    pub(super) fn carries(&self) -> bool {
        self.causes.iter().any(|t| t.candidate.is_load())
    }

    /// Does one cause depend on what others weigh, or on all that the drive supplies?
    pub(super) fn is_entangled(&self) -> bool {
        let loads = |t: &&Term| t.candidate.is_load();
        let follows = |t: &Term| t.candidate.effect.follows_drive();
        self.causes.iter().filter(loads).count() > 1 || self.causes.iter().any(follows)
    }
}
