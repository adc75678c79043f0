//! How far the searches of a diagnosis are, for who follows it: they run beside each other, and nobody
//! knows beforehand how many causes they find.

use std::sync::{Mutex, PoisonError};

use crate::follow::Watch;

/// What a diagnosis does for most of its time.
pub const SEARCHING: &str = "searching for what the twin lacks";
/// Rounds that what comes after the searches takes, about: causes are held against rivals once more.
const AFTER: u64 = 2;

/// What was told of two searches.
pub struct Rounds<'a> {
    watch: &'a dyn Watch,
    /// Rounds that are done, and how many they are at most.
    told: Mutex<[[u64; 2]; 2]>,
}

impl<'a> Rounds<'a> {
    /// Nothing is told yet of searches of `at_most` rounds each.
    pub fn new(watch: &'a dyn Watch, at_most: usize) -> Self {
        Self { watch, told: Mutex::new([[0, at_most as u64]; 2]) }
    }

    /// Who follows the first search (0) or the second (1).
    pub fn of(&self, search: usize) -> OneOf<'_> {
        OneOf { rounds: self, search }
    }
}

/// Who follows one of two searches: both count.
pub struct OneOf<'a> {
    rounds: &'a Rounds<'a>,
    search: usize,
}

impl Watch for OneOf<'_> {
    fn bound(&self, doing: &'static str, done: u64, at_most: u64) {
        let mut told = self.rounds.told.lock().unwrap_or_else(PoisonError::into_inner);
        told[self.search] = [done, at_most];
        let [done, at_most] = [0, 1].map(|i| told.iter().map(|one| one[i]).sum::<u64>());
        self.rounds.watch.bound(doing, done, at_most + AFTER);
    }

    fn tell(&self, doing: &'static str, done: u64, of: u64) {
        self.rounds.watch.tell(doing, done, of);
    }

    fn note(&self, text: &str) {
        self.rounds.watch.note(text);
    }

    fn warn(&self, text: &str) {
        self.rounds.watch.warn(text);
    }

    fn stops(&self) -> bool {
        self.rounds.watch.stops()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::{Settings, diagnose_traced};
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    /// Somebody who writes down what is told.
    #[derive(Default)]
    struct Told(Mutex<Vec<[u64; 2]>>);

    impl Watch for Told {
        fn bound(&self, doing: &'static str, done: u64, at_most: u64) {
            assert_eq!(doing, SEARCHING);
            self.0.lock().unwrap().push([done, at_most]);
        }
    }

    /// At no time is less said to be left than there is, and at the end nothing but what comes after.
    #[test]
    fn what_is_left_of_a_search_is_told_and_never_too_little() {
        let mut arm = Twin::default();
        for (name, value) in [("coulomb", 6.0), ("viscous", 9.0)] {
            arm.values.insert(name.into(), vec![value; 6]);
        }
        let recorded = |speed: f64| {
            let mut made = samples(6, 3000, |j, t| 0.7 * ((speed + 0.2 * j as f64) * t).sin());
            made.torque = arm.torque(&arm.motion(&made));
            noisy(&mut made, 0.3);
            made
        };
        let twin = Twin { effects: vec!["viscous".into()], ..Twin::default() };
        let (told, settings) = (Told::default(), Settings::default());
        diagnose_traced(&twin, &recorded(1.1), &recorded(1.4), &settings, &told).unwrap();
        let told = told.0.into_inner().unwrap();
        let [done, at_most] = *told.last().unwrap();
        assert_eq!(done + AFTER, at_most);
        assert!(done >= 4 && told.len() >= 4, "{told:?}");
        assert!(told.iter().all(|[_, most]| *most >= at_most), "{told:?}");
    }
}
