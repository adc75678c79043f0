//! What may be missing in the twin: an effect of the catalogue, somewhere.

use std::borrow::Cow;

use super::observed::Observed;
use crate::effects::{
    self, CATALOGUE, Channels, Effect, Mechanism, Motion, Parameter, Role, Scope, Seen, Size,
};
use crate::regression::Blocks;
use crate::rigid_body::parameters::{PER_LINK, sizes};
use crate::twin::Twin;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Place {
    Joint(usize),
    /// All joints, with the same parameters.
    Arm,
    /// This many links, every one with values of its own.
    Links(usize),
}

impl Place {
    /// Joints as users count: from 1, empty for the whole arm.
    pub fn joints(self) -> Vec<usize> {
        match self {
            Place::Joint(j) => vec![j + 1],
            Place::Arm => Vec::new(),
            Place::Links(links) => (1..=links).collect(),
        }
    }

    fn has(self, joint: usize) -> bool {
        self == Place::Arm || self == Place::Joint(joint)
    }

    /// Where sets of values act, from 0 at the base.
    fn each(self) -> std::ops::Range<usize> {
        match self {
            Place::Joint(j) => j..j + 1,
            Place::Arm => 0..1,
            Place::Links(links) => 0..links,
        }
    }
}

/// A link may be this many times what the twin has of it.
const TIMES_ITSELF: f64 = 10.0;

/// Where a candidate changes torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    One(usize),
    Several,
}

impl Extent {
    pub fn meets(self, other: Self) -> bool {
        self == other || self == Self::Several || other == Self::Several
    }
}

/// The effect that a joint's scale of torque is.
pub const SCALE: &str = "torque_constant";

#[derive(Clone, Copy)]
pub struct Candidate {
    pub effect: &'static dyn Effect,
    pub place: Place,
    /// The recording it acts in; `None`: in all, with the same values.
    pub recording: Option<usize>,
    /// Is it a change of values that the twin states?
    pub changes: bool,
    /// How many times larger than its effect says its values are expected to be.
    pub spread: f64,
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        let here = (self.name(), self.place, self.recording);
        here == (other.name(), other.place, other.recording)
    }
}

impl std::fmt::Debug for Candidate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {:?}", self.name(), self.place)
    }
}

/// A candidate with its nonlinear parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    pub candidate: Candidate,
    /// Linear values as last fitted; empty before.
    pub linear: Vec<f64>,
    pub nonlinear: Vec<f64>,
    /// Which of `nonlinear` were searched; the others have given values.
    pub searched: Vec<usize>,
    /// Linear parameters that are held at zero, which is their bound.
    pub held: Vec<bool>,
    /// How many starts the search of the nonlinear ones had.
    pub starts: usize,
    /// Are its linear values those of the data alone, whatever is expected of them?
    pub free: bool,
}

impl Term {
    pub fn new(candidate: Candidate, nonlinear: Vec<f64>) -> Self {
        Self {
            candidate,
            linear: vec![],
            nonlinear,
            searched: vec![],
            held: vec![false; candidate.linear()],
            starts: 1,
            free: false,
        }
    }

    /// What having been chosen among so many starts costs, nats: the evidence is their mean, of which
    /// the best one carries nearly all.
    pub fn ln_starts(&self) -> f64 {
        (self.starts.max(1) as f64).ln()
    }

    /// The nonlinear parameters that were searched and say what the effect is like, not where columns are worked
    /// out.
    pub fn shapes(&self) -> impl Iterator<Item = usize> {
        let nonlinear = self.candidate.parameters().filter(|(p, _)| p.role == Role::Nonlinear);
        let reference: Vec<bool> = nonlinear.map(|(p, _)| p.is_reference()).collect();
        self.searched.iter().copied().filter(move |k| !reference[*k])
    }

    /// The columns of those parameters that are not held.
    pub fn series(&self, motion: &Motion<'_>, recording: usize) -> Vec<Vec<Vec<f64>>> {
        let mut columns = self.candidate.series(motion, &self.nonlinear, recording);
        for (column, _) in columns.iter_mut().zip(&self.held).filter(|(_, held)| **held) {
            column.iter_mut().for_each(Vec::clear);
        }
        columns
    }
}

