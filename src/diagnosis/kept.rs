//! What a search comes back to, by all that it depends on, as far as there is room.

use std::sync::Arc;

use quick_cache::Weighter;
use quick_cache::sync::Cache;

use crate::regression::{Blocks, Raw};

/// Room for what is kept of one kind, bytes: with it two recordings of 40 s of six joints are diagnosed in 0.8 GB, as fast as
/// with any room.
const ROOM: u64 = 256 << 20;
/// What a column of a minute takes, bytes.
const USUAL: u64 = 64 << 10;

/// Values by key: where there is no room left, those that are asked for least go.
pub struct Kept<T>(Cache<String, Entry<T>, Bytes>);

/// A value and how much room it takes.
#[derive(Debug)]
struct Entry<T> {
    value: Arc<T>,
    bytes: u64,
}

impl<T> Clone for Entry<T> {
    fn clone(&self) -> Self {
        Self { value: self.value.clone(), bytes: self.bytes }
    }
}

#[derive(Debug, Clone, Copy)]
struct Bytes;

impl<T> Weighter<String, Entry<T>> for Bytes {
    fn weight(&self, key: &String, kept: &Entry<T>) -> u64 {
        kept.bytes + key.len() as u64
    }
}

/// What takes room.
pub trait Room {
    /// Numbers it holds.
    fn numbers(&self) -> usize;
}

/// Columns over all samples, joint by joint.
impl Room for Vec<Vec<Vec<f64>>> {
    fn numbers(&self) -> usize {
        self.iter().flatten().map(Vec::len).sum()
    }
}

impl Room for Vec<Blocks> {
    fn numbers(&self) -> usize {
        self.iter().flat_map(|b| &b.0).map(Vec::len).sum()
    }
}

impl Room for Vec<Raw> {
    fn numbers(&self) -> usize {
        self.iter().flat_map(|r| &r.rows.0).map(Vec::len).sum()
    }
}

impl<T> Default for Kept<T> {
    fn default() -> Self {
        Self(Cache::with_weighter((ROOM / USUAL) as usize, ROOM, Bytes))
    }
}

impl<T: Room> Kept<T> {
    /// The value of `key`, worked out where it is not here.
    pub fn get(&self, key: &str, work_out: impl FnOnce() -> T) -> Arc<T> {
        if let Some(kept) = self.0.get(key) {
            return kept.value;
        }
        // No lock is held meanwhile: it runs in parallel, and a thread that waits for its parts may come here again.
        let value = Arc::new(work_out());
        let bytes = (size_of::<f64>() * value.numbers()) as u64;
        self.0.insert(key.into(), Entry { value: value.clone(), bytes });
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blocks(bytes: usize) -> Vec<Blocks> {
        vec![Blocks(vec![vec![0.0; bytes / size_of::<f64>()]])]
    }

    #[test]
    fn what_is_kept_is_worked_out_once() {
        let kept = Kept::default();
        let is_fresh = |key: &str| {
            let mut fresh = false;
            kept.get(key, || {
                fresh = true;
                blocks(8)
            });
            fresh
        };
        assert!(is_fresh("a") && is_fresh("b"));
        assert!(!is_fresh("a") && !is_fresh("b"));
    }

    #[test]
    fn no_more_is_kept_than_there_is_room_for() {
        let kept: Kept<Vec<Blocks>> = Kept::default();
        let each = ROOM as usize / 100;
        for key in 0..300 {
            assert_eq!(kept.get(&key.to_string(), || blocks(each)).numbers(), each / 8);
        }
        assert!(kept.0.weight() <= ROOM);
        // What is larger than all room is worked out each time.
        let large = 2 * ROOM as usize;
        assert_eq!(kept.get("large", || blocks(large)).numbers(), large / 8);
        assert!(kept.0.weight() <= ROOM);
    }
}
