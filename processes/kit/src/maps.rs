//! Maps that the processes of one thread share: what a run with processes builds in each of them,
//! runs in one process build once, however many robots and runs look at it.
//!
//! Found on the bus by [`Bus::commons`](ipc_types::bus::Bus::commons); there are none between
//! processes. Everything here is a function of the ground's description and of the obstacle changes
//! since, so that it does not matter which run made it.

use std::sync::{Arc, Mutex, PoisonError};

use guidance::map::PlannerMap;
use ipc_types::messages::world::{MapCell, MapHeader};
use sim_backend::map::{MapSpec, ObstacleChange};

/// Most maps that are kept; beyond it the one that was made first goes. With the trees of ways that its
/// planners keep, a map may take some 100 MB in a sweep of thousands of runs.
const MOST: usize = 16;

/// What a map message is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Ground {
    /// The ground at the start.
    pub spec: MapSpec,
    /// What has changed since, in order.
    pub changes: Vec<ObstacleChange>,
    /// Standard deviation of the blur [m].
    pub blur_sigma: f64,
}

/// A map message without its stamp.
#[derive(Debug, Clone)]
struct Drawn {
    ground: Ground,
    header: MapHeader,
    cells: Arc<[MapCell]>,
    /// With `true` those that know the exact pieces too.
    planner_maps: Vec<(bool, Arc<PlannerMap>)>,
}

/// Maps by what they are made of.
#[derive(Debug, Default)]
pub struct Maps {
    drawn: Mutex<Vec<Drawn>>,
}

impl Maps {
    /// The message of a ground, drawn by `draw` if nobody has done it yet; its stamp is that of the
    /// one who drew it.
    ///
    /// # Errors
    /// Those of `draw`.
    pub fn message<E>(
        &self,
        ground: &Ground,
        draw: impl FnOnce() -> Result<(MapHeader, Vec<MapCell>), E>,
    ) -> Result<(MapHeader, Arc<[MapCell]>), E> {
        {
            let drawn = self.drawn.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(known) = drawn.iter().find(|drawn| drawn.ground == *ground) {
                return Ok((known.header, Arc::clone(&known.cells)));
            }
        }
        let (header, cells) = draw()?;
        let cells = Arc::from(cells);
        let mut drawn = self.drawn.lock().unwrap_or_else(PoisonError::into_inner);
        // Another thread may have been faster: all must share the same cells.
        if let Some(known) = drawn.iter().find(|drawn| drawn.ground == *ground) {
            return Ok((known.header, Arc::clone(&known.cells)));
        }
        if drawn.len() >= MOST {
            drawn.remove(0);
        }
        drawn.push(Drawn {
            ground: ground.clone(),
            header,
            cells: Arc::clone(&cells),
            planner_maps: Vec::new(),
        });
        Ok((header, cells))
    }

    /// Whether somebody has made a planners' map of these cells, which came from [`Maps::message`].
    pub fn has(&self, cells: &Arc<[MapCell]>) -> bool {
        let drawn = self.drawn.lock().unwrap_or_else(PoisonError::into_inner);
        drawn
            .iter()
            .any(|drawn| Arc::ptr_eq(&drawn.cells, cells) && !drawn.planner_maps.is_empty())
    }

    /// The planners' map of cells that came from [`Maps::message`], if it has been made; `exact`:
    /// with the exact pieces beside the grids.
    pub fn known(&self, cells: &Arc<[MapCell]>, exact: bool) -> Option<Arc<PlannerMap>> {
        let drawn = self.drawn.lock().unwrap_or_else(PoisonError::into_inner);
        drawn
            .iter()
            .find(|drawn| Arc::ptr_eq(&drawn.cells, cells))?
            .planner_map(exact)
    }

    /// Keeps the planners' map of cells that came from [`Maps::message`], for all who ask later;
    /// returns the one to use, which is another's if that was faster.
    pub fn keep(
        &self,
        cells: &Arc<[MapCell]>,
        exact: bool,
        map: Arc<PlannerMap>,
    ) -> Arc<PlannerMap> {
        let mut drawn = self.drawn.lock().unwrap_or_else(PoisonError::into_inner);
        let mut all = drawn.iter_mut();
        if let Some(drawn) = all.find(|drawn| Arc::ptr_eq(&drawn.cells, cells)) {
            if let Some(known) = drawn.planner_map(exact) {
                return known;
            }
            drawn.planner_maps.push((exact, Arc::clone(&map)));
        }
        map
    }
}

