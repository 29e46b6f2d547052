//! Comparison of the city of the scenarios with that of the chasing game.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;

use geometry::map::{MapSpec, UnknownCells, WorldMap};
use geometry::pose::{Pose2, Twist2};
use nalgebra::Point2;
use robot::spec::RobotSpec;
use robot::team::Role;
use sim_backend::spec::{RulesSpec, WorldSpec};
use sim_backend::world::{World, WorldError};

fn map_spec(name: &str) -> MapSpec {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../scenarios/maps")
        .join(name);
    MapSpec::File {
        path,
        unknown: UnknownCells::default(),
    }
    .load(Path::new(""))
    .unwrap()
}

/// Returns `true` if the description of the city has an obstacle at a point.
fn described(x: f64, y: f64) -> bool {
    let in_block = |c: f64| {
        [
            (-7.0, -5.0),
            (-4.0, -2.0),
            (-1.0, 1.0),
            (2.0, 4.0),
            (5.0, 7.0),
        ]
        .iter()
        .any(|&(low, high)| c >= low && c <= high)
    };
    let outer = x.abs().max(y.abs());
    let in_wall = (8.0..=9.0).contains(&outer);
    let in_gap = x >= 8.0 && y.abs() < 1.25;
    let in_chamfer = x.abs() + y.abs() > 15.5 && outer < 8.0;
    (in_block(x) && in_block(y)) || (in_wall && !in_gap) || in_chamfer
}

#[test]
fn the_free_part_is_that_of_the_papers_map() {
    // The paper's grid: 300 samples from edge to edge along each axis.
    let map = WorldMap::new(&map_spec("city.toml")).unwrap();
    let sample = |i: u32| -9.5 + 19.0 * f64::from(i) / 299.0;
    let free = (0..300)
        .flat_map(|i| (0..300).map(move |j| (i, j)))
        .filter(|&(i, j)| map.distance(Point2::new(sample(i), sample(j)) * (1.0 - 1e-12)) > 0.0)
        .count();
    assert_eq!(free, 48_380);
    assert!((free as f64 / 90_000.0 - 0.5376).abs() < 1e-4);
}

#[test]
fn every_point_is_as_described() {
    let map = WorldMap::new(&map_spec("city.toml")).unwrap();
    // Off the lattice of the borders, where description and drawing may differ by rounding.
    for i in 0..950 {
        for j in 0..950 {
            let (x, y) = (-9.49 + 0.02 * f64::from(i), -9.49 + 0.02 * f64::from(j));
            let p = Point2::new(x + 0.001, y + 0.0013);
            assert_eq!(map.distance(p) == 0.0, described(p.x, p.y), "at {p}");
        }
    }
    for (i, &occupied) in map.occupancy().cells.iter().enumerate() {
        let frame = map.frame();
        let p = frame.center(i % frame.width, i / frame.width);
        // Some centres lie on the slope of a chamfer, where rounding decides.
        if (p.x.abs() + p.y.abs() - 15.5).abs() > 1e-9 {
            assert_eq!(occupied, described(p.x, p.y), "at {p}");
        }
    }
}

#[test]
fn clearances_are_known_where_they_can_be_told_by_hand() {
    let map = WorldMap::new(&map_spec("city.toml")).unwrap();
    let at = |x, y| map.distance(Point2::new(x, y));
    assert!((at(1.5, 0.0) - 0.5).abs() < 1e-12);
    assert!((at(1.5, 1.5) - 0.5f64.sqrt()).abs() < 1e-12);
    // In the gap: to its side, and nearer to the edge of the map to that.
    assert!((at(8.2, 0.25) - 1.0).abs() < 1e-12);
    assert!((at(9.25, 0.0) - 0.25).abs() < 1e-12);
    // From the corner crossing of the ring road to the chamfer, across its slope.
    assert!((at(7.5, 7.5) - 0.5f64.sqrt() / 2.0).abs() < 1e-12);
    assert_eq!(at(0.0, 0.0), 0.0);
    assert!((at(9.25, 5.0) - 0.25).abs() < 1e-12);
}

#[test]
fn the_chase_can_start_and_the_exit_can_be_reached() {
    let robots = vec![
        RobotSpec::new(
            "police",
            Role::Pursuer,
            Pose2::new(7.5, 4.5, core::f64::consts::PI),
        ),
        RobotSpec::new("baddie", Role::Evader, Pose2::new(-4.5, 7.5, 0.0)),
    ];
    let spec = WorldSpec {
        map: map_spec("city.toml"),
        robots: robots.clone(),
        rules: RulesSpec::default(),
        seed: 0,
    };
    assert_eq!(World::new(spec.clone()).unwrap().exits().len(), 1);
    let mut broad = spec;
    broad.robots[1].radius = Some(0.49);
    assert!(World::new(broad.clone()).is_ok(), "streets are 1 m wide");
    broad.robots[1].radius = Some(0.6);
    assert!(matches!(World::new(broad), Err(WorldError::InWall { .. })));
}

#[test]
fn hello_has_a_wall_to_drive_around() {
    let mut world = World::new(WorldSpec {
        map: map_spec("hello.toml"),
        robots: vec![RobotSpec::new(
            "a",
            Role::Neutral,
            Pose2::new(0.5, 0.5, 0.0),
        )],
        rules: RulesSpec::default(),
        seed: 0,
    })
    .unwrap();
    for _ in 0..400 {
        let commands = [Some(Twist2::new(0.2, 0.0))];
        world.step(&commands, core::time::Duration::from_millis(50));
    }
    let robot = &world.robots()[0];
    assert!(
        (robot.pose.x - (1.9 - robot.radius())).abs() < 1e-6,
        "{}",
        robot.pose.x
    );
    assert_eq!(robot.contacts.wall, 1);
}
