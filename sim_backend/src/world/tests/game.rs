use geometry::map::{ObstacleChange, ObstacleId};
use geometry::region::Region;
use testing::{circle, rectangle};

use super::*;
use crate::robot::RobotStatus;
use crate::spec::{CaptureSpec, MissionEnd};

fn chase(rules: RulesSpec) -> World {
    let robots = vec![
        racer("p1", Role::Pursuer, -1.0, 0.0, 0.0),
        racer("p2", Role::Pursuer, 1.0, 0.0, core::f64::consts::PI),
        racer("e", Role::Evader, 0.0, 0.0, core::f64::consts::FRAC_PI_2),
    ];
    world(room(vec![]), robots, rules)
}

fn capture(dwell: f64) -> RulesSpec {
    RulesSpec {
        capture: Some(CaptureSpec {
            radius: 0.5,
            dwell,
            ..CaptureSpec::default()
        }),
        ..RulesSpec::default()
    }
}

#[test]
fn two_police_at_once_are_one_capture_by_the_nearer_then_by_the_first() {
    let mut world = chase(capture(0.0));
    let events = kinds(world.step(&[drive(11.0, 0.0), drive(12.0, 0.0), None], TICK));
    let [
        EventKind::Captured {
            evader: 2,
            by: 1,
            distance,
        },
        EventKind::GameOver { reason },
    ] = events[..]
    else {
        panic!("{events:?}")
    };
    assert!((distance - 0.4).abs() < 1e-9);
    assert_eq!(reason, GameOver::Decided);
    assert_eq!(world.robots()[2].status, RobotStatus::Caught);
    assert_eq!(world.robots()[2].caught_by, Some(1));
    assert_eq!(world.robots()[2].finished_at, Some(TICK));
    assert!(world.is_over());
    assert!(world.step(&[], TICK).is_empty());

    let mut world = chase(capture(0.0));
    world.step(&[drive(12.0, 0.0), drive(12.0, 0.0), None], TICK);
    assert_eq!(world.robots()[2].caught_by, Some(0));
}

/// Both pursuers are near enough, and the nearer is not of a hostile team.
#[test]
fn only_pursuers_of_hostile_teams_catch() {
    let mut robots = vec![
        racer("guard", Role::Pursuer, -0.2, 0.0, 0.0),
        racer("ranger", Role::Pursuer, 0.4, 0.0, 0.0),
        racer("poacher", Role::Evader, 0.0, 0.0, 0.0),
        racer("thief", Role::Evader, 0.0, 3.0, 0.0),
    ];
    for (robot, team) in robots
        .iter_mut()
        .zip(["guards", "rangers", "poachers", "thieves"])
    {
        (robot.team, robot.role) = (team.to_owned(), Some(robot.role()));
    }
    robots[0].hostile_to = Some(vec!["thieves".to_owned()]);
    robots[2].hostile_to = Some(vec!["rangers".to_owned()]);
    let mut world = world(room(vec![]), robots, capture(0.0));
    world.step(&[], TICK);
    assert_eq!(world.robots()[2].caught_by, Some(1));
    assert_eq!(world.robots()[3].status, RobotStatus::Active);
    assert!(!world.is_over());
}

#[test]
fn the_capture_radius_itself_does_not_catch() {
    let mut world = chase(capture(0.0));
    world.step(&[drive(10.0, 0.0), None, None], TICK);
    assert_eq!(world.robots()[0].pose.x, -0.5);
    assert!(world.robots()[2].is_active());
}

#[test]
fn a_thin_wall_shields_from_capture_if_the_rules_say_so() {
    // A wall 4 cm thick between the two; a second Police robot comes round its end.
    let wall = rectangle([0.0, 0.0], [0.02, 1.0]);
    for through_walls in [true, false] {
        let robots = vec![
            racer("p1", Role::Pursuer, -0.2, 0.0, 0.0),
            racer("p2", Role::Pursuer, 3.0, 0.0, 0.0),
            racer("e", Role::Evader, 0.2, 0.0, 0.0),
        ];
        let mut rules = capture(0.0);
        rules.capture.as_mut().unwrap().through_walls = through_walls;
        let mut world = world(room(vec![wall.clone()]), robots, rules);
        world.step(&[], TICK);
        assert_eq!(world.robots()[2].caught_by, through_walls.then_some(0));
        // The far one comes within reach on the evader's side: it is farther away, and catches.
        world.step(&[None, drive(-46.8, 0.0), None], TICK);
        let by = usize::from(!through_walls);
        assert_eq!(world.robots()[2].caught_by, Some(by));
    }
}

