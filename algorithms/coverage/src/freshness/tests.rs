use geometry::shape::{Aabb, Shape};
use metrics::coverage::SweptCells;
use testing::rectangle;

use super::*;
use crate::decomposition::Decomposition;
use crate::draws::Draws;
use crate::space::{Space, point_in};
use crate::workplace::Workplace;

fn scene(obstacles: &[Shape]) -> (Workplace, Space, CellGrid) {
    let bounds = Aabb {
        min: Point2::new(-1.0, 2.0),
        max: Point2::new(5.0, 6.0),
    };
    let workplace = Workplace::new(bounds, 0.15, obstacles, 0.01).unwrap();
    let parts = Decomposition::new(&workplace).unwrap();
    let space = Space::new(&workplace, &parts, bounds.center());
    let grid = CellGrid::new(&workplace.domain().unwrap(), 0.1).unwrap();
    (workplace, space, grid)
}

/// Random points, every third leg along an axis, every tenth of length 0.
fn legs(workplace: &Workplace, count: usize) -> Vec<[Point2<f64>; 2]> {
    let mut draws = Draws::new([3; 32]);
    let inner = workplace.inner();
    (0..count)
        .map(|leg| {
            let from = point_in(&inner, [draws.unit(), draws.unit()]);
            let mut to = point_in(&inner, [draws.unit(), draws.unit()]);
            match leg % 10 {
                0 => to = from,
                3 => to.x = from.x,
                6 => to.y = from.y,
                _ => {}
            }
            [from, to]
        })
        .collect()
}

#[test]
fn a_leg_sweeps_the_cells_that_the_measure_of_coverage_counts() {
    let (workplace, space, grid) = scene(&[]);
    let mut freshness = Freshness::new(&grid, &space, 0.15, 1.0, 2);
    let mut swept = SweptCells::new(grid.clone(), 0.15);
    for [from, to] in legs(&workplace, 60) {
        let before = swept.covered();
        swept.sweep(from, to);
        let cells = freshness.sweep(from, to);
        assert_eq!(cells, swept.covered() - before, "{from} to {to}");
        let left = 1.0 - swept.rate();
        assert!((freshness.share() - left).abs() < 1e-12);
    }
    assert!(freshness.share() < 0.3);
}

#[test]
fn without_rarity_a_leg_is_worth_the_area_that_it_sweeps() {
    let (workplace, space, grid) = scene(&[]);
    let mut freshness = Freshness::new(&grid, &space, 0.15, 0.0, 2);
    for [from, to] in legs(&workplace, 60) {
        let worth = freshness.worth_of(from, to);
        let swept = freshness.sweep(from, to) as f64 * 0.01;
        assert!((worth - swept).abs() < 1e-9, "{worth} {swept}");
        assert!(freshness.worth_of(from, to).abs() < 1e-9);
    }
}

#[test]
fn a_sliver_is_worth_more_than_as_much_open_ground() {
    let (_, space, grid) = scene(&[]);
    let fresh = Freshness::new(&grid, &space, 0.15, 1.0, 2);
    let mut sliver = fresh.clone();
    // Lanes 0.6 m apart leave slivers 0.3 m wide between them.
    for lane in [3.0, 3.6] {
        sliver.sweep(Point2::new(-0.85, lane), Point2::new(4.85, lane));
    }
    let (from, to) = (Point2::new(0.0, 3.3), Point2::new(4.0, 3.3));
    let per_cell =
        |mut freshness: Freshness| freshness.worth_of(from, to) / freshness.sweep(from, to) as f64;
    let (among_fresh, alone) = (per_cell(fresh), per_cell(sliver));
    assert!(alone > 1.15 * among_fresh, "{alone} {among_fresh}");
}

#[test]
fn only_what_can_be_reached_is_fresh() {
    // A wall that closes off the right third.
    let wall = rectangle([3.0, 4.0], [0.1, 2.0]);
    let (_, space, grid) = scene(&[wall]);
    let freshness = Freshness::new(&grid, &space, 0.15, 1.0, 2);
    let rightmost = (0..freshness.left())
        .filter_map(|index| freshness.nth(index))
        .map(|p| p.x)
        .fold(f64::NEG_INFINITY, f64::max);
    assert!(rightmost < 3.0 - 0.1 - 0.15 + 1e-9, "{rightmost}");
    assert!(freshness.nth(freshness.left()).is_none());
}

#[test]
fn renewing_makes_everything_fresh_again() {
    let (workplace, space, grid) = scene(&[]);
    let mut freshness = Freshness::new(&grid, &space, 0.15, 1.0, 2);
    let whole = freshness.clone();
    for [from, to] in legs(&workplace, 20) {
        freshness.sweep(from, to);
    }
    assert!(freshness != whole);
    freshness.renew();
    assert_eq!(freshness, whole);
}