/// Every effect that torque can show, wherever the twin lacks it or states its values, which may be
/// wrong; not those in `without`. What lasts for a while may act in one of the `recordings` alone.
pub fn candidates(twin: &Twin, without: &[String], recordings: &[usize]) -> Vec<Candidate> {
    let mut all = Vec::new();
    // Servos have one channel only, their position.
    let seen = |e: &dyn Effect| match twin.drive.servo {
        Some(_) => e.seen() == Seen::Columns,
        None => e.seen() != Seen::Simulation,
    };
    let shows = |e: &&dyn Effect| seen(*e) && twin.can_have(*e);
    for effect in CATALOGUE.iter().copied().filter(shows) {
        let name = effect.about().name;
        let listed = twin.effects.iter().any(|n| n == name);
        let stated = twin.known().any(|e| e.about().name == name);
        let can_change = stated && effect.about().parameters[0].role == Role::Linear;
        if without.iter().any(|n| n == name) || (listed && !can_change) {
            continue;
        }
        for place in places(effect, twin, stated) {
            let everywhere = Candidate { changes: stated, ..Candidate::new(effect, place) };
            all.push(everywhere);
            if effect.lasts_a_while() && recordings.len() > 1 {
                let only =
                    recordings.iter().map(|r| Candidate { recording: Some(*r), ..everywhere });
                all.extend(only);
            }
        }
    }
    all
}

/// Places of an effect: each joint, and all joints alike where no parameter depends on a joint's size. Gears rub each by
/// itself; servos of an arm are of one kind.
fn places(effect: &dyn Effect, twin: &Twin, stated: bool) -> impl Iterator<Item = Place> + use<> {
    let about = effect.about();
    let sizeless = about.parameters.iter().all(|p| matches!(p.unit, "-" | "s"));
    let each = if about.scope == Scope::Arm { 0 } else { twin.robot.dof() };
    let alike = sizeless && (!about.dissipates || twin.drive.servo.is_some());
    let arm = about.scope == Scope::Arm || (about.scope == Scope::Joint && alike && !stated);
    (0..each).map(Place::Joint).chain(arm.then_some(Place::Arm))
}

impl Candidate {
    /// The candidate in all recordings, where the twin lacks the effect.
    pub fn new(effect: &'static dyn Effect, place: Place) -> Self {
        Self { effect, place, recording: None, changes: false, spread: 1.0 }
    }

    pub fn extent(&self) -> Extent {
        match self.place {
            Place::Joint(j) if self.effect.about().scope == Scope::Joint => Extent::One(j),
            _ => Extent::Several,
        }
    }

    /// The joint whose scale of torque it is.
    pub fn scaled(&self) -> Option<usize> {
        match self.place {
            Place::Joint(j) if self.name() == SCALE => Some(j),
            _ => None,
        }
    }

    /// May it act in this recording?
    pub fn is_in(&self, recording: usize) -> bool {
        self.recording.is_none_or(|r| r == recording)
    }

    /// Loads of earlier ones are in place where later ones are worked out: a base tilts with the
    /// payload on it.
    pub fn order(&self) -> (usize, Place) {
        (effects::order(self.effect), self.place)
    }

    /// Links, loads and gravity for these values, put into `mechanism`.
    pub fn build(&self, values: &[f64], mechanism: &mut Mechanism) {
        if self.effect.about().scope == Scope::Joint {
            return;
        }
        let (linear, nonlinear) = values.split_at(self.linear());
        for (own, joint) in self.place.each().enumerate() {
            let values = [self.own(linear, own), self.own(nonlinear, own)].concat();
            self.effect.build(&values, joint, mechanism);
        }
    }

    /// How many sets of values it has.
    pub fn sets(&self) -> usize {
        self.place.each().len()
    }

