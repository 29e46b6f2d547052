//! Observations of robots of a world.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod support;

use core::f64::consts::{FRAC_PI_2, PI};
use std::time::Duration;

use geometry::map::MapSpec;
use geometry::math::hypot;
use geometry::pose::{Pose2, Twist2};
use geometry::region::Region;
use nalgebra::Point2;
use observation::error::{LayoutError, WriteError};
use observation::facts::RobotFacts;
use observation::layout::Layout;
use observation::scene::{OcclusionCache, Scene};
use planner_view::view::{BeliefView, ScanView, View};
use proptest::prelude::*;
use robot::spec::{RobotSpec, ScanSpec};
use robot::team::Role;
use sim_backend::spec::{RulesSpec, WorldSpec};
use sim_backend::world::World;
use testing::{circle, rectangle};

fn four_robots() -> Vec<RobotSpec> {
    let robot = |name: &str, role, x, y, theta| RobotSpec::new(name, role, Pose2::new(x, y, theta));
    vec![
        robot("police_1", Role::Pursuer, 2.0, 3.0, 0.0),
        robot("police_2", Role::Pursuer, 6.0, 1.0, PI),
        robot("police_3", Role::Pursuer, 6.0, 5.0, PI),
        robot("evader", Role::Evader, 6.0, 3.0, FRAC_PI_2),
    ]
}

/// A world of 8 m × 6 m with a pillar at its centre, three Police and an evader.
fn world() -> World {
    let map = testing::map([0.0, 0.0], [8.0, 6.0], 0.05, [circle([4.0, 3.0], 0.5)]);
    let mut robots = four_robots();
    robots[3].scan = Some(ScanSpec {
        beams: 4,
        angle_increment: FRAC_PI_2,
        noise: 0.0,
        ..ScanSpec::default()
    });
    robots[0].goal = Some(Region::Circle {
        center: [2.0, 4.0],
        radius: 0.2,
    });
    World::new(WorldSpec {
        map: MapSpec::Vector(map),
        robots,
        rules: RulesSpec {
            exits: vec![
                Region::Circle {
                    center: [0.5, 0.5],
                    radius: 0.2,
                },
                Region::Circle {
                    center: [7.5, 3.0],
                    radius: 0.2,
                },
            ],
            ..RulesSpec::default()
        },
        seed: 1,
    })
    .unwrap()
}

/// The observation of a robot, by the names of its entries.
struct Observed {
    names: Vec<String>,
    values: Vec<f32>,
}

