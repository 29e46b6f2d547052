use control::go_to::GoToParams;
use geometry::map::WorldMap;
use geometry::shape::Shape;
use planner_view::limits::Limits;
use testing::{circle, rectangle};

use super::*;
use crate::awg::Mode;
use crate::awg::tests::{awg, octagon, points};
use crate::contour::Contour;
use crate::mission::{AlphaChoice, Drive, Mission, MissionParams};

const RADIUS: f64 = 0.22;

/// A map from (-2, -2) to (17, 17) m.
fn map(obstacles: &[Shape]) -> WorldMap {
    let map = testing::map([-2.0; 2], [17.0; 2], 0.1, obstacles.iter().cloned());
    WorldMap::from_vectors(&map).unwrap()
}

fn known(map: &WorldMap) -> Room<'_> {
    Room::new(*map.bounds(), Some(map.shapes()), RADIUS)
}

/// The octagon, threatened within 2 m of one of its corners.
fn threatened_corner() -> Mission {
    let params: MissionParams = toml::from_str(
        "contour = [[5, 0], [0, 5], [0, 10], [5, 15], [10, 15], [15, 10], [15, 5], [10, 0]]\n\
         danger_zones = [{ circle = { center = [5, 0], radius = 2 } }]",
    )
    .unwrap();
    let drive = Drive {
        limits: Limits::new(1.0, 0.0, 5.2).unwrap(),
        acceleration: None,
        angular_acceleration: None,
    };
    params.prepare(&drive, &GoToParams::default(), 1).unwrap()
}

/// Number of the first 1000 waypoints where the robot does not fit.
fn misfits(mission: &Mission, room: &Room<'_>) -> usize {
    let laps = mission.awg.clone().laps(mission.key.source().unwrap());
    laps.take(1000).filter(|w| !room.fits(w.point)).count()
}

#[test]
fn a_width_that_the_time_allows_does_not_lead_out_of_the_map() {
    let map = map(&[]);
    for room in [known(&map), Room::new(*map.bounds(), None, RADIUS)] {
        let wide = threatened_corner();
        assert_eq!(wide.alpha_choice, AlphaChoice::Time);
        assert!(wide.awg.params().alpha > 4.0, "{:?}", wide.awg.params());
        assert!(misfits(&wide, &room) > 50);
        let fitted = wide.within(&room);
        assert_eq!(fitted.alpha_choice, AlphaChoice::Room);
        assert_eq!(misfits(&fitted, &room), 0);
        // 1.78 m beside the contour, on one side, and ahead of it.
        let alpha = fitted.awg.params().alpha;
        assert!((2.0..3.56 + 1e-9).contains(&alpha), "{alpha}");
    }
}

#[test]
fn a_width_for_which_there_is_room_stays_bit_for_bit() {
    let map = map(&[]);
    let awg = awg(&octagon(), 120.0, 1.7, Mode::default());
    assert_eq!(known(&map).widest(&awg, 0.1, 0.9), 0.9);
}

#[test]
fn known_walls_beside_the_contour_bound_the_width() {
    // A street of 2 m between two blocks.
    let walls = [
        rectangle([7.0, 3.0], [6.0, 1.0]),
        rectangle([7.0, 7.0], [6.0, 1.0]),
    ];
    let (map, contour) = (
        map(&walls),
        Contour::open(&points(&[(2.0, 5.0), (12.0, 5.0)])).unwrap(),
    );
    let awg = awg(&contour, 25.0, 1.0, Mode::default());
    let free = 2.0 - 2.0 * RADIUS;
    let widest = known(&map).widest(&awg, 0.1, 6.0);
    assert!((free..1.2 * free).contains(&widest), "{widest}");
    // A robot that does not know them is bounded by the map alone.
    let unknown = Room::new(*map.bounds(), None, RADIUS);
    assert!(unknown.widest(&awg, 0.1, 6.0) > 4.0);
}

#[test]
fn places_behind_a_thin_wall_are_out_of_reach() {
    let wall = rectangle([7.0, 6.0], [8.0, 0.02]);
    let map = map(&[wall]);
    let contour = Contour::open(&points(&[(2.0, 5.0), (12.0, 5.0)])).unwrap();
    let awg = awg(&contour, 25.0, 1.0, Mode::default());
    let widest = known(&map).widest(&awg, 0.1, 6.0);
    assert!(widest < 2.1, "{widest}");
}

#[test]
fn a_post_beside_the_contour_leaves_the_zig_zag_wide() {
    let post = circle([7.0, 5.6], 0.1);
    let map = map(&[post]);
    let contour = Contour::open(&points(&[(2.0, 5.0), (12.0, 5.0)])).unwrap();
    let awg = awg(&contour, 25.0, 1.0, Mode::default());
    assert!(known(&map).widest(&awg, 0.1, 1.5) > 1.2);
}

#[test]
fn a_leg_that_is_tighter_than_the_robot_does_not_narrow_the_others() {
    let walls = [
        rectangle([7.0, 3.7], [6.0, 1.0]),
        rectangle([7.0, 6.3], [6.0, 1.0]),
    ];
    let map = map(&walls);
    let contour = Contour::open(&points(&[(2.0, 5.0), (12.0, 5.0), (12.0, 15.0)])).unwrap();
    let awg = awg(&contour, 50.0, 1.0, Mode::default());
    assert!(known(&map).widest(&awg, 0.1, 1.5) > 1.4);
}

#[test]
fn a_block_across_the_contour_does_not_count() {
    let block = rectangle([7.0, 5.0], [2.0, 6.0]);
    let map = map(&[block]);
    let contour = Contour::open(&points(&[(2.0, 5.0), (12.0, 5.0)])).unwrap();
    let awg = awg(&contour, 25.0, 1.0, Mode::default());
    assert!(known(&map).widest(&awg, 0.1, 1.0) > 0.5);
}

#[test]
fn a_contour_along_the_edge_of_the_map_gets_the_least_width() {
    let map = map(&[]);
    let edge = -2.0 + RADIUS;
    let contour = Contour::open(&points(&[(2.0, edge), (12.0, edge)])).unwrap();
    let awg = awg(&contour, 25.0, 1.0, Mode::default());
    assert_eq!(known(&map).widest(&awg, 0.1, 1.0), 0.1);
    assert_eq!(known(&map).widest(&awg, 0.1, 0.05), 0.05);
}
