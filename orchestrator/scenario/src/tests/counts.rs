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
    for (from, to, wants) in [
        (
            "count = 3",
            "count = 0",
            &[
                "`count` is out of range",
                "(robots.cop.count)",
                "from 1 to 64",
            ][..],
        ),
        (
            "count = 3",
            "count = 64",
            &["too many robots", "value: 65", "at most 64 robots"],
        ),
        (
            "random_start = { region = { circle = { center = [-2.0, 0.0], radius = 1.5 } }, robot_distance = 0.4 }",
            "start = { x = -3.0, y = 0.0, theta = 0.0 }",
            &["the 3 robots `cop` have one start", "random_start = {"],
        ),
        (
            "[teams.police]",
            "[teams.police]\ncount = 2",
            &[
                "`teams.police.count` belongs to 0 [[robots]] blocks",
                "one block of the team without its own `count`",
            ],
        ),
        (
            "[defaults.robot]",
            "[defaults.robot]\ncount = 2",
            &["`count` cannot be inherited", "(defaults.robot.count)"],
        ),
        (
            "robot_distance = 0.4",
            "robot_distance = 2.0",
            &[
                "has no allowed start in 1000 draws",
                "draws too near to another robot",
                "a larger region, fewer robots or smaller distances",
                "(robots.cop.random_start)",
            ],
        ),
        (
            "name = \"thief\"",
            "name = \"cop_2\"",
            &["two robots are called `cop_2`"],
        ),
    ] {
        let text = several();
        assert!(text.contains(from), "{from:?}");
        contains(&load(&text.replacen(from, to, 1)).unwrap_err(), wants);
    }
}
