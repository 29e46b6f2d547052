//! Excerpts of large maps: what a request contains.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use geometry::grid::{Grid, GridFrame};
use geometry::map::{CellMap, WorldMap};
use ipc_types::messages::optimiser::PlanRequest;
use nalgebra::{Point2, Vector2};
use navigation::routes::RouteFinder;
use navigator::excerpt::{Excerpt, Trip};
use planner_view::map::PlannerMap;
use proptest::prelude::*;

/// A map of 15 m × 15 m with a share of occupied cells (per 256) around a free cross.
fn noisy(noise: &[u8], share: u8) -> PlannerMap {
    let frame = GridFrame {
        width: 300,
        height: 300,
        resolution: 0.05,
        origin: Point2::new(-1.0, 2.0),
    };
    let mut cells = Grid::filled(frame, false);
    for (index, cell) in cells.cells.iter_mut().enumerate() {
        let (col, row) = (index % 300, index / 300);
        let is_free = (140..160).contains(&row) || (140..160).contains(&col);
        *cell = !is_free && noise[index * 7 % noise.len()] < share;
    }
    let world = WorldMap::from_cells(&CellMap::from_grid(&cells)).unwrap();
    PlannerMap::of_world(&world, 0.19, 1).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, ..ProptestConfig::default() })]

    #[test]
    fn a_plan_within_the_bounds_touches_no_piece_that_is_left_out(
        noise in proptest::collection::vec(any::<u8>(), 65_537),
        share in 40..200u8,
        ends in ((0..2usize, 0.05..0.95f64), (0..2usize, 0.05..0.95f64)),
        places in proptest::collection::vec((0.0..1.0f64, 0.0..1.0f64), 50),
    ) {
        let map = noisy(&noise, share);
        let space = map.space().unwrap();
        let place = |(axis, at): (usize, f64)| {
            let mut p = Point2::new(6.5, 9.5);
            p[axis] += (at - 0.5) * 14.0;
            p
        };
        let trip = Trip {
            start: place(ends.0),
            goal: place(ends.1),
            clearance: 0.125,
            start_tolerance: 0.02,
            others: 3,
        };
        prop_assert!(space.shapes().parts().len() > PlanRequest::MAX_SHAPES);
        let excerpt = Excerpt::new(&map, space, &mut RouteFinder::default(), &trip).unwrap();
        let bounds = excerpt.bounds;
        prop_assert!(bounds.contains(trip.start) && bounds.contains(excerpt.end));
        prop_assert!(space.is_free(excerpt.end, trip.clearance));
        prop_assert!(excerpt.pieces.len() + trip.others <= PlanRequest::MAX_SHAPES);
        prop_assert_eq!(excerpt.is_stretch, excerpt.end != trip.goal);
        let mut pieces = excerpt.pieces.iter().peekable();
        let parts = space.shapes().parts().iter();
        let left_out: Vec<_> = parts.filter(|part| pieces.next_if_eq(part).is_none()).collect();
        prop_assert_eq!(pieces.next(), None);
        prop_assert!(!left_out.is_empty());
        let size = bounds.max - bounds.min;
        for (x, y) in places {
            let p = bounds.min + Vector2::new(x * size.x, y * size.y);
            prop_assert!(left_out.iter().all(|part| part.distance(p) > trip.clearance));
        }
    }
}