#[test]
fn an_obstacle_that_appears_shields_from_capture_if_the_rules_say_so() {
    let robots = vec![
        racer("p", Role::Pursuer, -0.25, 0.0, 0.0),
        racer("e", Role::Evader, 0.3, 0.0, 0.0),
    ];
    let mut rules = capture(0.0);
    rules.capture.as_mut().unwrap().through_walls = false;
    let mut world = world(room(vec![]), robots, rules);
    world
        .apply(&ObstacleChange::Appear {
            id: ObstacleId(7),
            shape: circle([0.0, 0.0], 0.05),
        })
        .unwrap();
    world.step(&[drive(2.0, 0.0), None], TICK);
    assert!((world.robots()[0].pose.x + 0.15).abs() < 1e-6);
    assert!(world.robots()[1].is_active());
}

#[test]
fn a_dwell_must_be_uninterrupted() {
    let mut world = chase(capture(0.15));
    let near = [drive(12.0, 0.0), None, None];
    let stay = [None, None, None];
    let away = [drive(-12.0, 0.0), None, None];
    for commands in [near, stay, away, near, stay] {
        world.step(&commands, TICK);
        assert!(world.robots()[2].is_active());
    }
    world.step(&stay, TICK);
    assert_eq!(world.robots()[2].status, RobotStatus::Caught);
}

#[test]
fn a_caught_evader_does_not_escape_in_the_same_tick() {
    let exit = Region::Circle {
        center: [0.0, 0.0],
        radius: 0.2,
    };
    for (advance, status) in [(12.0, RobotStatus::Caught), (9.0, RobotStatus::Escaped)] {
        let mut world = chase(RulesSpec {
            exits: vec![exit],
            ..capture(0.0)
        });
        world.step(&[drive(advance, 0.0), None, None], TICK);
        assert_eq!(world.robots()[2].status, status);
    }
}

#[test]
fn escaped_evaders_leave_and_caught_ones_stay_unless_the_rules_differ() {
    use crate::spec::OutOfPlay::{Remove, Stay};
    let exit = Region::Circle {
        center: [0.0, 0.0],
        radius: 0.2,
    };
    for (escaped, x) in [(Remove, 0.5), (Stay, -0.2)] {
        let rules = RulesSpec {
            exits: vec![exit],
            escaped,
            ..RulesSpec::default()
        };
        let mut world = chase(rules);
        world.step(&[], TICK);
        assert_eq!(world.robots()[2].status, RobotStatus::Escaped);
        world.step(&[drive(30.0, 0.0), None, None], TICK);
        assert!((world.robots()[0].pose.x - x).abs() < 1e-6, "{escaped:?}");
    }
    for (caught, x) in [(Remove, 0.6), (Stay, -0.2)] {
        let mut world = chase(RulesSpec {
            caught,
            ..capture(0.0)
        });
        world.step(&[drive(12.0, 0.0), None, None], TICK);
        assert_eq!(world.robots()[2].status, RobotStatus::Caught);
        world.step(&[drive(20.0, 0.0), None, drive(5.0, 0.0)], TICK);
        assert!((world.robots()[0].pose.x - x).abs() < 1e-6, "{caught:?}");
        assert_eq!(
            world.robots()[2].pose.y,
            0.0,
            "a caught robot ignores its commands"
        );
    }
}

#[test]
fn time_runs_out_exactly_and_without_drift() {
    let rules = RulesSpec {
        time_limit: Some(100.0),
        ..RulesSpec::default()
    };
    let mut world = chase(rules);
    for _ in 0..999 {
        world.step(&[], Duration::from_millis(100));
    }
    assert!(!world.is_over());
    let events = kinds(world.step(&[], Duration::from_millis(100)));
    assert_eq!(
        events,
        [
            EventKind::TimedOut { robot: 2 },
            EventKind::GameOver {
                reason: GameOver::TimeLimit
            }
        ]
    );
    assert_eq!(world.time(), Duration::from_secs(100));
    assert_eq!(world.robots()[2].status, RobotStatus::TimedOut);
    assert!(world.robots()[0].is_active());
}

