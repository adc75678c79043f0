//! What a search comes back to, by all that it depends on.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

/// Values by key, as long as nobody asks for those of another state: each value of a delay that is
/// searched shows all columns anew.
pub struct Kept<T>(Mutex<(String, HashMap<String, Arc<T>>)>);

impl<T> Default for Kept<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> Kept<T> {
    /// The value of `key` in a `state`, worked out where it is not here.
    pub fn get(&self, state: &str, key: &str, work_out: impl FnOnce() -> T) -> Arc<T> {
        if let Some(value) = self.find(state, key) {
            return value;
        }
        let value = Arc::new(work_out());
        if let Ok(mut all) = self.0.lock() {
            if all.0 != state {
                *all = (state.into(), HashMap::new());
            }
            all.1.insert(key.into(), value.clone());
        }
        value
    }

    fn find(&self, state: &str, key: &str) -> Option<Arc<T>> {
        let all = self.0.lock().ok()?;
        (all.0 == state).then(|| all.1.get(key).cloned()).flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_state_begins_anew() {
        let kept = Kept::default();
        let is_fresh = |state: &str, key: &str| {
            let mut fresh = false;
            kept.get(state, key, || fresh = true);
            fresh
        };
        assert!(is_fresh("", "a") && is_fresh("", "b"));
        assert!(!is_fresh("", "a"));
        assert!(is_fresh("delay", "a") && !is_fresh("delay", "a"));
        assert!(is_fresh("", "a"));
    }
}
