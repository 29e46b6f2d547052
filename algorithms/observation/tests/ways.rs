//! Ways in observations.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod support;

use core::f64::consts::PI;
use std::collections::BTreeMap;

use geometry::map::{MapSpec, ObstacleSpec, VectorMap};
use geometry::pose::Pose2;
use geometry::region::Region;
use geometry::shape::Shape;
use nalgebra::Point2;
use observation::action::action;
use observation::layout::Layout;
use observation::scene::{OcclusionCache, Scene};
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::view::View;
use pursuit_evasion::potential_evader::{Evader, EvaderParams};
use robot::spec::RobotSpec;
use robot::team::Role;
use sim_backend::spec::{RulesSpec, WorldSpec};
use sim_backend::world::World;

/// A ring of streets, 8 m × 6 m, about a block of 4 m × 2 m; the exit is in the street on the right, an evader in that on
/// the left, and a pursuer at `pursuer`.
fn world(evader: Pose2, pursuer: [f64; 2]) -> World {
    let mut map = VectorMap::empty([0.0, 0.0], [8.0, 6.0], 0.05);
    map.obstacles.push(ObstacleSpec {
        name: String::new(),
        shape: Shape::Polygon {
            vertices: vec![[2.0, 2.0], [6.0, 2.0], [6.0, 4.0], [2.0, 4.0]],
        },
    });
    let pursuer = Pose2::new(pursuer[0], pursuer[1], 0.0);
    World::new(WorldSpec {
        map: MapSpec::Vector(map),
        robots: vec![
            RobotSpec::new("evader", Role::Evader, evader),
            RobotSpec::new("police", Role::Pursuer, pursuer),
        ],
        rules: RulesSpec {
            exits: vec![Region::Circle {
                center: [7.0, 2.5],
                radius: 0.2,
            }],
            ..RulesSpec::default()
        },
        seed: 1,
    })
    .unwrap()
}

/// The observation of the evader, by the names of its entries.
fn observed(world: &World, parts: &str) -> BTreeMap<String, f32> {
    let facts = support::facts(world);
    let exits: Vec<Point2<f64>> = world.exits().iter().map(Region::center).collect();
    let layout = Layout::new(parts.parse().unwrap(), &facts, 0, exits.len()).unwrap();
    let robots = support::robots(world);
    let mut scene = Scene::new(&facts, &[0]);
    scene.update(
        &robots,
        world.map().shapes(),
        &mut OcclusionCache::default(),
    );
    let view = View {
        time_s: 0.0,
        dt: 0.05,
        me: 0,
        robots: &robots,
        beliefs: &[],
        exits: &exits,
        scan: None,
    };
    let mut values = vec![f32::NAN; layout.length()];
    layout.write(&scene, &view, &mut values).unwrap();
    let map = PlannerMap::of_world(world.map(), 0.19, 0).unwrap();
    if let Some(mut ways) = layout.ways() {
        ways.write(&map, &view, &mut values);
        // What it keeps does not change what it writes, and the same map shared with others neither.
        let first = values.clone();
        ways.write(&map, &view, &mut values);
        assert_eq!(values, first);
        ways = layout.ways().unwrap();
        ways.write(&map.shared(), &view, &mut values);
        assert_eq!(values, first);
    }
    assert!(values.iter().all(|value| (-1.0..=1.0).contains(value)));
    let named: BTreeMap<String, f32> = layout.names().iter().cloned().zip(values).collect();
    assert_eq!(named.len(), layout.length());
    named
}

#[test]
fn the_way_goes_around_the_block_and_the_evader_past_an_opponent_around_the_other_side() {
    // It looks along +x; the way below the block is shorter, and the pursuer stands in it.
    let seen = observed(
        &world(Pose2::new(1.0, 2.7, 0.0), [4.0, 1.0]),
        "path+potential",
    );
    assert!(seen["path.bearing_sin"] < -0.5, "{seen:?}");
    assert!(seen["potential.bearing_sin"] > 0.5, "{seen:?}");
    let length = 1.0 / seen["path.proximity"] - 1.0;
    assert!((6.5..8.5).contains(&length), "{length}");
    assert!((seen["path.length"] - length / 10.0).abs() < 1e-3);
    // Far from both ways it has no effect.
    let seen = observed(&world(Pose2::new(1.0, 2.7, 0.0), [0.3, 5.7]), "potential");
    assert!(seen["potential.bearing_sin"] < -0.5, "{seen:?}");
}

#[test]
fn the_action_of_the_potential_field_is_that_of_its_planner() {
    let world = world(Pose2::new(1.0, 2.7, 0.6), [3.0, 1.0]);
    let robots = support::robots(&world);
    let exits: Vec<Point2<f64>> = world.exits().iter().map(Region::center).collect();
    let model = support::facts(&world)[0].model;
    let limits = Limits::new(model.v_max, model.v_reverse_max, model.omega_max).unwrap();
    let mut evader = Evader::new(EvaderParams::default(), limits, 0).unwrap();
    let view = View {
        time_s: 0.0,
        dt: 0.05,
        me: 0,
        robots: &robots,
        beliefs: &[],
        exits: &exits,
        scan: None,
    };
    let map = PlannerMap::of_world(world.map(), 0.19, 0).unwrap();
    let expected = action(evader.command(&map, &view).command, &model);
    let seen = observed(&world, "potential");
    assert_ne!(expected, [0.0, 0.0]);
    assert_eq!([seen["potential.speed"], seen["potential.turn"]], expected);
}

#[test]
fn bearings_turn_with_the_robot() {
    let ahead = observed(&world(Pose2::new(1.0, 2.7, 0.0), [4.0, 1.0]), "path");
    let back = observed(&world(Pose2::new(1.0, 2.7, PI), [4.0, 1.0]), "path");
    assert!((ahead["path.bearing_sin"] + back["path.bearing_sin"]).abs() < 1e-5);
    assert!((ahead["around.0.danger"] - back["around.4.danger"]).abs() < 1e-5);
}

#[test]
fn places_around_know_walls_the_exit_and_opponents() {
    // In the street below the block, the pursuer behind.
    let seen = observed(&world(Pose2::new(4.0, 1.0, 0.0), [2.5, 1.0]), "path");
    // 0 is ahead, 2 left.
    assert_eq!(seen["around.0.free"], 1.0);
    assert!((seen["around.2.free"] - 0.9).abs() < 0.1, "{seen:?}");
    assert!(
        seen["around.0.nearer"] > 0.7 && seen["around.4.nearer"] < -0.7,
        "{seen:?}"
    );
    assert!(
        seen["around.4.danger"] > 0.5 && seen["around.0.danger"] < 0.33,
        "{seen:?}"
    );
    // The pursuer's way is longer by the 1.5 m between them.
    assert!(
        (seen["path_to.police.exit_lead"] - 0.15).abs() < 0.04,
        "{seen:?}"
    );
    assert!(
        (seen["path_to.police.proximity"] - 0.4).abs() < 0.05,
        "{seen:?}"
    );
}

#[test]
fn ways_are_the_last_entries_and_others_stay_what_they_are() {
    let world = world(Pose2::new(1.0, 2.7, 0.4), [4.0, 1.0]);
    let all = observed(&world, "state+path+potential");
    for (parts, added) in [("state+path", 4), ("state+potential", 30), ("state", 34)] {
        let some = observed(&world, parts);
        assert_eq!(all.len() - some.len(), added, "{parts}");
        assert!(some.iter().all(|(name, value)| all[name] == *value));
    }
}