impl Observed {
    fn from_world(world: &World, me: usize, parts: &str, beliefs: &[BeliefView<'_>]) -> Self {
        let facts = support::facts(world);
        let exits: Vec<Point2<f64>> = world.exits().iter().map(Region::center).collect();
        let layout = Layout::new(parts.parse().unwrap(), &facts, me, exits.len()).unwrap();
        let mut scene = Scene::new(&facts, &[me]);
        let robots = support::robots(world);
        let mut ranges = Vec::new();
        let scan = world.scan(me, &mut ranges).copied();
        let view = View {
            time_s: world.time().as_secs_f64(),
            dt: 0.05,
            me,
            robots: &robots,
            beliefs,
            exits: &exits,
            scan: scan.map(|scan| ScanView {
                angle_min: scan.angle_min,
                angle_increment: scan.angle_increment,
                range_min: scan.range_min,
                range_max: scan.range_max,
                ranges: &ranges,
            }),
        };
        scene.update(
            &robots,
            world.map().shapes(),
            &mut OcclusionCache::default(),
        );
        let mut values = vec![9.0; layout.length()];
        layout.write(&scene, &view, &mut values).unwrap();
        assert!(values.iter().all(|value| (-1.0..=1.0).contains(value)));
        Self {
            names: layout.names().to_vec(),
            values,
        }
    }

    fn get(&self, name: &str) -> f32 {
        let at = self.names.iter().position(|known| known == name);
        self.values[at.unwrap_or_else(|| panic!("{name} in {:?}", self.names))]
    }
}

fn assert_near(found: f32, expected: f64) {
    assert!(
        (f64::from(found) - expected).abs() < 1e-6,
        "{found} {expected}"
    );
}

#[test]
fn the_own_state_is_relative_to_map_and_limits() {
    let mut world = world();
    for _ in 0..2 {
        world.step(
            &[Some(Twist2::new(0.11, 0.0)); 4],
            Duration::from_millis(50),
        );
    }
    let own = Observed::from_world(&world, 0, "state", &[]);
    assert_near(own.get("own.x"), (2.011 - 4.0) / 4.0);
    assert_near(own.get("own.y"), 0.0);
    assert_near(own.get("own.heading_cos"), 1.0);
    assert_near(own.get("own.speed"), 0.5);
    assert_eq!(own.get("own.active"), 1.0);
    // The goal is to the left, 1 m away but for the way driven.
    assert_near(own.get("goal.left"), 1.0 / 10.0);
    assert_near(own.get("goal.bearing_sin"), 1.0 / hypot(1.0, 0.011));
}

#[test]
fn other_robots_are_relative_and_pillars_hide_opponents() {
    let world = world();
    let evader = Observed::from_world(&world, 3, "state", &[]);
    // It looks along +y: police_3 is 2 m ahead, police_1 4 m to the left behind the pillar.
    assert_near(evader.get("police_3.ahead"), 0.2);
    assert_near(evader.get("police_3.bearing_cos"), 1.0);
    assert_near(evader.get("police_3.proximity"), 1.0 / 3.0);
    assert_near(evader.get("police_3.heading_sin"), 1.0);
    assert_near(evader.get("police_1.left"), 0.4);
    assert_eq!(evader.get("police_3.visible"), 1.0);
    assert_eq!(evader.get("police_1.visible"), 0.0);
    // The same pair from the other side, and two of a team.
    let police = Observed::from_world(&world, 2, "state", &[]);
    assert_near(police.get("evader.left"), 0.2);
    assert_eq!(police.get("evader.visible"), 1.0);
    assert_eq!(police.get("police_2.visible"), 0.0);
}

#[test]
fn the_nearest_exits_come_first() {
    let world = world();
    for (me, near, far) in [(3, (1.5, 0.0), (-5.5, -2.5)), (0, (-1.5, -2.5), (5.5, 0.0))] {
        let observed = Observed::from_world(&world, me, "state", &[]);
        for (exit, (x, y)) in [("exit_1", near), ("exit_2", far)] {
            let distance = hypot(x, y);
            assert_near(
                observed.get(&format!("{exit}.proximity")),
                1.0 / (1.0 + distance),
            );
        }
    }
}

#[test]
fn a_scan_is_a_share_of_the_maximum_range() {
    let scan = Observed::from_world(&world(), 3, "scan", &[]);
    // Ahead police_3, to the left the pillar, behind police_2, to the right the edge of the map.
    for (beam, range) in [2.0 - 0.105, 1.5, 2.0 - 0.105, 2.0].into_iter().enumerate() {
        assert_near(scan.get(&format!("scan.{beam}")), range / 3.5);
    }
}

#[test]
fn a_belief_has_its_mean_and_its_certainty_and_none_is_zero() {
    let world = world();
    let belief = BeliefView {
        robot: 3,
        particles: &[],
        mean: Pose2::new(4.0, 3.0, FRAC_PI_2),
        position_std: 1.0,
        seen: true,
    };
    let police = Observed::from_world(&world, 0, "belief", &[belief]);
    assert_near(police.get("belief.evader.ahead"), 0.2);
    assert_near(police.get("belief.evader.heading_sin"), 1.0);
    assert_eq!(police.get("belief.evader.certainty"), 0.5);
    assert_eq!(police.get("belief.evader.seen"), 1.0);
    let nan = BeliefView {
        position_std: f64::NAN,
        ..belief
    };
    for beliefs in [&[][..], &[nan]] {
        let police = Observed::from_world(&world, 0, "belief", beliefs);
        assert_eq!(police.get("belief.evader.known"), 0.0);
        assert_eq!(police.get("belief.evader.certainty"), 0.0);
    }
    // All parts together.
    let all = Observed::from_world(&world, 3, "state+scan+belief", &[]);
    assert_eq!(all.names.len(), 7 + 2 * 5 + 3 * 10 + 4 + 3 * 10);
}

#[test]
fn robots_without_what_a_part_needs_are_refused() {
    let mut facts = support::facts(&world());
    let layout = |facts: &[RobotFacts], parts: &str, me| {
        Layout::new(parts.parse().unwrap(), facts, me, 2).map(|layout| layout.length())
    };
    let refused = layout(&facts, "scan", 0).unwrap_err();
    assert!(
        matches!(refused, LayoutError::NoScan { .. }) && refused.to_string().contains("police_1")
    );
    let refused = layout(&facts, "state", 4).unwrap_err();
    assert_eq!(
        refused,
        LayoutError::Robot {
            robot: 4,
            robots: 4
        }
    );
    facts.pop();
    let refused = layout(&facts, "belief", 0).unwrap_err();
    assert!(matches!(refused, LayoutError::NoOpponents { .. }));
}

#[test]
fn a_slice_of_another_length_and_an_absent_robot_are_refused() {
    let world = world();
    let facts = support::facts(&world);
    let layout = Layout::new("state".parse().unwrap(), &facts, 0, 0).unwrap();
    let scene = Scene::new(&facts, &[0]);
    let view = View {
        time_s: 0.0,
        dt: 0.05,
        me: 0,
        robots: &[],
        beliefs: &[],
        exits: &[],
        scan: None,
    };
    let expected = layout.length();
    let refused = layout.write(&scene, &view, &mut [0.0; 3]);
    assert_eq!(refused, Err(WriteError::Length { expected, given: 3 }));
    let refused = layout.write(&scene, &view, &mut vec![0.0; expected]);
    assert_eq!(refused, Err(WriteError::Robot { robot: 0 }));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever messages claim, all entries are finite and in range.
    #[test]
    fn entries_stay_in_range(
        numbers in prop::collection::vec(prop_oneof![any::<f64>(), -20.0..20.0f64], 24),
        ranges in prop::collection::vec(any::<f32>(), 0..6),
        flags in any::<u32>(),
    ) {
        let world = world();
        let facts = support::facts(&world);
        let mut robots = support::robots(&world);
        for (i, robot) in robots.iter_mut().enumerate().skip(1) {
            let n = &numbers[i * 5..];
            robot.pose = Pose2 { x: n[0], y: n[1], theta: n[2] };
            robot.twist = Twist2::new(n[3], n[4]);
            robot.active = flags >> i & 1 == 1;
            robot.present = flags >> (8 + i) & 1 == 1;
        }
        let beliefs = [BeliefView {
            robot: 3,
            particles: &[],
            mean: Pose2 { x: numbers[0], y: numbers[1], theta: numbers[2] },
            position_std: numbers[3],
            seen: true,
        }];
        let exits = [Point2::new(numbers[4], numbers[5]), Point2::new(1.0, 1.0)];
        let mut scene = Scene::new(&facts, &[0, 3]);
        scene.update(&robots, world.map().shapes(), &mut OcclusionCache::default());
        for (me, parts) in [(0, "state+belief"), (3, "state+scan")] {
            let layout = Layout::new(parts.parse().unwrap(), &facts, me, 2).unwrap();
            let view = View {
                time_s: 0.0,
                dt: 0.05,
                me,
                robots: &robots,
                beliefs: &beliefs,
                exits: &exits,
                scan: Some(ScanView {
                    angle_min: 0.0,
                    angle_increment: 1.0,
                    range_min: 0.1,
                    range_max: numbers[6],
                    ranges: &ranges,
                }),
            };
            let mut out = vec![9.0; layout.length()];
            if layout.write(&scene, &view, &mut out).is_ok() {
                prop_assert!(out.iter().all(|value| (-1.0..=1.0).contains(value)), "{out:?}");
            }
        }
    }
}

/// Whatever hid the robots before, the lines of sight are those of the tick.
#[test]
fn what_hid_robots_before_has_no_effect() {
    let centers = [[2.0, 2.0], [4.0, 3.0], [5.5, 1.5], [3.0, 4.5]];
    let walls = centers.map(|center| rectangle(center, [0.6, 0.3]));
    let map = testing::map([0.0, 0.0], [8.0, 6.0], 0.05, walls);
    let world = World::new(WorldSpec {
        map: MapSpec::Vector(map),
        robots: four_robots(),
        rules: RulesSpec::default(),
        seed: 1,
    });
    let world = world.unwrap();
    let facts = support::facts(&world);
    let (mut known, mut fresh) = (Scene::new(&facts, &[3]), Scene::new(&facts, &[3]));
    let layout = Layout::new("state".parse().unwrap(), &facts, 3, 0).unwrap();
    let mut robots = support::robots(&world);
    let mut hiding = OcclusionCache::default();
    let mut seen = [0, 0];
    for tick in 0..3000 {
        for (k, robot) in robots.iter_mut().enumerate() {
            let phase = 0.004 * f64::from(tick) * (1.0 + k as f64) + k as f64;
            robot.pose.x = 4.0 + 3.5 * geometry::math::sin(phase);
            robot.pose.y = 3.0 + 2.5 * geometry::math::sin(1.7 * phase);
        }
        known.update(&robots, world.map().shapes(), &mut hiding);
        fresh.update(
            &robots,
            world.map().shapes(),
            &mut OcclusionCache::default(),
        );
        let observed = [&known, &fresh].map(|scene| {
            let view = View {
                time_s: 0.0,
                dt: 0.05,
                me: 3,
                robots: &robots,
                beliefs: &[],
                exits: &[],
                scan: None,
            };
            let mut out = vec![0.0; layout.length()];
            layout.write(scene, &view, &mut out).unwrap();
            out
        });
        assert_eq!(observed[0], observed[1], "tick {tick}");
        let visible = layout.names().iter().zip(&observed[0]);
        for (_, &flag) in visible.filter(|(name, _)| name.ends_with(".visible")) {
            seen[usize::from(flag == 1.0)] += 1;
        }
    }
    assert!(seen.iter().all(|&count| count > 500), "{seen:?}");
}
