//! Lines of sight: the faster march must give the same results as the definition.

use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};
use nalgebra::Point2;
use planner_view::map::PlannerMap;
use proptest::prelude::*;

/// The march by its definition, a look-up per step.
fn defined(map: &PlannerMap, from: Point2<f64>, to: Point2<f64>, radius: f64) -> f64 {
    let line = to - from;
    let length = line.norm();
    let least_step = map.clearance_grid().frame.resolution;
    let mut run = 0.0;
    for _ in 0..20_000 {
        let at = if length > 0.0 {
            from + line * (run / length)
        } else {
            from
        };
        let spare = map.cell_clearance(at) - radius;
        if spare < 0.0 {
            return run;
        }
        if run >= length {
            return length;
        }
        run = (run + spare.max(least_step)).min(length);
    }
    run
}

proptest! {
    #[test]
    fn a_march_gets_as_far_as_by_its_definition(
        (width, height) in (1_usize..40, 1_usize..40),
        resolution in prop_oneof![Just(0.05), Just(0.25), 0.01_f64..2.0],
        origin in prop_oneof![Just((0.0, 0.0)), Just((-9.0, -9.0)), (-1e3_f64..1e3, -1e9_f64..1e9)],
        clearances in proptest::collection::vec(-0.2_f32..1.0, 16),
        lines in proptest::collection::vec((-0.1_f64..1.1, -0.1_f64..1.1, -0.1_f64..1.1, -0.1_f64..1.1, any::<bool>()), 20),
        radius in 0.0_f64..0.3,
    ) {
        let frame = GridFrame {
            width,
            height,
            resolution,
            origin: Point2::new(origin.0, origin.1),
        };
        let blurred = BlurredMap::new(&Grid::filled(frame, true), resolution).unwrap();
        let cells = (0..width * height).map(|i| clearances[i * 7 % 16]).collect();
        let map = PlannerMap::new(blurred, Grid { frame, cells }, 1).unwrap();
        let mut ends = Vec::new();
        for (x, y, to_x, to_y, on_edges) in lines {
            // Along the edges of cells the faster march gives no result.
            let place = |part: f64, cells: usize, origin: f64| {
                let cell = part * cells as f64;
                origin + if on_edges { cell.round() } else { cell } * resolution
            };
            let from = Point2::new(place(x, width, origin.0), place(y, height, origin.1));
            let to = Point2::new(place(to_x, width, origin.0), place(to_y, height, origin.1));
            prop_assert_eq!(
                map.free_run(from, to, radius),
                defined(&map, from, to, radius)
            );
            ends.push((from, to));
        }
        for four in ends.as_chunks::<4>().0 {
            let side_by_side = map.free_runs(*four, radius);
            prop_assert_eq!(side_by_side, four.map(|(from, to)| map.free_run(from, to, radius)));
        }
    }
}
