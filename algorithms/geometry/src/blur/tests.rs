use proptest::prelude::*;

use super::*;

/// The experiments' city (25 blocks, outer wall with an exit, four chamfers) on 300 × 300 cells.
pub(crate) fn city() -> Grid<bool> {
    let frame = GridFrame {
        width: 300,
        height: 300,
        resolution: 19.0 / 300.0,
        origin: Point2::new(-9.5, -9.5),
    };
    let mut free = Grid::filled(frame, true);
    for row in 0..frame.height {
        for col in 0..frame.width {
            let p = frame.center(col, row);
            free.cells[frame.index(col, row)] = !in_city_wall(p.x, p.y);
        }
    }
    free
}

/// The city as the original program registered it: its 300 samples per axis lie 19/299 m apart but
/// were taken for 19/300 m cells, and the grid's origin was moved by half a cell. Obstacles appear
/// shifted towards negative coordinates, by nothing at −9.5 m up to one cell at +9.5 m.
pub(crate) fn city_as_published() -> Grid<bool> {
    let resolution = 19.0 / 300.0;
    let corner = -9.5 - resolution / 2.0;
    let frame = GridFrame {
        width: 300,
        height: 300,
        resolution,
        origin: Point2::new(corner, corner),
    };
    let mut free = Grid::filled(frame, true);
    let sample = |i: usize| -9.5 + 19.0 * i as f64 / 299.0;
    for row in 0..frame.height {
        for col in 0..frame.width {
            free.cells[frame.index(col, row)] = !in_city_wall(sample(col), sample(row));
        }
    }
    free
}

fn in_city_wall(x: f64, y: f64) -> bool {
    let near_block = |c: f64| (0..5).any(|i| (c - (f64::from(i) * 3.0 - 6.0)).abs() <= 1.0);
    let (ax, ay) = (x.abs(), y.abs());
    let ring = ax.max(ay) > 8.0 && ax.max(ay) < 9.0;
    let exit = x > 8.0 && ay < 1.25;
    let chamfer = ax < 8.0 && ay < 8.0 && ax + ay > 15.5;
    (near_block(x) && near_block(y)) || (ring && !exit) || chamfer
}

fn uniform(width: usize, height: usize, free: bool) -> Grid<bool> {
    let frame = GridFrame {
        width,
        height,
        resolution: 0.1,
        origin: Point2::new(-1.0, 2.0),
    };
    Grid::filled(frame, free)
}

/// The values are those of the nearest cell in the original; these are interpolated.
#[test]
fn city_values_match_the_papers_map() {
    let map = BlurredMap::new(&city_as_published(), PAPER_SIGMA).unwrap();
    for (x, y, expected) in [
        (4.5, 4.5, 0.9999),
        (4.5, 0.0, 0.9918),
        (8.5, 1.0, 0.8804),
        (-4.5, 7.5, 0.9940),
        (1.1, 1.5, 0.9948),
    ] {
        let value = map.value(Point2::new(x, y));
        assert!(
            (value - expected).abs() < 0.02,
            "B({x}, {y}) = {value}, not {expected}"
        );
    }
    assert_eq!(map.value(Point2::new(0.0, 0.0)), 0.0, "inside a block");
    assert_eq!(map.value(Point2::new(9.6, 0.0)), 0.0, "outside the grid");
    assert_eq!(map.value(Point2::new(f64::NAN, 0.0)), 0.0);
}

/// The published field is 2.2 times the gradient, taken in the nearest cell: half a cell from the
/// requested point, which in the curved part of the blur is 0.15.
#[test]
fn city_gradients_match_the_papers_map() {
    let map = BlurredMap::new(&city_as_published(), PAPER_SIGMA).unwrap();
    for (x, y, gx, gy) in [
        (4.5, 4.5, -0.001, -0.001),
        (4.5, 0.0, -0.126, 0.0),
        (8.5, 1.0, 0.015, -2.331),
        (-4.5, 7.5, 0.0, -0.217),
        (1.1, 1.5, 0.068, -0.115),
    ] {
        let field = 2.2 * map.gradient(Point2::new(x, y));
        let error = (field - Vector2::new(gx, gy)).norm();
        assert!(error < 0.25, "2.2 ∇B({x}, {y}) = {field}, not ({gx}, {gy})");
    }
}

/// On the true map a street's centre line is level.
#[test]
fn the_true_map_is_level_on_street_centre_lines() {
    let map = BlurredMap::new(&city(), PAPER_SIGMA).unwrap();
    for i in 0..140 {
        let along = -7.0 + 0.1 * f64::from(i);
        for centre in [-4.5, -1.5, 1.5, 4.5] {
            let g = map.gradient(Point2::new(along, centre));
            assert!(g.y.abs() < 0.06, "{g} at ({along}, {centre})");
        }
    }
}

/// A straight wall blurs to the normal distribution function.
#[test]
fn a_wall_blurs_to_the_error_function() {
    let mut free = uniform(200, 60, true);
    for row in 0..60 {
        for col in 0..100 {
            free.cells[row * 200 + col] = false;
        }
    }
    let sigma = 0.8;
    let map = BlurredMap::new(&free, sigma).unwrap();
    let wall = -1.0 + 100.0 * 0.1;
    for i in 0..40 {
        let d = 0.05 + f64::from(i) * 0.07;
        let exact = 0.5 * (1.0 + libm::erf(d / (sigma * std::f64::consts::SQRT_2)));
        let found = map.value(Point2::new(wall + d, 5.0));
        assert!(
            (found - exact).abs() < 2e-3,
            "at {d} m: {found}, not {exact}"
        );
        let slope = map.gradient(Point2::new(wall + d, 5.0));
        let exact =
            math::exp(-0.5 * d * d / (sigma * sigma)) / (sigma * std::f64::consts::TAU.sqrt());
        assert!(
            (slope.x - exact).abs() < 4e-3 && slope.y.abs() < 1e-6,
            "{slope} at {d} m"
        );
    }
}

