//! Maps of planners from maps of the world, without messages.

use std::sync::Arc;

use geometry::blur::{BlurError, BlurredMap};
use geometry::map::WorldMap;
use thiserror::Error;

use crate::free_space::{FreeSpace, FreeSpaceError};
use crate::map::{MapError, PlannerMap};

/// Reason why a world's map cannot be a planner's.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OfWorldError {
    /// The map cannot be blurred.
    #[error(transparent)]
    Blur(#[from] BlurError),
    /// A layer is invalid.
    #[error(transparent)]
    Layers(#[from] MapError),
    /// The pieces are invalid.
    #[error(transparent)]
    Pieces(#[from] FreeSpaceError),
}

impl PlannerMap {
    /// The map that the planners of a run get from this one: its grids, blurred with a standard deviation of
    /// `blur_sigma` (m), and its exact pieces.
    ///
    /// # Errors
    /// [`OfWorldError`] if the map cannot be blurred with this deviation.
    pub fn of_world(
        world: &WorldMap,
        blur_sigma: f64,
        revision: u64,
    ) -> Result<Self, OfWorldError> {
        let blurred = BlurredMap::of_occupied(world.occupancy(), blur_sigma)?;
        let pieces = world.parts().to_vec();
        let space = FreeSpace::new(pieces, *world.bounds(), world.frame().resolution)?;
        let map = Self::new(blurred, world.clearance().clone(), revision)?;
        Ok(map.with_space(Arc::new(space)))
    }
}

#[cfg(test)]
mod tests {
    use geometry::map::VectorMap;
    use nalgebra::Point2;

    use super::*;

    #[test]
    fn a_map_of_the_world_has_its_grids_and_its_pieces() {
        let world = WorldMap::from_vectors(&VectorMap::empty([0.0; 2], [4.0, 2.0], 0.1)).unwrap();
        let map = PlannerMap::of_world(&world, 0.2, 3).unwrap();
        assert_eq!(map.revision(), 3);
        assert_eq!(map.clearance_grid(), world.clearance());
        let space = map.space().unwrap();
        assert_eq!(space.bounds(), world.bounds());
        assert!(space.is_free(Point2::new(1.0, 1.0), 1.0));
        let refused = PlannerMap::of_world(&world, 0.0, 3).unwrap_err();
        assert!(matches!(refused, OfWorldError::Blur(_)));
    }
}
