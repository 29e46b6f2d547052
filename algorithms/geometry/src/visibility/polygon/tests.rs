use core::f64::consts::PI;

use proptest::prelude::*;

use super::span::direction;
use super::*;
use crate::blur::tests::city;
use crate::blur::{BlurredMap, PAPER_SIGMA};
use crate::visibility::VisibilityField;

fn all_round(x: f64, y: f64) -> Viewpoint {
    Viewpoint {
        position: Point2::new(x, y),
        heading: 0.3,
        limits: SightLimits::default(),
    }
}

/// The border, including the viewpoint if it closes over it.
fn polygon(walls: &Walls, viewpoint: &Viewpoint) -> Vec<Point2<f64>> {
    let mut border = walls.seen_from(viewpoint);
    if !viewpoint.limits.is_all_round() && !border.is_empty() {
        border.push(viewpoint.position);
    }
    border
}

fn area(polygon: &[Point2<f64>]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    polygon
        .iter()
        .zip(next)
        .map(|(a, b)| a.coords.perp(&b.coords))
        .sum::<f64>()
        / 2.0
}

fn contains(polygon: &[Point2<f64>], p: Point2<f64>) -> bool {
    let next = polygon.iter().cycle().skip(1);
    let crossings = polygon.iter().zip(next).filter(|(a, b)| {
        (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
    });
    crossings.count() % 2 == 1
}

fn distance_to(polygon: &[Point2<f64>], p: Point2<f64>) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let sides = polygon.iter().zip(next).map(|(a, b)| {
        let (along, offset) = (b - a, p - a);
        let part = (offset.dot(&along) / along.norm_squared().max(1e-300)).clamp(0.0, 1.0);
        (offset - along * part).norm()
    });
    sides.fold(f64::INFINITY, f64::min)
}

fn room(width: usize, height: usize, occupied: &[(usize, usize)]) -> Grid<bool> {
    let frame = GridFrame {
        width,
        height,
        resolution: 0.5,
        origin: Point2::new(-1.0, -2.0),
    };
    let mut grid = Grid::filled(frame, false);
    for &(column, row) in occupied {
        grid.cells[frame.index(column, row)] = true;
    }
    grid
}

#[test]
fn an_empty_room_is_seen_whole_and_its_walls_are_four() {
    let walls = Walls::new(room(8, 4, &[]));
    assert_eq!(walls.walls.len(), 4);
    let seen = walls.seen_from(&all_round(0.2, -1.3));
    assert!((area(&seen) - 8.0).abs() < 1e-9, "{seen:?}");
    assert!(walls.seen_from(&all_round(9.0, 0.0)).is_empty(), "outside");
    let blocked = Walls::new(room(8, 4, &[(2, 1)]));
    assert!(blocked.seen_from(&all_round(0.2, -1.3)).is_empty());
}

#[test]
fn range_and_field_of_view_cut_the_view() {
    let walls = Walls::new(room(400, 400, &[]));
    let mut viewpoint = all_round(90.0, 90.0);
    viewpoint.limits.range = Some(10.0);
    let disc = area(&walls.seen_from(&viewpoint));
    // A polygon of 72 corners in the circle.
    assert!((disc / (PI * 100.0) - 1.0).abs() < 2e-3, "{disc}");
    viewpoint.limits.field_of_view = Some(1.0);
    let sector = polygon(&walls, &viewpoint);
    assert!((area(&sector) / 50.0 - 1.0).abs() < 2e-3);
    assert!(contains(
        &sector,
        viewpoint.position + direction(0.3 + 0.49) * 9.0
    ));
    assert!(!contains(
        &sector,
        viewpoint.position + direction(0.3 - 0.51) * 9.0
    ));
    // A wall within the range: half of the disc beyond 5 m is hidden.
    let mut near = all_round(4.0, 90.0);
    near.limits.range = Some(10.0);
    let cut = area(&walls.seen_from(&near));
    let gone = 100.0 * math::acos(0.5) - 5.0 * 75_f64.sqrt();
    assert!((cut / (PI * 100.0 - gone) - 1.0).abs() < 3e-3, "{cut}");
}

#[test]
fn on_a_wall_is_as_beside_it() {
    let walls = Walls::new(room(8, 4, &[(4, 1)]));
    // On the side that a free and an occupied cell share, and where four cells meet.
    for (x, y) in [(1.5, -1.25), (1.0, -1.0), (1.5, -1.0)] {
        let seen = walls.seen_from(&all_round(x, y));
        let all = 8.0 - 0.25;
        assert!(area(&seen) > 1.0 && area(&seen) <= all, "{x} {y}: {seen:?}");
    }
}

