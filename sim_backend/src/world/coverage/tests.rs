use core::time::Duration;

use expect_test::expect;
use geometry::map::{MapSpec, ObstacleChange, ObstacleId, VectorMap};
use geometry::pose::Twist2;
use geometry::region::Region;
use proptest::prelude::*;

use super::*;
use crate::spec::{OutOfPlay, RulesSpec, WorldSpec};
use crate::world::{World, WorldError};
use robot::drive::integrate;
use robot::spec::{LimitsSpec, RobotSpec};
use robot::team::Role;
use testing::{circle, rectangle};

const TICK: Duration = Duration::from_millis(50);

/// A room of 4 m × 3 m with its corner in the origin, cells of 0.05 m.
fn room() -> VectorMap {
    VectorMap::empty([0.0, 0.0], [4.0, 3.0], 0.05)
}

fn robot(name: &str, x: f64, y: f64, theta: f64) -> RobotSpec {
    let mut robot = RobotSpec::new(name, Role::Neutral, Pose2::new(x, y, theta));
    robot.radius = Some(0.1);
    robot.limits = LimitsSpec {
        v_max: Some(50.0),
        v_reverse_max: Some(50.0),
        omega_max: Some(50.0),
        ..LimitsSpec::default()
    };
    robot
}

fn try_world(
    map: VectorMap,
    robots: Vec<RobotSpec>,
    coverage: CoverageSpec,
) -> Result<World, WorldError> {
    World::new(WorldSpec {
        map: MapSpec::Vector(map),
        robots,
        rules: RulesSpec {
            coverage: Some(coverage),
            ..RulesSpec::default()
        },
        seed: 3,
    })
}

fn world(map: VectorMap, robots: Vec<RobotSpec>, coverage: CoverageSpec) -> World {
    try_world(map, robots, coverage).unwrap()
}

fn figures(world: &World) -> CoverageFigures {
    world.coverage().unwrap().figures(world.time())
}

fn visits_at(world: &World, x: f64, y: f64) -> u32 {
    let coverage = world.coverage().unwrap();
    let cell = coverage.frame().index_at(Point2::new(x, y)).unwrap();
    coverage.visits().nth(cell).unwrap()
}

/// Per cell, the minimum distance of a point of the path from its centre (m), by brute force.
fn nearest(frame: &GridFrame, way: &[Point2<f64>]) -> Vec<f64> {
    (0..frame.height)
        .flat_map(|row| (0..frame.width).map(move |col| frame.center(col, row)))
        .map(|center| {
            let squares = way.iter().map(|p| (p - center).norm_squared());
            squares.fold(f64::INFINITY, f64::min).sqrt()
        })
        .collect()
}

#[test]
fn without_the_rule_nothing_is_accounted_for() {
    let world = World::new(WorldSpec {
        map: MapSpec::Vector(room()),
        robots: vec![robot("walle", 1.0, 1.0, 0.0)],
        rules: RulesSpec::default(),
        seed: 1,
    })
    .unwrap();
    assert!(world.coverage().is_none());
}

#[test]
fn at_the_start_the_footprints_are_visited() {
    let spec = CoverageSpec {
        radius: Some(0.3),
        ..CoverageSpec::default()
    };
    let world = world(room(), vec![robot("walle", 1.0, 1.0, 0.0)], spec);
    let f = figures(&world);
    assert_eq!(f.free, 80 * 60);
    // π · 0.3² / 0.05² = 113.1 cells.
    assert!((108..=118).contains(&f.visited), "{}", f.visited);
    assert_eq!(f.visits, f.visited as u64);
    assert_eq!(f.fraction(), f.visited as f64 / 4800.0);
    assert_eq!(f.max_idleness, 0.0);
    assert_eq!(f.way, 0.0);
    // A share p of the cells has one visit: √(p(1 − p))/p.
    let p = f.covered as f64 / f.coverable as f64;
    assert!((f.unevenness - ((1.0 - p) / p).sqrt()).abs() < 1e-9);
}

#[test]
fn the_distance_is_that_of_the_robots_that_count() {
    let spec = CoverageSpec {
        robots: vec!["walle".into()],
        ..CoverageSpec::default()
    };
    let robots = vec![robot("walle", 0.5, 0.5, 0.0), robot("eve", 0.5, 2.0, 0.0)];
    let mut world = world(room(), robots, spec);
    let forward = Some(Twist2::new(0.2, 0.0));
    for _ in 0..10 {
        world.step(&[forward, forward], Duration::from_millis(100));
    }
    assert!((figures(&world).way - 0.2).abs() < 1e-9);
}

#[test]
fn one_long_step_covers_what_many_short_ones_do() {
    let drive = |steps: u32| {
        let mut world = world(
            room(),
            vec![robot("walle", 0.5, 0.5, 0.3)],
            CoverageSpec::default(),
        );
        for _ in 0..steps {
            let dt = Duration::from_millis(1600) / steps;
            world.step(&[Some(Twist2::new(1.9, 0.4))], dt);
        }
        world
    };
    let (one, many) = (drive(1), drive(400));
    let visited = |world: &World| {
        let coverage = world.coverage().unwrap();
        coverage.visits().map(|n| n > 0).collect::<Vec<_>>()
    };
    let differing = visited(&one)
        .iter()
        .zip(&visited(&many))
        .filter(|(a, b)| a != b)
        .count();
    // Cells on the very rim may fall to either side of the rounding.
    assert!(differing <= 1, "{differing}");
    assert!(figures(&one).visited > 200);
}