impl Drawn {
    fn planner_map(&self, exact: bool) -> Option<Arc<PlannerMap>> {
        let known = self.planner_maps.iter().find(|(e, _)| *e == exact);
        known.map(|(_, map)| Arc::clone(map))
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use nalgebra::Point2;
    use sim_backend::blur::BlurredMap;
    use sim_backend::grid::{Grid, GridFrame};
    use sim_backend::map::{ObstacleId, VectorMap};

    use super::*;

    fn ground(width: f64) -> Ground {
        Ground {
            spec: MapSpec::Vector(VectorMap::empty([0.0; 2], [width, 2.0], 0.5)),
            changes: Vec::new(),
            blur_sigma: 0.5,
        }
    }

    fn cells(maps: &Maps, ground: &Ground, drawn: &mut u32) -> Arc<[MapCell]> {
        let draw = || {
            *drawn += 1;
            Ok::<_, Infallible>((MapHeader::default(), vec![MapCell::default(); 4]))
        };
        let Ok((_, cells)) = maps.message(ground, draw);
        cells
    }

    fn planner_map() -> Arc<PlannerMap> {
        let frame = GridFrame {
            width: 4,
            height: 4,
            resolution: 0.5,
            origin: Point2::origin(),
        };
        let blurred = BlurredMap::new(&Grid::filled(frame, true), 0.5).unwrap();
        Arc::new(PlannerMap::new(blurred, Grid::filled(frame, 1.0), 1).unwrap())
    }

    #[test]
    fn a_message_is_drawn_once_per_ground_and_change() {
        let (maps, mut drawn) = (Maps::default(), 0);
        let first = cells(&maps, &ground(4.0), &mut drawn);
        let again = cells(&maps, &ground(4.0), &mut drawn);
        assert!(Arc::ptr_eq(&first, &again) && drawn == 1);
        let mut changed = ground(4.0);
        changed
            .changes
            .push(ObstacleChange::Disappear { id: ObstacleId(3) });
        for other in [ground(5.0), changed] {
            let other = cells(&maps, &other, &mut drawn);
            // Equal cells of another ground are not the same cells.
            assert!(!Arc::ptr_eq(&first, &other));
        }
        assert_eq!(drawn, 3);
    }

    #[test]
    fn a_planners_map_is_kept_with_its_cells_and_by_what_it_knows() {
        let (maps, mut drawn) = (Maps::default(), 0);
        let known = cells(&maps, &ground(4.0), &mut drawn);
        assert!(!maps.has(&known) && maps.known(&known, false).is_none());
        let first = maps.keep(&known, false, planner_map());
        assert!(maps.has(&known));
        // Who comes second takes what is there.
        assert!(Arc::ptr_eq(
            &first,
            &maps.keep(&known, false, planner_map())
        ));
        assert!(maps.known(&known, true).is_none());
        let exact = maps.keep(&known, true, planner_map());
        assert!(!Arc::ptr_eq(&first, &exact));
        // Cells that came from elsewhere are not looked after.
        let foreign: Arc<[MapCell]> = Arc::from(vec![MapCell::default(); 4]);
        maps.keep(&foreign, false, planner_map());
        assert!(!maps.has(&foreign) && maps.known(&foreign, false).is_none());
    }

    #[test]
    fn the_oldest_map_goes_when_there_are_too_many() {
        let (maps, mut drawn) = (Maps::default(), 0);
        for width in 0..=MOST {
            cells(&maps, &ground(4.0 + width as f64), &mut drawn);
        }
        let before = drawn;
        cells(&maps, &ground(5.0), &mut drawn);
        assert_eq!(drawn, before, "the second is still there");
        cells(&maps, &ground(4.0), &mut drawn);
        assert_eq!(drawn, before + 1, "the first is not");
    }
}
