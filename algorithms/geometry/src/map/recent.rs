//! Recently built maps.
//!
//! The check of a scenario, the plan of its run and the simulation all need its map, and a sweep
//! needs the same one thousands of times. A map is a function of its specification, so that sharing
//! it does not change results.

use std::sync::{Arc, Mutex, PoisonError};

use super::{MapError, MapSpec, WorldMap};

/// Maximum number of maps that are kept.
const MAX_MAPS: usize = 8;
/// Maximum number of cells of a kept map: about 10 MB each.
const MAX_CELLS: usize = 1 << 20;

/// The newest is the last.
static RECENT: Mutex<Vec<(MapSpec, Arc<WorldMap>)>> = Mutex::new(Vec::new());

impl WorldMap {
    /// As [`WorldMap::new`], but reuses a recently built map. Files are read every time: they may
    /// have changed.
    ///
    /// # Errors
    /// As [`WorldMap::new`].
    pub fn recent(spec: &MapSpec) -> Result<Arc<Self>, MapError> {
        if let MapSpec::File { .. } = spec {
            return Self::new(spec).map(Arc::new);
        }
        if let Some((_, map)) = lock().iter().find(|(known, _)| known == spec) {
            return Ok(Arc::clone(map));
        }
        // Outside the lock: other threads need other maps meanwhile.
        let map = Arc::new(Self::new(spec)?);
        if map.frame().len() <= MAX_CELLS {
            let mut recent = lock();
            if recent.len() >= MAX_MAPS {
                recent.remove(0);
            }
            recent.push((spec.clone(), Arc::clone(&map)));
        }
        Ok(map)
    }
}

fn lock() -> std::sync::MutexGuard<'static, Vec<(MapSpec, Arc<WorldMap>)>> {
    // The list is complete even after a panic: entries are made before the lock is taken.
    RECENT.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::VectorMap;

    #[test]
    fn the_same_specification_gives_the_same_map_and_another_another() {
        let spec = |width: f64| MapSpec::Vector(VectorMap::empty([0.0; 2], [width, 3.17], 0.1));
        let first = WorldMap::recent(&spec(4.0)).unwrap();
        let again = WorldMap::recent(&spec(4.0)).unwrap();
        assert!(Arc::ptr_eq(&first, &again));
        let other = WorldMap::recent(&spec(5.0)).unwrap();
        assert_ne!(other.frame().width, first.frame().width);
        let bad = MapSpec::Vector(VectorMap::empty([0.0; 2], [f64::NAN, 1.0], 0.1));
        assert!(WorldMap::recent(&bad).is_err());
    }
}
