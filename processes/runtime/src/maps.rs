//! Maps that the processes of one thread share. In a run with processes each process builds its own
//! data of a map; runs in one process build it once for all robots and runs.
//!
//! The runner of a thread hands its processes the cache ([`Process::share_maps`](crate::kind::Process::share_maps));
//! there is none between processes. All its values are functions of the map state's description and of the
//! obstacle changes since. It therefore does not matter which run made them.

use std::any::Any;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use geometry::map::{MapSpec, ObstacleChange};
use ipc_types::messages::world::{MapCell, MapHeader};

/// Maximum number of cached maps; beyond it the oldest is dropped. With the path trees that its
/// planners store, a map may take some 100 MB in a sweep of thousands of runs.
const MAX_MAPS: usize = 16;

/// Components of a map message.
#[derive(Debug, Clone, PartialEq)]
pub struct MapState {
    /// The map state at the start.
    pub spec: Arc<MapSpec>,
    /// Changes since then, in order.
    pub changes: Vec<ObstacleChange>,
    /// Standard deviation of the blur (m).
    pub blur_sigma: f64,
}

/// A map message without its stamp.
#[derive(Debug, Clone)]
struct MapContent {
    map_state: MapState,
    header: MapHeader,
    cells: Arc<[MapCell]>,
    /// `true` if a reader has checked the cells.
    is_checked: bool,
    /// Values that readers derived from the cells, one of each type.
    derived: Vec<Arc<dyn Any + Send + Sync>>,
}

/// Maps by their components.
#[derive(Debug, Default)]
pub struct Maps {
    drawn: Mutex<Vec<MapContent>>,
}

impl Maps {
    /// Returns the message of a map state, whose description the state then shares. If there is none yet, `draw` makes it, and its stamp is
    /// that of this caller.
    ///
    /// # Errors
    /// Those of `draw`.
    pub fn message<E>(
        &self,
        map_state: &mut MapState,
        draw: impl FnOnce() -> Result<(MapHeader, Vec<MapCell>), E>,
    ) -> Result<(MapHeader, Arc<[MapCell]>), E> {
        if let Some(known) = self
            .lock()
            .iter()
            .find(|drawn| drawn.map_state == *map_state)
        {
            map_state.spec = Arc::clone(&known.map_state.spec);
            return Ok((known.header, Arc::clone(&known.cells)));
        }
        let (header, cells) = draw()?;
        let cells = Arc::from(cells);
        let mut drawn = self.lock();
        // Another thread may have been faster: all must share the same cells.
        if let Some(known) = drawn.iter().find(|drawn| drawn.map_state == *map_state) {
            return Ok((known.header, Arc::clone(&known.cells)));
        }
        if drawn.len() >= MAX_MAPS {
            drawn.remove(0);
        }
        drawn.push(MapContent {
            map_state: map_state.clone(),
            header,
            cells: Arc::clone(&cells),
            is_checked: false,
            derived: Vec::new(),
        });
        Ok((header, cells))
    }

    /// Returns `true` if a reader has checked these cells, which came from [`Maps::message`].
    pub(crate) fn is_checked(&self, cells: &Arc<[MapCell]>) -> bool {
        let mut drawn = self.lock();
        find(&mut drawn, cells).is_some_and(|drawn| drawn.is_checked)
    }

    /// Marks these cells as checked and valid.
    pub(crate) fn mark_checked(&self, cells: &Arc<[MapCell]>) {
        if let Some(drawn) = find(&mut self.lock(), cells) {
            drawn.is_checked = true;
        }
    }

    /// Returns the value of type `T` stored with cells that came from [`Maps::message`]; the first
    /// call creates the default. `None` for other cells.
    pub(crate) fn derived<T: Any + Default + Send + Sync>(
        &self,
        cells: &Arc<[MapCell]>,
    ) -> Option<Arc<T>> {
        let mut drawn = self.lock();
        let derived = &mut find(&mut drawn, cells)?.derived;
        let mut known = derived.iter();
        if let Some(value) = known.find_map(|value| Arc::clone(value).downcast().ok()) {
            return Some(value);
        }
        let value = Arc::<T>::default();
        derived.push(Arc::clone(&value) as Arc<dyn Any + Send + Sync>);
        Some(value)
    }

