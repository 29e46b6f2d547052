use nalgebra::Point2;
use proptest::prelude::*;

use super::*;

fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Rectangle {
    Rectangle::new(Point2::new(x0, y0), Point2::new(x1, y1))
}

fn domain(inflated: Vec<Rectangle>) -> CoverageDomain {
    CoverageDomain::new(rectangle(0.0, 0.0, 10.0, 10.0), 0.1, inflated).unwrap()
}

fn coverable(domain: &CoverageDomain) -> [usize; 3] {
    CELL_SIDES.map(|side| CellGrid::new(domain, side).unwrap().coverable())
}

#[test]
fn the_papers_workplaces_have_the_known_numbers_of_coverable_cells() {
    assert_eq!(coverable(&domain(vec![])), [9604, 1600, 400]);
    let case_1 = domain(vec![rectangle(2.4, 2.4, 7.6, 7.6)]);
    assert_eq!(coverable(&case_1), [6900, 1200, 300]);
    let case_2 = domain(vec![
        rectangle(0.1, 3.4, 3.1, 6.6),
        rectangle(6.9, 3.4, 9.9, 6.6),
    ]);
    assert_eq!(coverable(&case_2), [7684, 1312, 328]);
}

#[test]
fn points_on_a_border_belong_to_the_cell_above_it() {
    let grid = CellGrid::new(&domain(vec![]), 0.1).unwrap();
    // 0.3 / 0.1 is less than 3 in floating point.
    assert_eq!(grid.cell_of(Point2::new(0.3, 0.0)), 3);
    assert_eq!(grid.cell_of(Point2::new(10.0, 10.0)), grid.len() - 1);
    assert_eq!(grid.cell_of(Point2::new(-5.0, f64::NAN)), 0);
}

#[test]
fn a_leg_counts_its_start_once_and_whole_numbers_of_steps() {
    let mut meter = Meter::new(&domain(vec![]), 0.125).unwrap();
    meter.goal(Point2::new(1.0, 1.0));
    meter.goal(Point2::new(2.0, 1.0));
    meter.goal(Point2::new(2.0, 1.0));
    let points: u32 = meter.path()[0].counts().iter().sum();
    // The start, 8 points of the leg of a metre, 1 of the leg of length 0.
    assert_eq!(points, 10);
    assert_eq!(meter.length(), 1.0);
    let figures = meter.figures();
    assert_eq!(figures.goals[0].covered, 2);
    // A disc of 0.1 m along y = 1 reaches the centres at 0.95 and 1.05, from x = 0.95 to 2.05.
    assert_eq!(figures.disc.covered, 24);
}

#[test]
fn a_path_can_be_cut_at_a_length() {
    let mut meter = Meter::new(&domain(vec![]), 0.125).unwrap();
    meter.goal(Point2::new(1.0, 1.0));
    assert!(meter.goal_within(Point2::new(4.0, 1.0), 5.0));
    assert!(!meter.goal_within(Point2::new(9.0, 1.0), 5.0));
    assert!((meter.length() - 5.0).abs() < 1e-12);
    assert_eq!(meter.last(), Some(Point2::new(6.0, 1.0)));
    assert_eq!(meter.figures().goals[0].covered, 2);
}

#[test]
fn visits_that_are_the_same_everywhere_have_no_variation() {
    let mut visits = Visits::new(CellGrid::new(&domain(vec![]), 0.5).unwrap());
    assert_eq!(visits.variation(), f64::INFINITY);
    for cell in 0..400 {
        visits.add(visits.grid().center(cell));
    }
    assert_eq!((visits.variation(), visits.rate()), (0.0, 1.0));
    // One cell of 400 with 401 points: mean 2, deviation √(399 · 1 + 399²)/20.
    for _ in 0..400 {
        visits.add(visits.grid().center(7));
    }
    let expected = (399.0_f64 + 399.0 * 399.0).sqrt() / 20.0 / 2.0;
    assert!((visits.variation() - expected).abs() < 1e-12);
}

#[test]
fn lanes_a_diameter_apart_sweep_everything() {
    let mut meter = Meter::new(&domain(vec![]), 0.125).unwrap();
    for lane in 0..50 {
        let y = 0.1 + 0.2 * f64::from(lane);
        let (from, to) = if lane % 2 == 0 {
            (0.1, 9.9)
        } else {
            (9.9, 0.1)
        };
        meter.goal(Point2::new(from, y));
        meter.goal(Point2::new(to, y));
    }
    let figures = meter.figures();
    assert_eq!(figures.disc.share(), 1.0);
    assert!((figures.length - 499.8).abs() < 1e-9);
}

#[test]
fn unusable_workplaces_and_cells_are_refused_with_what_to_change() {
    let bounds = rectangle(0.0, 0.0, 10.0, 10.0);
    let error = CoverageDomain::new(rectangle(0.0, 0.0, f64::NAN, 1.0), 0.1, vec![]).unwrap_err();
    assert!(error.to_string().starts_with("workplace from (0, 0)"));
    let error = CoverageDomain::new(bounds, 5.0, vec![]).unwrap_err();
    assert!(error.to_string().contains("radius = 5"), "{error}");
    let error = CoverageDomain::new(bounds, 0.1, vec![rectangle(3.0, 3.0, 2.0, 4.0)]).unwrap_err();
    assert!(error.to_string().starts_with("inflated obstacle"));
    let open = domain(vec![]);
    for side in [0.0, -1.0, f64::NAN, 1e-6] {
        let error = CellGrid::new(&open, side).unwrap_err();
        assert!(matches!(error, CoverageError::CellSide { .. }), "{error}");
    }
    let full = domain(vec![bounds]);
    let error = CellGrid::new(&full, 0.5).unwrap_err();
    assert_eq!(error, CoverageError::NothingCoverable { side: 0.5 });
    assert!(matches!(
        Meter::new(&open, 0.0),
        Err(CoverageError::Step { .. })
    ));
}

proptest! {
    #[test]
    fn swept_cells_are_those_near_the_path(
        points in prop::collection::vec((0.0..10.0, 0.0..10.0), 2..6),
        radius in 0.0..0.6,
    ) {
        let grid = CellGrid::new(&domain(vec![]), 0.25).unwrap();
        let mut swept = SweptCells::new(grid.clone(), radius);
        let points: Vec<_> = points.iter().map(|&(x, y)| Point2::new(x, y)).collect();
        for leg in points.windows(2) {
            swept.sweep(leg[0], leg[1]);
        }
        for cell in 0..grid.len() {
            let center = grid.center(cell);
            // Nearest of many points along the legs: within 0.02 m of the true nearest point.
            let near = points
                .windows(2)
                .flat_map(|leg| (0..=700).map(|i| leg[0] + (leg[1] - leg[0]) * (f64::from(i) / 700.0)))
                .map(|p| (p - center).norm())
                .fold(f64::INFINITY, f64::min);
            if near <= radius {
                prop_assert!(swept.cells()[cell]);
            }
            if near > radius + 0.02 {
                prop_assert!(!swept.cells()[cell]);
            }
        }
    }
}