#[test]
fn a_path_with_contacts_is_followed() {
    // Into the corner at (4, 0) at an angle: it slides along the lower wall, then stands.
    let mut world = world(
        room(),
        vec![robot("walle", 1.0, 1.0, -0.7)],
        CoverageSpec::default(),
    );
    world.step(&[Some(Twist2::new(40.0, 0.0))], Duration::from_millis(200));
    let end = world.robots()[0].pose;
    assert!((end.x - 3.9).abs() < 1e-3 && (end.y - 0.1).abs() < 1e-3);
    for (x, y, visited) in [
        (1.3, 0.75, true),
        (2.6, 0.12, true),
        (3.6, 0.12, true),
        // On the straight line to the end of the step, which the robot did not drive.
        (2.45, 0.55, false),
    ] {
        assert_eq!(visits_at(&world, x, y) > 0, visited, "({x}, {y})");
    }
}

#[test]
fn a_stay_is_one_visit_and_idleness_is_the_time_since() {
    let mut world = world(
        room(),
        vec![robot("walle", 1.0, 1.5, 0.0)],
        CoverageSpec::default(),
    );
    let (there, back) = (Some(Twist2::new(1.0, 0.0)), Some(Twist2::new(-1.0, 0.0)));
    for _ in 0..20 {
        world.step(&[None], TICK);
    }
    assert_eq!(visits_at(&world, 1.0, 1.5), 1);
    for command in [there, back] {
        for _ in 0..20 {
            world.step(&[command], TICK);
        }
    }
    assert_eq!(visits_at(&world, 1.01, 1.52), 2);
    assert_eq!(visits_at(&world, 1.51, 1.52), 2);
    // A turn on the spot does not interrupt the visit.
    assert_eq!(visits_at(&world, 2.01, 1.52), 1);
    let coverage = world.coverage().unwrap();
    let idle = |x: f64| {
        let cell = coverage.frame().index_at(Point2::new(x, 1.52)).unwrap();
        coverage.idleness(world.time()).nth(cell).unwrap()
    };
    assert!(idle(1.01).abs() < 1e-9);
    // It left this place when its rim, 0.1 m behind, had passed.
    assert!((idle(2.02) - 0.9).abs() <= 0.1, "{}", idle(2.02));
    let f = figures(&world);
    assert!(
        (f.worst_idleness - 3.0).abs() < 1e-9,
        "most cells were never visited"
    );
    assert!(f.mean_idleness > 2.5 && f.mean_idleness < 3.0);
}

#[test]
fn only_the_named_robots_and_teams_count_and_only_in_the_game() {
    let mut caught = robot("eve", 3.0, 1.0, 0.0);
    caught.team = "evader".to_owned();
    let robots = vec![
        robot("walle", 1.0, 1.0, 0.0),
        robot("auto", 1.0, 2.0, 0.0),
        caught,
    ];
    let spec = CoverageSpec {
        robots: vec!["walle".into()],
        teams: vec!["evader".into()],
        ..CoverageSpec::default()
    };
    let mut world = World::new(WorldSpec {
        map: MapSpec::Vector(room()),
        robots,
        rules: RulesSpec {
            coverage: Some(spec),
            exits: vec![Region::Circle {
                center: [3.5, 1.0],
                radius: 0.2,
            }],
            escaped: OutOfPlay::Stay,
            ..RulesSpec::default()
        },
        seed: 1,
    })
    .unwrap();
    assert_eq!(visits_at(&world, 1.0, 1.0), 1);
    assert_eq!(visits_at(&world, 1.0, 2.0), 0);
    let drive = Some(Twist2::new(0.4, 0.0));
    world.step(&[None, drive, drive], Duration::from_secs(1));
    assert!(!world.robots()[2].is_active());
    // The path to the exit counts, the stay there does not.
    assert_eq!(visits_at(&world, 3.41, 1.01), 1);
    world.step(&[], Duration::from_secs(5));
    let coverage = world.coverage().unwrap();
    let cell = coverage.frame().index_at(Point2::new(3.41, 1.01)).unwrap();
    assert_eq!(coverage.idleness(world.time()).nth(cell), Some(5.0));
}

