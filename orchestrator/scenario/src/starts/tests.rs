use geometry::map::VectorMap;
use proptest::prelude::*;
use testing::rectangle;

use super::*;

fn jittered(x: f64, jitter: f64) -> Placement {
    Placement {
        start: Pose2::new(x, 0.0, 0.0),
        radius: 0.1,
        team: Role::Neutral.into(),
        goal: None,
        draw: (jitter > 0.0).then_some(Draw::Jitter(StartJitter {
            x: jitter,
            y: jitter,
            theta: jitter,
            ..StartJitter::default()
        })),
    }
}

fn random(role: Role, random: RandomStart) -> Placement {
    Placement {
        team: role.into(),
        draw: Some(Draw::Random(random)),
        ..jittered(0.0, 0.0)
    }
}

fn field(min: [f64; 2]) -> VectorMap {
    VectorMap::empty(min, [5.0, 5.0], 0.1)
}

/// A field with a wall along x = 0 and an exit on the right.
fn divided() -> VectorMap {
    let wall = rectangle([0.0, 0.0], [0.2, 5.0]);
    let mut map = testing::map([-5.0; 2], [5.0; 2], 0.1, [wall]);
    map.exits.push(Region::Circle {
        center: [4.0, 0.0],
        radius: 0.3,
    });
    map
}

fn draw(robots: &[Placement], seed: u64, map: &VectorMap) -> Result<Vec<Pose2>, usize> {
    let map = WorldMap::from_vectors(map).unwrap();
    place(robots, seed, &map, &RulesSpec::default()).map_err(|refused| refused.index)
}

#[test]
fn the_same_seed_draws_the_same_starts_and_another_does_not() {
    let map = field([-5.0, -5.0]);
    let anywhere = random(Role::Pursuer, RandomStart::default());
    for robots in [
        [jittered(0.0, 0.05), jittered(1.0, 0.05)],
        [jittered(0.0, 0.05), anywhere],
        [anywhere, anywhere],
    ] {
        let starts = |seed| draw(&robots, seed, &map).unwrap();
        assert_eq!(starts(1), starts(1));
        assert_ne!(starts(1), starts(2));
        let longer = [&robots[..], &[anywhere]].concat();
        assert_eq!(draw(&longer, 1, &map).unwrap()[..2], starts(1)[..]);
    }
}

#[test]
fn uniform_jitter_stays_in_its_range_and_uses_it() {
    let map = field([-5.0, -5.0]);
    let mut widest: f64 = 0.0;
    for seed in 0..300 {
        let pose = draw(&[jittered(0.0, 0.05)], seed, &map).unwrap()[0];
        for v in [pose.x, pose.y, pose.theta] {
            assert!(v.abs() <= 0.05);
            widest = widest.max(v.abs());
        }
    }
    assert!(widest > 0.045, "{widest}");
}

#[test]
fn normal_jitter_has_its_standard_deviation() {
    let map = WorldMap::from_vectors(&field([-5.0, -5.0])).unwrap();
    let jitter = StartJitter {
        x: 0.1,
        distribution: Distribution::Normal,
        ..StartJitter::default()
    };
    let robots = [Placement {
        draw: Some(Draw::Jitter(jitter)),
        ..jittered(0.0, 0.0)
    }];
    let rules = RulesSpec::default();
    let xs: Vec<f64> = (0..2000)
        .map(|seed| place(&robots, seed, &map, &rules).unwrap()[0].x)
        .collect();
    let variance = xs.iter().map(|x| x * x).sum::<f64>() / xs.len() as f64;
    assert!((variance.sqrt() - 0.1).abs() < 0.006, "{}", variance.sqrt());
}

#[test]
fn robots_are_drawn_again_until_their_start_is_free() {
    // Two robots at the same place, with room around them; the map ends at x = 0.
    let robots = [jittered(0.0, 0.4), jittered(0.0, 0.4), jittered(0.3, 0.0)];
    let map = field([0.0, -5.0]);
    for seed in 0..50 {
        let at = draw(&robots, seed, &map).unwrap();
        assert_eq!(at[2], robots[2].start);
        for i in 0..3 {
            assert!(at[i].x >= 0.1 || i == 2);
            for j in 0..i {
                assert!((at[i].position() - at[j].position()).norm() > 0.2);
            }
        }
    }
}

#[test]
fn a_robot_without_an_allowed_start_is_reported() {
    let map = field([-5.0, -5.0]);
    let robots = [jittered(0.0, 0.0), jittered(0.0, 0.01)];
    assert_eq!(draw(&robots, 1, &map), Err(1));
    let distant = RandomStart {
        robot_distance: 30.0,
        ..RandomStart::default()
    };
    let robots = [jittered(0.0, 0.0), random(Role::Neutral, distant)];
    assert_eq!(draw(&robots, 1, &map), Err(1));
}

