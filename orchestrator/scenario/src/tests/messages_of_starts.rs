//! Errors of the places of robots, and of values that are checked together.

use super::*;

#[test]
fn robots_start_in_free_space_and_apart() {
    refused(
        &[
            ("x = -3.0, y = 0.0", "x = 0.0, y = 0.5"),
            ("x = -3.0, y = 0.0", "x = -0.25, y = 0.5"),
            ("x = -3.0, y = 0.0", "x = 30.0, y = 0.0"),
            ("x = -3.0, y = 0.0", "x = 2.1, y = 0.0"),
        ],
        &expect![[r#"
            error: robot `cop` starts in a wall or outside the map
              --> small.toml:20:9 (robots.cop.start)
               |
            20 | start = { x = 0.0, y = 0.5, theta = 0.0 }
               |         ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = value: x = 0, y = 0.5 (m)
               = expected: a place at least 0.105 m from every wall
            error: robot `cop` starts in a wall: 0.050 m from its centre to the wall, 0.105 m to its edge
              --> small.toml:20:9 (robots.cop.start)
               |
            20 | start = { x = -0.25, y = 0.5, theta = 0.0 }
               |         ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = value: x = -0.25, y = 0.5 (m)
               = expected: a place at least 0.105 m from every wall
            error: robot `cop` starts in a wall or outside the map
              --> small.toml:20:9 (robots.cop.start)
               |
            20 | start = { x = 30.0, y = 0.0, theta = 0.0 }
               |         ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = value: x = 30, y = 0 (m)
               = expected: a place at least 0.105 m from every wall
            error: robots `cop` and `thief` start in one place: 0.100 m apart
              --> small.toml:24:9 (robots.thief.start)
               |
            24 | start = { x = 2.0, y = 0.0, theta = 0.0 }
               |         ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = value: x = 2, y = 0 (m)
               = expected: centres more than 0.210 m apart"#]],
    );
    let tight = changed(
        "bounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }",
        "bounds = { min = [-4.0, -0.1051], max = [4.0, 0.1051] }",
    )
    .replace("half_extents = [0.2, 1.0]", "half_extents = [0.2, 0.01]")
    .replace("center = [0.0, 0.5]", "center = [0.0, 0.1]");
    let far = changed(
        "name = \"thief\"",
        "name = \"thief\"\nrandom_start = { robot_distance = 20.0 }",
    );
    let negative = far.replace("20.0", "-1.0");
    texts_refused(
        [tight, far, negative],
        &expect![[r#"
        error: robot `thief` has no allowed start in 1000 draws
          --> small.toml:25:16 (robots.thief.start_jitter)
           |
        25 | start_jitter = { x = 0.1, y = 0.1, theta = 0.2 }
           |                ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
           = value: 1000 draws in a wall
           = expected: room around the start, or less jitter
        error: robot `thief` has no allowed start in 1000 draws
          --> small.toml:23:16 (robots.thief.random_start)
           |
        23 | random_start = { robot_distance = 20.0 }
           |                ^^^^^^^^^^^^^^^^^^^^^^^^^
           = value: 106 draws in a wall, 894 draws too near to another robot
           = expected: a larger region, fewer robots or smaller distances
        error: `random_start.robot_distance` is out of range
          --> small.toml:23:35 (robots.thief.random_start.robot_distance)
           |
        23 | random_start = { robot_distance = -1.0 }
           |                                   ^^^^
           = value: -1
           = expected: a number between 0 and 1000 (m)"#]],
    );
}

#[test]
fn exits_and_goals_must_be_reachable() {
    let no_events = GOOD[..GOOD.find("[[events]]").unwrap()].to_owned();
    let closed = no_events.replace("half_extents = [0.2, 1.0]", "half_extents = [0.2, 3.0]");
    assert!(load(&closed).is_ok(), "the thief stands on the exit's side");
    let shut = closed.replace("center = [3.0, 0.0]", "center = [-3.0, 1.0]");
    let goal = closed.replace(
        "name = \"cop\"",
        "name = \"cop\"\ngoal = { circle = { center = [3.0, 0.0], radius = 0.2 } }",
    );
    let evader = no_events
        .replace("half_extents = [0.2, 1.0]", "half_extents = [0.2, 3.0]")
        .replace(
            "name = \"cop\"\nteam = \"police\"",
            "name = \"cop\"\nteam = \"evader\"",
        )
        .replace(
            "kind = \"evader_potential\"\nteam = \"evader\"",
            "kind = \"evader_potential\"\nrobots = [\"thief\"]",
        );
    texts_refused(
        [shut, goal, evader],
        &expect![[r#"
        error: no evader can reach this exit
         --> small.toml:7:10 (rules.exits[0])
          |
        7 | exits = [{ circle = { center = [-3.0, 1.0], radius = 0.3 } }]
          |          ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
          = value: exit at x = -3, y = 1 (m)
          = expected: a way for a robot of radius 0.105 m from the start of an evader
        error: robot `cop` cannot reach its goal
          --> small.toml:19:8 (robots.cop.goal)
           |
        19 | goal = { circle = { center = [3.0, 0.0], radius = 0.2 } }
           |        ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
           = value: goal at x = 3, y = 0 (m)
           = expected: a way for a robot of radius 0.105 m from its start
        error: robots[0] "cop" cannot reach any exit: no path from (-3, 0) is wide enough for its radius of 0.105 m
          --> small.toml:20:9 (robots.cop.start)
           |
        20 | start = { x = -3.0, y = 0.0, theta = 0.0 }
           |         ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^"#]],
    );
}

#[test]
fn every_value_out_of_range_is_named_with_its_line() {
    let text = GOOD.replacen(
        "[run]",
        "[run]\nhang_timeout_s = 0.0\nready_timeout_s = 0.0",
        1,
    );
    assert_ne!(text, GOOD);
    let overrides = [
        "defaults.robot.start_jitter={ x = -1.0, theta = 9.0 }",
        "defaults.robot.limits={ v_max = -1.0, omega_max = -1.0 }",
    ];
    let error = load_with(&text, &overrides).unwrap_err();
    expect![[r#"
        error: `run.hang_timeout_s` is out of range
         --> small.toml:3:18 (run.hang_timeout_s)
          |
        3 | hang_timeout_s = 0.0
          |                  ^^^
          = value: 0
          = expected: a number between 0.1 and 3600 (s)

        error: `run.ready_timeout_s` is out of range
         --> small.toml:4:19 (run.ready_timeout_s)
          |
        4 | ready_timeout_s = 0.0
          |                   ^^^
          = value: 0
          = expected: a number between 0.1 and 3600 (s)

        error: `ready_timeout_s` is out of range
          --> small.toml:28:1 (processes.pursuer.ready_timeout_s)
           |
        28 | [[processes]]
           | ^^^^^^^^^^^^^
           = value: 0
           = expected: a number between 0.1 and 3600 (s)

        error: `ready_timeout_s` is out of range
          --> small.toml:31:1 (processes.evader_potential.ready_timeout_s)
           |
        31 | [[processes]]
           | ^^^^^^^^^^^^^
           = value: 0
           = expected: a number between 0.1 and 3600 (s)

        error: `ready_timeout_s` is out of range
          --> small.toml:34:1 (processes.perception.ready_timeout_s)
           |
        34 | [[processes]]
           | ^^^^^^^^^^^^^
           = value: 0
           = expected: a number between 0.1 and 3600 (s)

        error: `limits.v_max` is out of range
         --> --set (robots.cop.limits.v_max)
          |
        1 | defaults.robot.limits={ v_max = -1.0, omega_max = -1.0 }
          |                                 ^^^^
          = value: -1
          = expected: a number above 0 and at most 100000 (m/s)

        error: `limits.v_max` is out of range
         --> --set (robots.thief.limits.v_max)
          |
        1 | defaults.robot.limits={ v_max = -1.0, omega_max = -1.0 }
          |                                 ^^^^
          = value: -1
          = expected: a number above 0 and at most 100000 (m/s)

        error: `start_jitter.x` is out of range
         --> --set (robots.cop.start_jitter.x)
          |
        1 | defaults.robot.start_jitter={ x = -1.0, theta = 9.0 }
          |                                   ^^^^
          = value: -1
          = expected: a number between 0 and 100 (m)

        error: `start_jitter.theta` is out of range
         --> --set (robots.cop.start_jitter.theta)
          |
        1 | defaults.robot.start_jitter={ x = -1.0, theta = 9.0 }
          |                                                 ^^^
          = value: 9
          = expected: a number between 0 and π (rad)

        error: `limits.omega_max` is out of range
         --> --set (robots.thief.limits.omega_max)
          |
        1 | defaults.robot.limits={ v_max = -1.0, omega_max = -1.0 }
          |                                                   ^^^^
          = value: -1
          = expected: a number between 0 and 100000 (rad/s)"#]]
    .assert_eq(&error);
}
