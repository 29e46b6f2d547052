use geometry::region::Region;

use super::*;
use crate::spec::CaptureSpec;

fn message(map: MapSpec, robots: Vec<RobotSpec>, rules: RulesSpec) -> String {
    World::new(WorldSpec {
        map,
        robots,
        rules,
        seed: 0,
    })
    .unwrap_err()
    .to_string()
}

fn robot(name: &str, x: f64, y: f64) -> RobotSpec {
    racer(name, Role::Evader, x, y, 0.0)
}

#[test]
fn a_world_needs_robots() {
    let text = message(room(vec![]), vec![], RulesSpec::default());
    assert_eq!(
        text,
        "robots: the world has no robots: expected at least one"
    );
}

#[test]
fn two_robots_in_one_place_are_both_named() {
    let robots = vec![robot("tom", 1.0, 1.0), robot("jerry", 1.1, 1.0)];
    let text = message(room(vec![]), robots, RulesSpec::default());
    assert!(
        text.contains("robots[0] \"tom\" and robots[1] \"jerry\" overlap"),
        "{text}"
    );
    assert!(
        text.contains("0.1000 m apart: expected at least 0.2000 m"),
        "{text}"
    );
    let robots = vec![robot("tom", 1.0, 1.0), robot("tom", 2.0, 1.0)];
    let text = message(room(vec![]), robots, RulesSpec::default());
    assert!(
        text.contains("robots[1] is called \"tom\" like robots[0]"),
        "{text}"
    );
}

#[test]
fn a_robot_in_a_wall_or_outside_is_named_with_its_place_and_the_room_it_needs() {
    let wall = Shape::Circle {
        center: [0.0, 0.0],
        radius: 1.0,
    };
    let text = message(
        room(vec![wall]),
        vec![robot("tom", 1.05, 0.0)],
        RulesSpec::default(),
    );
    assert_eq!(
        text,
        "robots[0] \"tom\" starts in a wall: at (1.05, 0) the nearest obstacle is 0.0500 m away: \
         expected at least its radius of 0.1 m"
    );
    let text = message(
        room(vec![]),
        vec![robot("tom", 5.5, 0.0)],
        RulesSpec::default(),
    );
    assert!(
        text.contains("starts at (5.5, 0), outside the map: expected x in [-5, 5]"),
        "{text}"
    );
    let text = message(
        room(vec![]),
        vec![robot("tom", 4.95, 0.0)],
        RulesSpec::default(),
    );
    assert!(text.contains("starts in a wall"), "{text}");
}

#[test]
fn bad_values_are_named_with_robot_and_field() {
    let mut bad = robot("tom", 0.0, 0.0);
    bad.limits.omega_max = Some(f64::NAN);
    let text = message(room(vec![]), vec![bad], RulesSpec::default());
    assert!(
        text.starts_with("robots[0] \"tom\": `limits.omega_max` is NaN: expected"),
        "{text}"
    );
    let mut bad = robot("tom", 0.0, 0.0);
    bad.radius = Some(0.0);
    let text = message(room(vec![]), vec![bad], RulesSpec::default());
    assert!(
        text.starts_with("robots[0] \"tom\": `radius` is 0: expected"),
        "{text}"
    );
    let capture = Some(CaptureSpec {
        radius: -1.0,
        ..CaptureSpec::default()
    });
    let rules = RulesSpec {
        capture,
        ..RulesSpec::default()
    };
    let text = message(room(vec![]), vec![robot("tom", 0.0, 0.0)], rules);
    assert!(
        text.starts_with("`rules.capture.radius` is -1: expected"),
        "{text}"
    );
}

#[test]
fn an_exit_or_goal_behind_a_gap_that_is_too_narrow_is_unreachable() {
    let side = |y: f64| Shape::Rectangle {
        center: [0.0, y],
        half_extents: [0.1, 2.4],
        angle: 0.0,
    };
    let map = |gap: f64| {
        let offset = 2.4 + gap / 2.0;
        room(vec![side(-offset), side(offset), side(-5.0), side(5.0)])
    };
    let exit = Region::Circle {
        center: [4.0, 0.0],
        radius: 0.3,
    };
    let rules = RulesSpec {
        exits: vec![exit],
        ..RulesSpec::default()
    };
    let world = |gap: f64| {
        let robots = vec![robot("tom", -2.0, 0.0)];
        World::new(WorldSpec {
            map: map(gap),
            robots,
            rules: rules.clone(),
            seed: 0,
        })
    };
    assert!(world(0.4).is_ok());
    assert!(world(0.201).is_ok());
    let text = world(0.04).unwrap_err().to_string();
    assert!(
        text.starts_with("robots[0] \"tom\" cannot reach any exit"),
        "{text}"
    );
    let mut walker = racer("walker", Role::Neutral, -2.0, 0.0, 0.0);
    walker.goal = Some(exit);
    let text = message(map(0.04), vec![walker], RulesSpec::default());
    assert!(
        text.starts_with("robots[0] \"walker\" cannot reach its goal"),
        "{text}"
    );
}
