//! Several robots from one block.

use super::*;

/// The small scenario with three Police robots from one block.
fn several() -> String {
    changed(
        "name = \"cop\"\nteam = \"police\"\nstart = { x = -3.0, y = 0.0, theta = 0.0 }",
        "name = \"cop\"\nteam = \"police\"\ncount = 3\n\
         random_start = { region = { circle = { center = [-2.0, 0.0], radius = 1.5 } }, robot_distance = 0.4 }",
    )
    .replace("robots = [\"cop\"]", "team = \"police\"")
}

fn names(scenario: &ResolvedScenario) -> Vec<&str> {
    let robots = scenario.world.robots.iter();
    robots.map(|robot| robot.name.as_str()).collect()
}

#[test]
fn a_block_with_a_count_is_that_many_numbered_robots_at_random_starts() {
    let s = load(&several()).unwrap();
    assert_eq!(names(&s), ["cop_1", "cop_2", "cop_3", "thief"]);
    let processes: Vec<&str> = s.processes.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(
        processes,
        [
            "perception",
            "pursuer_cop_1",
            "pursuer_cop_2",
            "pursuer_cop_3",
            "evader_potential"
        ]
    );
    for (i, robot) in s.world.robots.iter().take(3).enumerate() {
        let at = robot.start.position();
        assert!((at - nalgebra::Point2::new(-2.0, 0.0)).norm() <= 1.5);
        for other in &s.world.robots[..i] {
            assert!((at - other.start.position()).norm() > 0.4);
        }
    }
    assert_eq!(load(&several()).unwrap(), s, "same seed, same starts");
    assert_eq!(load(&s.to_toml()).unwrap(), s, "the log has every robot");
    let one = several().replace("count = 3", "count = 1");
    assert_eq!(names(&load(&one).unwrap()), ["cop_1", "thief"]);
}

#[test]
fn the_count_of_a_team_is_that_of_its_block_and_can_be_overridden() {
    let text = several()
        .replace("count = 3\n", "")
        .replace("[teams.police]", "[teams.police]\ncount = 2");
    assert_eq!(names(&load(&text).unwrap()), ["cop_1", "cop_2", "thief"]);
    let s = load_with(&text, &["teams.police.count=4"]).unwrap();
    assert_eq!(names(&s), ["cop_1", "cop_2", "cop_3", "cop_4", "thief"]);
}

#[test]
fn impossible_counts_are_explained() {
    let changes = [
        ("count = 3", "count = 0"),
        ("count = 3", "count = 64"),
        (
            "random_start = { region = { circle = { center = [-2.0, 0.0], radius = 1.5 } }, robot_distance = 0.4 }",
            "start = { x = -3.0, y = 0.0, theta = 0.0 }",
        ),
        ("[teams.police]", "[teams.police]\ncount = 2"),
        ("[defaults.robot]", "[defaults.robot]\ncount = 2"),
        ("robot_distance = 0.4", "robot_distance = 2.0"),
        ("name = \"thief\"", "name = \"cop_2\""),
    ];
    let texts = changes.map(|(from, to)| {
        let text = several();
        assert!(text.contains(from), "{from:?}");
        text.replacen(from, to, 1)
    });
    texts_refused(
        texts,
        &expect![[r#"
        error: `count` is out of range
          --> small.toml:20:9 (robots.cop.count)
           |
        20 | count = 0
           |         ^
           = value: 0
           = expected: a number from 1 to 64
        error: too many robots
          --> small.toml:22:1 (robots.thief)
           |
        22 | [[robots]]
           | ^^^^^^^^^^
           = value: 65
           = expected: at most 64 robots
        error: the 3 robots `cop` have one start
          --> small.toml:20:9 (robots.cop.count)
           |
        20 | count = 3
           |         ^
           = value: 3
           = expected: random_start = { region = …, robot_distance = 0.5 } (m)
        error: `teams.police.count` belongs to 0 [[robots]] blocks
          --> small.toml:16:9 (teams.police.count)
           |
        16 | count = 2
           |         ^
           = value: 2
           = expected: one block of the team without its own `count`
        error: `count` cannot be inherited: every robot has its own
          --> small.toml:14:1 (defaults.robot.count)
           |
        14 | count = 2
           | ^^^^^
           = value: 2
           = expected: `count` in each [[robots]] block

        error: the 2 robots `thief` have one start
          --> small.toml:14:9 (robots.thief.count)
           |
        14 | count = 2
           |         ^
           = value: 2
           = expected: random_start = { region = …, robot_distance = 0.5 } (m)
        error: robot `cop_3` has no allowed start in 1000 draws
          --> small.toml:21:16 (robots.cop.random_start)
           |
        21 | random_start = { region = { circle = { center = [-2.0, 0.0], radius = 1.5 } }, robot_distance = 2.0 }
           |                ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
           = value: 217 draws outside the region, 783 draws too near to another robot
           = expected: a larger region, fewer robots or smaller distances
        error: two robots are called `cop_2` (the other is at small.toml:17)
          --> small.toml:23:8 (robots.cop_2.name)
           |
        23 | name = "cop_2"
           |        ^^^^^^^
           = value: "cop_2"
           = expected: a unique name for every robot"#]],
    );
}
