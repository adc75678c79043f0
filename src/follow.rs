//! Who follows long work: told how far it is, asked whether it goes on.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Somebody who follows work. `()` is nobody, a [`Token`] only stops it.
pub trait Watch: Sync {
    /// `done` of `of` parts of what is being done are done; nobody knows how many there are where `of` is 0.
    fn tell(&self, _doing: &'static str, _done: u64, _of: u64) {}

    /// `done` rounds of what is being done are done, and they are `at_most` in all: that number becomes smaller
    /// as it becomes known.
    fn bound(&self, _doing: &'static str, _done: u64, _at_most: u64) {}

    /// What was done with a recording that its owner should know.
    fn note(&self, _text: &str) {}

    /// What contradicts itself, and is gone on with as its owner wants it.
    fn warn(&self, _text: &str) {}

    /// Whether the work is to end. Asked many times a second, from several threads.
    fn stops(&self) -> bool {
        false
    }
}

impl Watch for () {}

/// Ends work from another thread.
#[derive(Debug, Clone, Default)]
pub struct Token(Arc<AtomicBool>);

impl Token {
    /// Ends the work that asks it.
    pub fn stop(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Watch for Token {
    fn stops(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// The work was ended by who follows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;

/// Runs work that asks [`go_on`] on its way.
///
/// # Errors
/// If `watch` stops it.
pub fn stoppable<T>(watch: &dyn Watch, work: impl FnOnce() -> T) -> Result<T, Interrupted> {
    if watch.stops() {
        return Err(Interrupted);
    }
    // Nothing that the work has changed outlives it.
    catch_unwind(AssertUnwindSafe(work)).map_err(|why| match why.downcast::<Interrupted>() {
        Ok(interrupted) => *interrupted,
        Err(other) => resume_unwind(other),
    })
}

/// Ends work inside [`stoppable`], from any depth and any thread of it, if `watch` wants it to end. It
/// unwinds, without a word: what lies between would otherwise have to carry half an answer upwards (so
/// cancel also salsa and rust-analyzer).
pub fn go_on(watch: &dyn Watch) {
    if watch.stops() {
        resume_unwind(Box::new(Interrupted));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_ends_when_it_is_stopped_and_panics_stay_panics() {
        let token = Token::default();
        assert_eq!(stoppable(&token, || 3), Ok(3));
        let stopped = stoppable(&token, || {
            rayon::join(
                || token.stop(),
                || loop {
                    go_on(&token);
                },
            )
        });
        assert_eq!(stopped, Err(Interrupted));
        assert_eq!(stoppable(&token, || 3), Err(Interrupted));
        let other = catch_unwind(|| stoppable(&(), || resume_unwind(Box::new("a fault"))));
        assert_eq!(other.unwrap_err().downcast_ref(), Some(&"a fault"));
    }
}
