use expect_test::expect;
use geometry::region::Region;
use testing::{circle, rectangle};

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

fn messages(cases: impl IntoIterator<Item = (MapSpec, Vec<RobotSpec>)>) -> String {
    let cases = cases.into_iter();
    let found = cases.map(|(map, robots)| message(map, robots, RulesSpec::default()));
    found.collect::<Vec<_>>().join("\n")
}

#[test]
fn missing_and_overlapping_robots_are_refused() {
    let cases = [
        vec![],
        vec![robot("tom", 1.0, 1.0), robot("jerry", 1.1, 1.0)],
        vec![robot("tom", 1.0, 1.0), robot("tom", 2.0, 1.0)],
    ];
    expect![[r#"
        robots: the world has no robots: expected at least one
        robots[0] "tom" and robots[1] "jerry" overlap: their centres are 0.1000 m apart: expected at least 0.2000 m
        robots[1] is called "tom" like robots[0]: expected unique names"#]].assert_eq(&messages(cases.map(|robots| (room(vec![]), robots))));
}

#[test]
fn a_robot_in_a_wall_or_outside_is_named_with_its_place_and_the_room_it_needs() {
    let wall = circle([0.0, 0.0], 1.0);
    let cases = [
        (room(vec![wall]), vec![robot("tom", 1.05, 0.0)]),
        (room(vec![]), vec![robot("tom", 5.5, 0.0)]),
        (room(vec![]), vec![robot("tom", 4.95, 0.0)]),
    ];
    expect![[r#"
        robots[0] "tom" is in a wall: at (1.05, 0) the nearest obstacle is 0.0500 m away: expected at least its radius of 0.1 m
        robots[0] "tom" is outside the map: at (5.5, 0): expected x in [-5, 5] and y in [-5, 5] [m]
        robots[0] "tom" is in a wall: at (4.95, 0) the nearest obstacle is 0.0500 m away: expected at least its radius of 0.1 m"#]].assert_eq(&messages(cases));
}

#[test]
fn bad_values_are_named_with_robot_and_field() {
    let mut turning = robot("tom", 0.0, 0.0);
    turning.limits.omega_max = Some(f64::NAN);
    let mut flat = robot("tom", 0.0, 0.0);
    flat.radius = Some(0.0);
    let robots = messages([turning, flat].map(|bad| (room(vec![]), vec![bad])));
    let capture = Some(CaptureSpec {
        radius: -1.0,
        ..CaptureSpec::default()
    });
    let rules = RulesSpec {
        capture,
        ..RulesSpec::default()
    };
    let captured = message(room(vec![]), vec![robot("tom", 0.0, 0.0)], rules);
    expect![[r#"
        robots[0] "tom": `limits.omega_max` is NaN: expected a number between 0 and 100000 (rad/s)
        robots[0] "tom": `radius` is 0: expected a number above 0 and at most 100000 (m)
        `rules.capture.radius` is -1: expected a number above 0 and at most 100000 (m)"#]]
    .assert_eq(&[robots, captured].join("\n"));
}

#[test]
fn an_exit_or_goal_behind_a_gap_that_is_too_narrow_is_unreachable() {
    let side = |y: f64| rectangle([0.0, y], [0.1, 2.4]);
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
    let no_exit = world(0.04).unwrap_err().to_string();
    let mut walker = racer("walker", Role::Neutral, -2.0, 0.0, 0.0);
    walker.goal = Some(exit);
    let no_goal = message(map(0.04), vec![walker], RulesSpec::default());
    expect![[r#"
        robots[0] "tom" cannot reach any exit: no path from (-2, 0) is wide enough for its radius of 0.1 m
        robots[0] "walker" cannot reach its goal: no path from (-2, 0) is wide enough for its radius of 0.1 m"#]].assert_eq(&[no_exit, no_goal].join("\n"));
}