    /// Values of set `k` among those of all its sets.
    fn own<'v>(&self, values: &'v [f64], k: usize) -> &'v [f64] {
        let count = values.len() / self.place.each().len().max(1);
        &values[k * count..(k + 1) * count]
    }

    /// The parameters, linear ones of all sets first, and the joint (from 0) where there is one set for
    /// each of several.
    pub fn parameters(self) -> impl Iterator<Item = (&'static Parameter, Option<usize>)> {
        let place = self.place;
        let of = move |role| {
            let own = self.effect.about().parameters.iter().filter(move |p| p.role == role);
            place.each().flat_map(move |j| own.clone().map(move |p| (p, j)))
        };
        let all = of(Role::Linear).chain(of(Role::Nonlinear));
        all.map(move |(p, j)| (p, matches!(place, Place::Links(_)).then_some(j)))
    }

    /// References follow from the linear values.
    pub fn settle(&self, linear: &[f64], nonlinear: &mut [f64]) {
        let sets = self.place.each().len();
        let own = nonlinear.len() / sets.max(1);
        for (k, nonlinear) in nonlinear.chunks_mut(own.max(1)).enumerate() {
            self.effect.settle(self.own(linear, k), nonlinear);
        }
    }

    /// Do the linear values make the effect that it is, in any of its sets?
    pub fn is_itself(&self, linear: &[f64]) -> bool {
        (0..self.place.each().len()).any(|k| self.effect.is_itself(self.own(linear, k)))
    }

    /// How large the linear values can be expected to be, standard deviations ([`Effect::expected`]). What a change
    /// comes to says nothing of how large it all is.
    pub fn expected(&self, twin: &Twin, nonlinear: &[f64]) -> Vec<f64> {
        let refers = |k: usize| if self.changes { &[][..] } else { self.own(nonlinear, k) };
        let sets = self.place.each().enumerate();
        let each = sets.flat_map(|(k, j)| self.effect.expected(&twin.robot, j, refers(k)));
        each.map(|size| self.spread * size).collect()
    }

    pub fn name(&self) -> &'static str {
        self.effect.about().name
    }

    /// Is it felt by more joints than one (a load, a tilt of the base)?
    pub fn is_load(&self) -> bool {
        self.effect.about().scope != Scope::Joint
    }

    /// Smallest and largest value of parameter `i` in its unit, as a change of what the twin has of it.
    pub fn range(&self, i: usize, twin: &Twin) -> [f64; 2] {
        if let Place::Links(_) = self.place {
            return self.range_of_links(i, twin);
        }
        let parameter = &self.effect.about().parameters[i];
        let has = match self.place {
            Place::Joint(j) if i == 0 && !self.changes => self.effect.in_drive(&twin.drive, j),
            _ if i < self.linear() => self.stated(twin).get(i).copied().unwrap_or(0.0),
            _ => 0.0,
        };
        let there = parameter.on(&Size::of(&twin.robot));
        [there.min - has, there.max - has]
    }

    /// Range of a link's change: from no mass, or a moment the other way, to many times what the link has.
    fn range_of_links(&self, i: usize, twin: &Twin) -> [f64; 2] {
        let sets = self.place.each().len().max(1);
        let own = self.linear() / sets;
        let Some(k) = (i < self.linear()).then_some(i % own) else {
            return [f64::NEG_INFINITY, f64::INFINITY];
        };
        let size = sizes(&twin.robot)[PER_LINK * (i / own) + k];
        let least = if k == 0 { -size } else { -TIMES_ITSELF * size };
        [least, TIMES_ITSELF * size]
    }

    /// The values that the twin states and this is a change of; empty where there are none.
    pub fn stated(&self, twin: &Twin) -> Vec<f64> {
        let joint = if let Place::Joint(j) = self.place { j } else { 0 };
        let values = || twin.values_at(self.effect, joint).unwrap_or_default();
        if self.changes { values() } else { Vec::new() }
    }

    pub fn linear(&self) -> usize {
        let own = self.effect.about().parameters.iter().filter(|p| p.role == Role::Linear).count();
        own * self.place.each().len()
    }

    /// Does it change the recorded channels instead of adding torque?
    pub fn senses(&self) -> bool {
        self.effect.seen() == Seen::Channels
    }

    /// Rows of nonlinear parameters to begin a search with; those that the twin states stay.
    pub fn starts(&self, motion: &Motion<'_>, twin: &Twin) -> Vec<Vec<f64>> {
        let joint = if let Place::Joint(j) = self.place { j } else { 0 };
        match self.stated(twin).get(self.linear()..) {
            Some(nonlinear) if self.changes => return vec![nonlinear.to_vec()],
            _ => {}
        }
        let starts = self.effect.starts(motion, joint);
        // All sets begin alike.
        starts.into_iter().map(|start| start.repeat(self.place.each().len())).collect()
    }

    /// One column per linear parameter, before sensors: series over all samples of recording number
    /// `recording` by joint, empty where it does not act.
    pub fn series(
        &self,
        motion: &Motion<'_>,
        nonlinear: &[f64],
        recording: usize,
    ) -> Vec<Vec<Vec<f64>>> {
        let joints = motion.q.joints();
        let mut columns = vec![vec![Vec::new(); joints]; self.linear()];
        if self.senses() || self.recording.is_some_and(|only| only != recording) {
            return columns;
        }
        if self.effect.about().scope == Scope::Joint {
            for joint in (0..joints).filter(|&j| self.place.has(j)) {
                let at_joint = self.effect.columns(motion, joint, nonlinear);
                columns.iter_mut().zip(at_joint).for_each(|(c, series)| c[joint] = series);
            }
            return columns;
        }
        let sets = self.place.each().enumerate();
        let reach =
            sets.flat_map(|(k, from)| self.effect.reach(motion, from, self.own(nonlinear, k)));
        for (column, series) in columns.iter_mut().zip(reach) {
            let acts = |j: &usize| series.joint(*j).iter().any(|v| *v != 0.0);
            (0..joints).filter(acts).for_each(|j| column[j] = series.joint(j).to_vec());
        }
        columns
    }
}