    fn lock(&self) -> MutexGuard<'_, Vec<MapContent>> {
        self.drawn.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn find<'a>(drawn: &'a mut [MapContent], cells: &Arc<[MapCell]>) -> Option<&'a mut MapContent> {
    drawn
        .iter_mut()
        .find(|drawn| Arc::ptr_eq(&drawn.cells, cells))
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use geometry::map::{ObstacleId, VectorMap};

    use super::*;

    fn map_state(width: f64) -> MapState {
        MapState {
            spec: Arc::new(MapSpec::Vector(VectorMap::empty(
                [0.0; 2],
                [width, 2.0],
                0.5,
            ))),
            changes: Vec::new(),
            blur_sigma: 0.5,
        }
    }

    fn cells(maps: &Maps, map_state: &MapState, drawn: &mut u32) -> Arc<[MapCell]> {
        let draw = || {
            *drawn += 1;
            Ok::<_, Infallible>((MapHeader::default(), vec![MapCell::default(); 4]))
        };
        let Ok((_, cells)) = maps.message(&mut map_state.clone(), draw);
        cells
    }

    #[test]
    fn a_message_is_made_once_per_map_state() {
        let (maps, mut drawn) = (Maps::default(), 0);
        let first = cells(&maps, &map_state(4.0), &mut drawn);
        let again = cells(&maps, &map_state(4.0), &mut drawn);
        assert!(Arc::ptr_eq(&first, &again) && drawn == 1);
        let mut changed = map_state(4.0);
        changed
            .changes
            .push(ObstacleChange::Disappear { id: ObstacleId(3) });
        for other in [map_state(5.0), changed] {
            let other = cells(&maps, &other, &mut drawn);
            // Equal cells of another map state are not the same cells.
            assert!(!Arc::ptr_eq(&first, &other));
        }
        assert_eq!(drawn, 3);
    }

    #[test]
    fn derived_values_are_stored_with_their_cells_by_type() {
        let (maps, mut drawn) = (Maps::default(), 0);
        let known = cells(&maps, &map_state(4.0), &mut drawn);
        let first = maps.derived::<Mutex<u32>>(&known).unwrap();
        *first.lock().unwrap() = 7;
        let again = maps.derived::<Mutex<u32>>(&known).unwrap();
        assert!(Arc::ptr_eq(&first, &again) && *again.lock().unwrap() == 7);
        assert_eq!(*maps.derived::<u32>(&known).unwrap(), 0);
        let other = cells(&maps, &map_state(5.0), &mut drawn);
        assert_eq!(
            *maps.derived::<Mutex<u32>>(&other).unwrap().lock().unwrap(),
            0
        );
        // Other cells have no stored values.
        let foreign: Arc<[MapCell]> = Arc::from(vec![MapCell::default(); 4]);
        assert!(maps.derived::<u32>(&foreign).is_none());
    }

    #[test]
    fn cells_are_checked_once() {
        let (maps, mut drawn) = (Maps::default(), 0);
        let known = cells(&maps, &map_state(4.0), &mut drawn);
        let other = cells(&maps, &map_state(5.0), &mut drawn);
        assert!(!maps.is_checked(&known));
        maps.mark_checked(&known);
        assert!(maps.is_checked(&known) && !maps.is_checked(&other));
        let foreign: Arc<[MapCell]> = Arc::from(vec![MapCell::default(); 4]);
        maps.mark_checked(&foreign);
        assert!(!maps.is_checked(&foreign));
    }

    #[test]
    fn the_oldest_map_goes_when_there_are_too_many() {
        let (maps, mut drawn) = (Maps::default(), 0);
        for width in 0..=MAX_MAPS {
            cells(&maps, &map_state(4.0 + width as f64), &mut drawn);
        }
        let before = drawn;
        cells(&maps, &map_state(5.0), &mut drawn);
        assert_eq!(drawn, before, "the second is still there");
        cells(&maps, &map_state(4.0), &mut drawn);
        assert_eq!(drawn, before + 1, "the first is not");
    }
}