#[test]
fn a_mission_may_go_on_until_its_time_limit_though_all_have_finished() {
    let mut robot = racer("walker", Role::Neutral, 0.0, 0.0, 0.0);
    robot.goal = Some(Region::Circle {
        center: [0.0, 0.0],
        radius: 1.0,
    });
    let rules = RulesSpec {
        time_limit: Some(1.0),
        end: MissionEnd::TimeLimit,
        ..RulesSpec::default()
    };
    let mut world = world(room(vec![]), vec![robot], rules);
    while !world.is_over() {
        world.step(&[], TICK);
    }
    assert_eq!(world.time(), Duration::from_secs(1));
    assert_eq!(world.game_over(), Some(GameOver::TimeLimit));
    assert_eq!(world.robots()[0].status, RobotStatus::Arrived);
}

#[test]
fn a_neutral_robot_arrives_at_its_goal() {
    let mut robot = racer("walker", Role::Neutral, 0.0, 0.0, 0.0);
    robot.goal = Some(Region::Rectangle {
        center: [2.0, 0.0],
        half_extents: [0.49, 0.5],
        angle: 0.0,
    });
    let mut world = world(room(vec![]), vec![robot], RulesSpec::default());
    let mut steps = 0;
    while !world.is_over() {
        world.step(&[drive(1.0, 0.0)], TICK);
        steps += 1;
    }
    assert_eq!(world.robots()[0].status, RobotStatus::Arrived);
    assert_eq!(world.game_over(), Some(GameOver::Decided));
    assert_eq!(steps, 31);
}

#[test]
fn bad_commands_stop_the_robot_and_are_reported_once() {
    let robot = racer("a", Role::Neutral, 0.0, 0.0, 0.0);
    let mut world = world(room(vec![]), vec![robot], RulesSpec::default());
    world.step(&[drive(1.0, 0.0)], TICK);
    let x = world.robots()[0].pose.x;
    for (command, reports) in [(drive(f64::NAN, 0.0), 1), (drive(0.0, f64::INFINITY), 0)] {
        assert_eq!(world.step(&[command], TICK).len(), reports);
        assert_eq!(world.robots()[0].pose.x, x);
    }
    assert_eq!(world.robots()[0].invalid_commands, 2);
    // A missing command stops as well, without a report; an excessive one is clamped.
    assert!(world.step(&[], TICK).is_empty());
    assert!(world.step(&[None], TICK).is_empty());
    assert_eq!(world.robots()[0].pose.x, x);
    world.step(&[drive(1e5, 0.0)], Duration::from_millis(1));
    assert!((world.robots()[0].pose.x - x - 0.1).abs() < 1e-12);
    assert_eq!(world.step(&[drive(f64::NAN, 0.0)], TICK).len(), 1);
    // An absurd command is rejected.
    let x = world.robots()[0].pose.x;
    assert!(
        world.step(&[drive(1e300, 0.0)], TICK).is_empty(),
        "reported"
    );
    assert_eq!(world.robots()[0].pose.x, x);
    assert_eq!(world.robots()[0].invalid_commands, 4);
}

#[test]
fn a_step_of_no_length_moves_nothing() {
    let mut world = chase(RulesSpec::default());
    let before = world.robots().to_vec();
    world.step(&[drive(1.0, 1.0); 3], Duration::ZERO);
    assert_eq!(world.robots(), before);
    assert_eq!(world.tick(), 1);
}