/// The border of the region visible from a viewpoint, by comparing all walls in every direction.
fn seen_by_comparing_all(walls: &Walls, viewpoint: &Viewpoint) -> Vec<Point2<f64>> {
    let Some(place) = walls.stand(viewpoint.position) else {
        return Vec::new();
    };
    let turn = viewpoint.limits.field_of_view.unwrap_or(TAU);
    let begin = viewpoint.heading - 0.5 * turn;
    let (spans, _) = walls.spans(place, begin);
    let ends = spans.iter().flat_map(|span| [span.begins, span.ends]);
    let mut directions: Vec<f64> = ends
        .filter(|angle| (0.0..turn).contains(angle))
        .chain([0.0, turn])
        .collect();
    directions.sort_by(f64::total_cmp);
    directions.dedup_by(|a, b| *a - *b < SAME_DIRECTION);
    let mut view = View::new(
        place,
        begin,
        viewpoint.limits.range.unwrap_or(f64::INFINITY),
    );
    let nearest = |pair: &[f64]| {
        let middle = f64::midpoint(pair[0], pair[1]);
        let ray = direction(begin + middle);
        let open = spans
            .iter()
            .filter(|span| span.begins < middle && span.ends > middle);
        let nearest = open.min_by(|a, b| a.distance(ray).total_cmp(&b.distance(ray)));
        nearest.map(|span| (span, pair[0], pair[1]))
    };
    let pieces: Vec<_> = directions.windows(2).filter_map(nearest).collect();
    for wall in pieces.chunk_by(|(a, ..), (b, ..)| a.from == b.from) {
        let (&(span, from, _), &(_, _, to)) = (wall.first().unwrap(), wall.last().unwrap());
        view.add(span, from, to);
    }
    view.finish(viewpoint.limits.is_all_round())
}

proptest! {
    #[test]
    fn the_sweep_finds_what_comparing_all_walls_finds(
        cells in prop::collection::vec((0_usize..24, 0_usize..18), 0..120),
        place in prop_oneof![
            (-1.0..11.0, -2.0..7.0),
            // In line with many corners.
            (0_u8..48, 0_u8..36).prop_map(|(column, row)| {
                (-1.0 + 0.25 * f64::from(column), -2.0 + 0.25 * f64::from(row))
            }),
        ],
        heading in prop_oneof![-4.0..4.0, Just(PI), Just(0.0), Just(1e3)],
        range in prop::option::of(0.3..12.0),
        field_of_view in prop::option::of(0.1..6.2),
    ) {
        let walls = Walls::new(room(24, 18, &cells));
        let viewpoint = Viewpoint {
            position: Point2::new(place.0, place.1),
            heading,
            limits: SightLimits { range, field_of_view },
        };
        prop_assert_eq!(walls.seen_from(&viewpoint), seen_by_comparing_all(&walls, &viewpoint));
    }

    #[test]
    fn walls_stand_in_closed_rows(
        cells in prop::collection::vec((0_usize..24, 0_usize..18), 0..120),
    ) {
        let walls = Walls::new(room(24, 18, &cells)).walls;
        let mut begun = vec![0; walls.len()];
        for wall in &walls {
            begun[wall.next] += 1;
            prop_assert!((wall.from + wall.along - walls[wall.next].from).norm() < 1e-12);
        }
        prop_assert!(begun.iter().all(|&times| times == 1));
    }

    #[test]
    fn angles_are_those_of_one_turn(angle in prop_oneof![-20.0..20.0, Just(0.0), Just(TAU), Just(-TAU)]) {
        prop_assert_eq!(from_begin(angle).to_bits(), f64::rem_euclid(angle, TAU).to_bits());
    }

    /// The polygon contains the points that lines of sight reach.
    #[test]
    fn in_the_polygon_is_what_lines_of_sight_reach(
        cells in prop::collection::vec((0_usize..24, 0_usize..18), 0..60),
        viewpoint in (-1.0..11.0, -2.0..7.0),
        heading in -4.0..4.0,
        range in prop::option::of(0.3..12.0),
        field_of_view in prop::option::of(0.1..6.2),
        targets in prop::collection::vec((-1.0..11.0, -2.0..7.0), 60),
    ) {
        let grid = room(24, 18, &cells);
        let free = Grid {
            frame: grid.frame,
            cells: grid.cells.iter().map(|occupied| !occupied).collect(),
        };
        let map = BlurredMap::new(&free, PAPER_SIGMA);
        prop_assume!(map.is_ok());
        let field = VisibilityField::new(&map.unwrap());
        let walls = Walls::new(grid);
        let viewpoint = Viewpoint {
            position: Point2::new(viewpoint.0, viewpoint.1),
            heading,
            limits: SightLimits { range, field_of_view },
        };
        let polygon = polygon(&walls, &viewpoint);
        for (x, y) in targets {
            let target = Point2::new(x, y);
            let offset = target - viewpoint.position;
            let off = math::angle_difference(math::atan2(offset.y, offset.x), heading).abs();
            let covered = range.is_none_or(|range| offset.norm() <= range)
                && field_of_view.is_none_or(|angle| off <= 0.5 * angle);
            let seen = covered && field.is_visible(viewpoint.position, target);
            // Arcs are chords, and corners may be grazed.
            let doubtful = 0.001 + range.map_or(0.0, |range| 0.001 * range);
            if distance_to(&polygon, target) > doubtful {
                prop_assert_eq!(contains(&polygon, target), seen, "{:?}", target);
            }
        }
    }
}

#[test]
fn the_citys_walls_are_few_and_views_of_it_small() {
    let free = city();
    let walls = Walls::new(Grid {
        frame: free.frame,
        cells: free.cells.iter().map(|free| !free).collect(),
    });
    assert!(walls.walls.len() < 400, "{}", walls.walls.len());
    let mut looked = 0;
    for index in (0..free.cells.len()).step_by(997) {
        let (column, row) = (index % free.frame.width, index / free.frame.width);
        let at = free.frame.center(column, row);
        let seen = walls.seen_from(&all_round(at.x, at.y));
        assert_eq!(seen.is_empty(), !free.cells[index]);
        assert!(seen.len() < 200, "{}", seen.len());
        looked += usize::from(!seen.is_empty());
    }
    assert!(looked > 30, "{looked}");
}
