//! Decoders of others that panic on damaged files: what they would print becomes an error.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

static HOOK: Once = Once::new();

/// What `decode` returns, or what it panicked with, unsaid. Other threads panic as before.
///
/// # Errors
/// If `decode` panics.
pub fn guarded<T>(decode: impl FnOnce() -> T) -> Result<T, String> {
    HOOK.call_once(|| {
        let usual = take_hook();
        set_hook(Box::new(move |panic| {
            if !GUARDED.get() {
                usual(panic);
            }
        }));
    });
    GUARDED.set(true);
    let outcome = catch_unwind(AssertUnwindSafe(decode));
    GUARDED.set(false);
    outcome.map_err(|why| match why.downcast::<String>() {
        Ok(text) => *text,
        Err(other) => other.downcast::<&str>().map_or_else(|_| "damaged".into(), |t| t.to_string()),
    })
}

#[cfg(test)]
mod tests {
    use super::guarded;

    #[test]
    fn what_panics_says_why_and_what_does_not_comes_back() {
        assert_eq!(guarded(|| 3), Ok(3));
        let zero = std::hint::black_box(0);
        assert_eq!(guarded(|| panic!("cut off")), Err::<(), _>("cut off".into()));
        assert!(guarded(|| 1 / zero).unwrap_err().contains("divide by zero"));
    }
}