#[test]
fn slip_and_noise_keep_within_the_limits_and_repeat_with_the_seed() {
    let run = |seed| {
        let mut robot = racer("a", Role::Neutral, 0.0, 0.0, 0.0);
        robot.limits.v_max = Some(1.0);
        robot.limits.omega_max = Some(2.0);
        robot.actuator = robot::spec::ActuatorSpec {
            slip: 0.1,
            noise: 0.3,
            veer: 0.5,
            ..Default::default()
        };
        let map = room(vec![]);
        let spec = WorldSpec {
            map,
            robots: vec![robot],
            rules: RulesSpec::default(),
            seed,
        };
        let mut world = World::new(spec).unwrap();
        for _ in 0..50 {
            world.step(&[drive(1.0, 0.0)], TICK);
            let twist = world.robots()[0].twist;
            assert!(twist.v <= 1.0 && twist.omega.abs() <= 2.0);
        }
        world.robots()[0].pose
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
    assert!(run(1).x < 2.4, "it slips: {}", run(1).x);
    assert_ne!(run(1).y, 0.0, "it veers");
}

#[test]
fn a_robot_that_stands_before_its_goal_is_reported_once_per_standstill() {
    let mut robot = racer("r", Role::Neutral, 0.0, 0.0, 0.0);
    robot.goal = Some(Region::Circle {
        center: [4.0, 0.0],
        radius: 0.1,
    });
    let idle = racer("idle", Role::Neutral, 0.0, 3.0, 0.0);
    let mut world = world(room(vec![]), vec![robot, idle], RulesSpec::default());
    let mut reports = Vec::new();
    // A turn on the spot is no progress, nor is less than 5 cm; between 15 s and 20 s it drives.
    for tick in 1..=900 {
        let command = match tick {
            0..=300 => drive(0.002, 1.0),
            301..=400 => drive(0.2, 0.0),
            _ => None,
        };
        for event in world.step(&[command, None], TICK) {
            assert!(
                matches!(event.kind, EventKind::Stands { robot: 0, .. }),
                "{event:?}"
            );
            reports.push(event.time.as_secs_f64());
        }
    }
    assert_eq!(reports.len(), 2, "{reports:?}");
    assert_eq!(reports[0], 10.0);
    assert!((reports[1] - 30.0).abs() < 0.5, "{reports:?}");
}

#[test]
fn a_robot_that_is_shifted_goes_on_from_there_or_stays_where_it_was() {
    let robots = vec![
        racer("tom", Role::Neutral, 0.0, 0.0, 0.0),
        racer("jerry", Role::Neutral, 3.0, 0.0, 0.0),
    ];
    let wall = vec![testing::circle([0.0, 3.0], 1.0)];
    let mut world = world(room(wall), robots, RulesSpec::default());
    let go = [drive(1.0, 0.0), drive(1.0, 0.0)];
    world.step(&go, TICK);
    let before = world.robots().to_vec();
    for (x, y, words) in [
        (5.5, 0.0, "is outside the map"),
        (f64::NAN, 0.0, "is outside the map"),
        (0.0, 1.95, "is in a wall: at (0, 1.95)"),
        (3.1, 0.1, "\"jerry\" and robots[0] \"tom\" overlap"),
    ] {
        let error = world.shift(&[(0, Pose2::new(x, y, 0.0))]).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
        assert_eq!(world.robots(), before);
    }
    // Both at once, each to the place of the other.
    let [a, b] = [before[0].pose, before[1].pose];
    world.shift(&[(0, b), (1, a), (9, a)]).unwrap();
    world.step(&go, TICK);
    assert!((world.robots()[0].pose.x - 3.1).abs() < 1e-12);
    assert!((world.robots()[0].distance_travelled - 0.1).abs() < 1e-12);
}

#[test]
fn a_robot_outside_of_the_simulation_is_where_it_was_measured() {
    let robots = vec![
        racer("real", Role::Neutral, 0.0, 0.0, 0.0),
        racer("other", Role::Neutral, 3.0, 0.0, 0.0),
    ];
    let mut world = world(room(Vec::new()), robots, RulesSpec::default());
    world.step(&[drive(1.0, 0.0), drive(1.0, 0.0)], TICK);
    assert_eq!(world.robots()[0].pose.x, 0.05);
    let (pose, twist) = (Pose2::new(1.05, 1.0, 2.0), Twist2::new(0.3, -0.1));
    world.place(0, pose, twist);
    for _ in 0..3 {
        world.step(&[drive(1.0, 0.0), drive(1.0, 0.0)], TICK);
    }
    let [real, other] = world.robots() else {
        panic!("two robots")
    };
    assert_eq!((real.pose, real.twist), (pose, twist));
    assert!((real.distance_travelled - (0.05 + 2.0_f64.sqrt())).abs() < 1e-12);
    assert!((other.pose.x - 3.2).abs() < 1e-12);
    // Rules see it there.
    let mut world_end = world.clone();
    world_end.place(0, Pose2::new(3.25, 0.0, 0.0), Twist2::STOP);
    world_end.step(&[None, None], TICK);
    assert!(
        kinds(world_end.events())
            .iter()
            .any(|kind| matches!(kind, EventKind::ContactBegan { .. }))
    );
    world.place(9, pose, twist);
}