#[test]
fn unreachable_cells_are_not_coverable() {
    let mut map = room();
    map.obstacles.push(geometry::map::ObstacleSpec {
        name: "wall".into(),
        shape: rectangle([3.0, 1.5], [0.1, 1.5]),
    });
    let mut world = world(
        map,
        vec![robot("walle", 1.0, 1.5, 0.0)],
        CoverageSpec::default(),
    );
    let f = figures(&world);
    // 0.2 m of 4 m are wall; the strip of 0.9 m behind it is out of reach.
    assert_eq!(f.free, 76 * 60);
    let room_area = 58 * 60;
    assert!(
        f.coverable < room_area && f.coverable > room_area - 60,
        "{}",
        f.coverable
    );
    let before = f.visited;
    // Without the wall, all cells are coverable.
    let obstacles = world.map().obstacles();
    let id = obstacles.iter().find(|o| o.name == "wall").unwrap().id;
    world.apply(&ObstacleChange::Disappear { id }).unwrap();
    let f = figures(&world);
    assert_eq!((f.free, f.visited), (4800, before));
    assert!(f.coverable > 4800 - 60);
    // An obstacle removes visited cells from the account, and its removal restores them.
    let id = ObstacleId(9);
    let shape = circle([1.3, 1.5], 0.15);
    world.step(&[Some(Twist2::new(12.0, 0.0))], TICK);
    let visited = figures(&world).visited;
    world.apply(&ObstacleChange::Appear { id, shape }).unwrap();
    let f = figures(&world);
    assert!(f.free < 4800 && f.visited < visited);
    assert!(f.visited <= f.free && f.covered <= f.coverable && f.coverable <= f.free);
    world.apply(&ObstacleChange::Disappear { id }).unwrap();
    assert_eq!(figures(&world).visited, visited);
}

#[test]
fn rules_that_do_not_fit_the_world_are_named() {
    let refused = |coverage: CoverageSpec| {
        try_world(room(), vec![robot("walle", 1.0, 1.0, 0.0)], coverage)
            .unwrap_err()
            .to_string()
    };
    let with = CoverageSpec::default;
    let errors = [
        CoverageSpec {
            robots: vec!["wally".into()],
            ..with()
        },
        CoverageSpec {
            teams: vec!["police".into()],
            ..with()
        },
        CoverageSpec {
            teams: vec!["neutral".into(), "gards".into()],
            ..with()
        },
        CoverageSpec {
            resolution: Some(1e-4),
            ..with()
        },
        CoverageSpec {
            period: 0.0,
            ..with()
        },
    ]
    .map(refused);
    expect![[r#"
        `rules.coverage.robots[0]` is wally: expected one of the robots walle
        `rules.coverage.teams` is ["police"]: expected a team with robots in it
        `rules.coverage.teams[1]` is gards: expected a team with robots in it
        `rules.coverage.resolution` is 0.0001: expected at least about 0.001 m on this map: at most 16000000 cells
        `rules.coverage.period` is 0: expected a number above 0 and at most 100000 (s)"#]].assert_eq(&errors.join("\n"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The visited cells are those of the discs' union, found by brute force.
    #[test]
    fn the_union_of_all_footprints_is_visited(
        starts in proptest::collection::vec((0.2..3.8_f64, 0.2..2.8_f64, -3.1..3.1_f64), 1..3),
        commands in proptest::collection::vec((-2.0..2.0_f64, -6.0..6.0_f64), 1..4),
        reach in 0.03..0.5_f64,
        resolution in proptest::option::of(0.05..0.2_f64),
    ) {
        let robots: Vec<_> = starts
            .iter()
            .enumerate()
            .map(|(i, &(x, y, theta))| robot(&format!("r{i}"), x, y, theta))
            .collect();
        let spec = CoverageSpec { radius: Some(reach), resolution, ..CoverageSpec::default() };
        let Ok(mut world) = try_world(room(), robots, spec) else {
            // The robots overlap.
            return Ok(());
        };
        let mut ways: Vec<_> = world.robots().iter().map(|r| r.pose.position()).collect();
        for &(v, omega) in &commands {
            let before: Vec<_> = world.robots().iter().map(|r| r.pose).collect();
            let command = Some(Twist2::new(v, omega));
            world.step(&vec![command; before.len()], Duration::from_millis(200));
            if world.robots().iter().any(|r| r.contacts.episodes() > 0) {
                break;
            }
            for pose in before {
                // At most 400 mm in 200 pieces.
                ways.extend((1..=200).map(|k| {
                    integrate(pose, Twist2::new(v, omega), 1e-3 * f64::from(k)).position()
                }));
            }
        }
        prop_assume!(world.robots().iter().all(|r| r.contacts.episodes() == 0));
        let coverage = world.coverage().unwrap();
        let nearest = nearest(coverage.frame(), &ways);
        for (cell, (visits, distance)) in coverage.visits().zip(nearest).enumerate() {
            let free = coverage.is_free(cell);
            prop_assert!(visits > 0 || distance > reach || !free, "cell {cell} was passed");
            // The discs leave dents of at most (1 mm)² / (2 · 30 mm) between them.
            prop_assert!(visits == 0 || distance <= reach + 2e-5 && free, "cell {cell} was not");
        }
        let figures = coverage.figures(world.time());
        let visited = coverage.visits().filter(|&n| n > 0).count();
        prop_assert_eq!(figures.visited, visited);
        prop_assert!(figures.covered <= figures.visited && figures.covered <= figures.coverable);
    }
}