#[test]
fn the_gradient_is_bounded_at_walls_and_points_out_of_them() {
    let map = BlurredMap::new(&city(), PAPER_SIGMA).unwrap();
    let bound = 2.0_f64.sqrt() / (PAPER_SIGMA * (2.0 * std::f64::consts::PI).sqrt());
    for i in 0..900 {
        for j in 0..90 {
            let p = Point2::new(-9.49 + 0.021 * f64::from(i), -9.49 + 0.21 * f64::from(j));
            assert!(map.gradient(p).norm() <= bound, "at {p}");
        }
    }
    let inside_a_block = map.gradient(Point2::new(0.9, 0.0));
    assert!(inside_a_block.x > 1.0, "{inside_a_block}");
}

#[test]
fn open_and_full_maps_stay_uniform_up_to_their_edges() {
    let open = BlurredMap::new(&uniform(7, 3, true), 0.25).unwrap();
    assert!(open.grid().cells.iter().all(|v| (v - 1.0).abs() < 1e-6));
    assert_eq!(open.gradient(Point2::new(-0.99, 2.01)), Vector2::zeros());
    let full = BlurredMap::new(&uniform(7, 3, false), 0.25).unwrap();
    assert!(full.grid().cells.iter().all(|&v| v == 0.0));
    let dot = BlurredMap::new(&uniform(1, 1, true), 0.05).unwrap();
    assert!((dot.value(Point2::new(-0.95, 2.05)) - 1.0).abs() < 1e-6);
}

#[test]
fn the_two_layers_rebuild_the_map() {
    let map = BlurredMap::new(&city(), PAPER_SIGMA).unwrap();
    let again = BlurredMap::from_parts(map.grid().clone(), map.occupied().clone()).unwrap();
    assert_eq!(map, again);
}

#[test]
fn bad_input_is_named() {
    let good = uniform(4, 4, true);
    for sigma in [0.0, -1.0, f64::NAN, f64::INFINITY, 0.5] {
        let error = BlurredMap::new(&good, sigma).unwrap_err();
        assert!(error.to_string().contains("sigma"), "{error}");
    }
    let mut short = good.clone();
    short.cells.pop();
    assert!(matches!(
        BlurredMap::new(&short, 0.2),
        Err(BlurError::Length {
            found: 15,
            expected: 16,
            ..
        })
    ));
    let empty = uniform(0, 4, true);
    assert!(matches!(
        BlurredMap::new(&empty, 0.2),
        Err(BlurError::Size { .. })
    ));
    let mut odd = good.clone();
    odd.frame.resolution = f64::NAN;
    assert!(matches!(
        BlurredMap::new(&odd, 0.2),
        Err(BlurError::Resolution { .. })
    ));
    let map = BlurredMap::new(&good, 0.2).unwrap();
    let mut blurred = map.grid().clone();
    blurred.cells[5] = f32::NAN;
    assert!(matches!(
        BlurredMap::from_parts(blurred, map.occupied().clone()),
        Err(BlurError::Value { cell: 5, .. })
    ));
    let mut moved = map.occupied().clone();
    moved.frame.origin.x += 1.0;
    assert_eq!(
        BlurredMap::from_parts(map.grid().clone(), moved),
        Err(BlurError::FrameMismatch)
    );
}

proptest! {
    /// More obstacles never increase the openness of a point, to the last bit.
    #[test]
    fn adding_obstacles_never_brightens(
        cells in proptest::collection::vec(any::<bool>(), 12 * 9),
        extra in proptest::collection::vec(any::<bool>(), 12 * 9),
        sigma in 0.03..0.9_f64,
    ) {
        let frame = uniform(12, 9, true).frame;
        let less: Vec<bool> = cells.iter().zip(&extra).map(|(&a, &b)| a && b).collect();
        let before = BlurredMap::new(&Grid { frame, cells }, sigma).unwrap();
        let after = BlurredMap::new(&Grid { frame, cells: less }, sigma).unwrap();
        for (b, a) in before.grid().cells.iter().zip(&after.grid().cells) {
            prop_assert!(a <= b);
        }
    }

    /// The value is continuous away from walls: a small step changes it by the gradient's bound.
    #[test]
    fn values_are_bounded_and_continuous_in_open_cells(
        x in -9.4..9.4_f64, y in -9.4..9.4_f64, angle in -3.1..3.1_f64,
    ) {
        let map = BlurredMap::new(&city(), PAPER_SIGMA).unwrap();
        let (sin, cos) = math::sincos(angle);
        let (p, q) = (Point2::new(x, y), Point2::new(x + 1e-3 * cos, y + 1e-3 * sin));
        let (v, w) = (map.value(p), map.value(q));
        prop_assert!((0.0..=1.0).contains(&v));
        if v > 0.0 && w > 0.0 {
            prop_assert!((v - w).abs() < 4e-3);
        }
    }
}