/// Does it change the torque of a joint?
pub fn acts_on(candidate: Candidate, joint: usize) -> bool {
    match candidate.place {
        Place::Arm | Place::Links(_) => true,
        Place::Joint(j) => j == joint || candidate.effect.about().scope == Scope::Link,
    }
}

/// `stribeck at joint 2`, `payload`.
pub fn describe(candidate: Candidate) -> String {
    match candidate.place {
        Place::Joint(j) => format!("{} at joint {}", candidate.name(), j + 1),
        Place::Arm => candidate.name().to_string(),
        Place::Links(_) => format!("{} of all links", candidate.name()),
    }
}

/// What sensors with the given channel effects show of a joint's torque.
pub fn sense<'s>(
    evidence: &Observed<'_>,
    sensors: &[Term],
    joint: usize,
    torque: &'s [f64],
) -> Cow<'s, [f64]> {
    let here = |t: &&Term| t.candidate.senses() && t.candidate.place.has(joint);
    sensors.iter().filter(here).fold(torque.into(), |torque, term| {
        let none = Vec::new;
        let dt = evidence.samples.dt;
        let mut channels = Channels {
            dt,
            q: none(),
            qd: none(),
            qdd: none(),
            torque: torque.into_owned(),
            velocity_is_recorded: false,
        };
        term.candidate.effect.measure(&term.nonlinear, &mut channels);
        channels.torque.into()
    })
}

/// Series before sensors -> what the rows show of them.
pub fn shown(evidence: &Observed<'_>, sensors: &[Term], column: &[Vec<f64>]) -> Blocks {
    let one = |(joint, series): (usize, &Vec<f64>)| match series.iter().any(|v| *v != 0.0) {
        true => evidence.block(joint, &sense(evidence, sensors, joint, series)),
        false => Vec::new(),
    };
    Blocks(column.iter().enumerate().map(one).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What stands in the catalogue is searched for, everywhere it may act: nothing else is needed
    /// for a diagnosis to find a new effect.
    #[test]
    fn every_effect_of_the_catalogue_is_a_candidate() {
        let twin = Twin::default();
        let all = candidates(&twin, &[], &[0]);
        for effect in CATALOGUE {
            let name = effect.about().name;
            let at = all.iter().filter(|c| c.name() == name).count();
            let known = twin.effects.iter().any(|e| e == name);
            let least = match effect.about().scope {
                _ if known || effect.seen() == Seen::Simulation || !twin.can_have(*effect) => 0,
                Scope::Arm => 1,
                Scope::Joint | Scope::Link => twin.robot.dof(),
            };
            assert!(at >= least && (least > 0 || at == 0), "{name}: {at} candidates");
            assert!(candidates(&twin, &[name.into()], &[0]).iter().all(|c| c.name() != name));
        }
    }

    /// One delay is that of all channels, one friction not that of all gears.
    #[test]
    fn gears_of_an_arm_rub_each_by_itself() {
        let all = candidates(&Twin::default(), &[], &[0]);
        let alike = |name: &str| all.iter().any(|c| c.name() == name && c.place == Place::Arm);
        assert!(alike("time_delay") && alike("torque_constant") && !alike("load_friction"));
    }
}
