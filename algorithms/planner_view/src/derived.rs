//! Values derived from a map once and used by all planners that share it.

use core::any::Any;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Values derived from one map, each under a key: the first request makes the value, later requests
/// get the same one.
///
/// Clones share the values. A value must be a function of the map and the key alone, so that it
/// does not matter which planner makes it, and when.
#[derive(Clone, Default)]
pub struct DerivedValues {
    things: Arc<Mutex<Vec<Box<dyn Any + Send>>>>,
}

/// One value and its key.
struct Entry<K, V> {
    key: K,
    thing: Arc<OnceLock<Arc<V>>>,
}

impl DerivedValues {
    /// Returns the value under this key and of this type; `make` makes it if it does not exist.
    ///
    /// Only requests for the same value wait meanwhile. `make` must not request the value that it
    /// makes.
    pub fn get<K, V>(&self, key: K, make: impl FnOnce() -> V) -> Arc<V>
    where
        K: PartialEq + Send + 'static,
        V: Send + Sync + 'static,
    {
        let thing = {
            // The list is complete even after a panic: only an entry is pushed under the lock.
            let mut things = self.things.lock().unwrap_or_else(PoisonError::into_inner);
            let known = things
                .iter()
                .filter_map(|entry| entry.downcast_ref::<Entry<K, V>>())
                .find(|entry| entry.key == key)
                .map(|entry| Arc::clone(&entry.thing));
            known.unwrap_or_else(|| {
                let thing = Arc::new(OnceLock::new());
                things.push(Box::new(Entry {
                    key,
                    thing: Arc::clone(&thing),
                }));
                thing
            })
        };
        Arc::clone(thing.get_or_init(|| Arc::new(make())))
    }
}

impl core::fmt::Debug for DerivedValues {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("DerivedValues").finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_made_once_per_key_and_type_and_clones_share_it() {
        let derived = DerivedValues::default();
        let first = derived.get(1, || "one".to_owned());
        let again = derived.clone().get(1, || "never".to_owned());
        assert!(Arc::ptr_eq(&first, &again));
        assert_eq!(*derived.get(2, || "two".to_owned()), "two");
        // Another type under the same key is another value; so is another type of key.
        assert_eq!(*derived.get(1, || 1.5), 1.5);
        assert_eq!(*derived.get((1, 2.0), || "pair".to_owned()), "pair");
    }

    #[test]
    fn a_value_may_derive_from_another() {
        let derived = DerivedValues::default();
        let sum = derived.get("sum", || *derived.get("part", || 20) + 1);
        assert_eq!(*sum, 21);
    }

    #[test]
    fn threads_get_the_same_value() {
        let derived = DerivedValues::default();
        let things: Vec<Arc<u64>> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..4)
                .map(|_| scope.spawn(|| derived.get("key", || 7_u64)))
                .collect();
            threads.into_iter().map(|t| t.join().unwrap()).collect()
        });
        assert!(things.iter().all(|thing| Arc::ptr_eq(thing, &things[0])));
    }
}