#[test]
fn random_starts_fill_the_free_space_and_keep_their_distances() {
    let map = divided();
    let rule = RandomStart {
        robot_distance: 0.6,
        opponent_distance: 2.0,
        exit_distance: 1.5,
        ..RandomStart::default()
    };
    let robots = [
        random(Role::Pursuer, rule),
        random(Role::Evader, rule),
        random(Role::Pursuer, rule),
        random(Role::Evader, rule),
    ];
    let mut police_left = 0;
    let mut quadrants = [0; 4];
    for seed in 0..400 {
        let starts = draw(&robots, seed, &map).unwrap();
        for (i, (pose, robot)) in starts.iter().zip(&robots).enumerate() {
            assert!(pose.x.abs() >= 0.3 && pose.x.abs() <= 4.9 && pose.y.abs() <= 4.9);
            for (other, rival) in starts.iter().zip(&robots).take(i) {
                let least = if robot.team == rival.team { 0.6 } else { 2.0 };
                assert!((pose.position() - other.position()).norm() > least);
            }
            if robot.team.role == Role::Evader {
                assert!(pose.x > 0.0, "no way to the exit from {pose:?}");
                assert!((pose.position() - Point2::new(4.0, 0.0)).norm() >= 1.5);
            } else {
                police_left += usize::from(pose.x < 0.0);
            }
            quadrants[((pose.theta + PI) / (0.5 * PI)) as usize] += 1;
        }
    }
    assert!((300..500).contains(&police_left), "{police_left} of 800");
    assert!(
        quadrants.iter().all(|n| (300..500).contains(n)),
        "headings: {quadrants:?}"
    );
}

#[test]
fn a_region_without_room_is_named_as_the_reason() {
    let map = WorldMap::from_vectors(&field([-5.0, -5.0])).unwrap();
    let rule = RandomStart {
        region: Some(Region::Rectangle {
            center: [0.0, 0.0],
            half_extents: [1.0, 1.0],
            angle: 0.3,
        }),
        robot_distance: 1.5,
        ..RandomStart::default()
    };
    let robots = [random(Role::Pursuer, rule); 6];
    let refused = place(&robots, 3, &map, &RulesSpec::default()).unwrap_err();
    assert!((2..6).contains(&refused.index), "{refused:?}");
    let text = refused
        .explain(config::Diagnostic::new(
            config::Code::Geometry,
            refused.message("police_6"),
        ))
        .to_string();
    for part in [
        "robot `police_6` has no allowed start in 1000 draws",
        "1000 draws too near to another robot",
        "a larger region, fewer robots or smaller distances",
    ] {
        assert!(text.contains(part), "{part:?} is not in {text}");
    }
}

proptest! {
    #[test]
    fn starts_of_equal_robots_keep_region_and_distance_and_depend_on_the_seed_alone(
        seed in any::<u64>(),
        count in 1_usize..12,
        distance in 0.0_f64..0.8,
        center in [-2.0_f64..2.0, -2.0_f64..2.0],
        angle in -3.0_f64..3.0,
        round in any::<bool>(),
    ) {
        let region = if round {
            Region::Circle { center, radius: 2.5 }
        } else {
            Region::Rectangle { center, half_extents: [2.5, 1.8], angle }
        };
        let rule = RandomStart {
            region: Some(region),
            robot_distance: distance,
            ..RandomStart::default()
        };
        let map = field([-5.0, -5.0]);
        let robots = vec![random(Role::Pursuer, rule); count];
        let starts = draw(&robots, seed, &map);
        prop_assert_eq!(&starts, &draw(&robots, seed, &map));
        let starts = starts.unwrap();
        for (i, start) in starts.iter().enumerate() {
            prop_assert!(region.contains(start.position()));
            for other in &starts[..i] {
                let apart = (start.position() - other.position()).norm();
                prop_assert!(apart > distance.max(0.2), "{apart}");
            }
        }
        let fewer = draw(&robots[..count - 1], seed, &map).unwrap();
        prop_assert_eq!(&starts[..count - 1], &fewer[..]);
    }
}

#[test]
fn random_starts_stay_in_their_region_and_reach_their_goal() {
    let map = divided();
    let left = Region::Circle {
        center: [-4.0, 0.0],
        radius: 0.2,
    };
    for region in [
        Region::Circle {
            center: [0.0, 1.0],
            radius: 2.0,
        },
        Region::Rectangle {
            center: [0.0, -1.0],
            half_extents: [2.0, 0.5],
            angle: 0.7,
        },
    ] {
        let rule = RandomStart {
            region: Some(region),
            ..RandomStart::default()
        };
        let robot = Placement {
            goal: Some(left),
            ..random(Role::Neutral, rule)
        };
        for seed in 0..100 {
            let start = draw(&[robot], seed, &map).unwrap()[0];
            assert!(region.contains(start.position()) && start.x < 0.0);
        }
    }
}
