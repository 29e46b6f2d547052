//! Every error contains file, line, field, value and expected value.

use super::*;

#[test]
fn a_syntax_error_contains_its_line() {
    refused(
        "seed = 5",
        "seed = ",
        &["error: not valid TOML", "--> small.toml:3:", "3 | seed ="],
    );
}

#[test]
fn unknown_keys_are_named_and_the_nearest_is_suggested() {
    refused(
        "seed = 5",
        "sead = 5",
        &[
            "unknown key `sead`",
            "small.toml:3:1 (run.sead)",
            "value: 5",
            "did you mean `seed`?",
        ],
    );
    refused(
        "[rules]",
        "[rule]",
        &["unknown key `rule`", "did you mean `rules`?"],
    );
    refused(
        "limits = { v_max = 0.2 }",
        "limits = { vmax = 0.2 }",
        &[
            "unknown key `vmax`",
            "small.toml:14:12",
            "did you mean `v_max`?",
        ],
    );
    refused(
        "[teams.police]",
        "[teams.polize]",
        &["no robot is in team `polize`", "did you mean `police`?"],
    );
    refused(
        "action = \"appear\"",
        "action = \"appears\"",
        &[
            "`appears` is not one of the choices",
            "(events[1].action)",
            "did you mean `appear`?",
        ],
    );
}

#[test]
fn several_mistakes_are_reported_at_once_in_the_order_of_the_file() {
    let text = changed("seed = 5", "seed = \"five\"\ndt = 7.0")
        .replace("\"cop\"\nteam", "\"cop\"\ncolour = 3\nteam")
        .replace("particles = 200", "particels = 200, gain = \"x\"");
    let e = load(&text).unwrap_err();
    contains(
        &e,
        &[
            "wrong type: text",
            "(run.seed)",
            "expected: a whole number, 0 or more",
            "unknown key `colour`",
            "(robots.cop.colour)",
            "(processes.perception.params.particels)",
            "did you mean `particles`?",
            "(processes.perception.params.gain)",
        ],
    );
    let at = |s: &str| e.find(s).unwrap();
    assert!(at("run.seed") < at("colour") && at("colour") < at("particels"));
}

#[test]
fn numbers_out_of_range_are_refused_with_their_limits() {
    refused(
        "seed = 5",
        "dt = 7.0",
        &[
            "`run.dt` is out of range",
            "small.toml:3:6 (run.dt)",
            "value: 7",
            "between 0.0001 and 1 (s)",
        ],
    );
    refused(
        "seed = 5",
        "dt = nan",
        &["value not allowed", "(run.dt)", "a finite number"],
    );
    refused(
        "seed = 5",
        "seed = -5",
        &["(run.seed)", "value: -5", "a whole number, 0 or more"],
    );
    refused(
        "time_limit = 30.0",
        "time_limit = -1",
        &[
            "`rules.time_limit` is out of range",
            "small.toml:5:14 (rules.time_limit)",
            "value: -1",
        ],
    );
    refused(
        "radius = 0.3 } }]",
        "radius = -0.3 } }]",
        &[
            "(rules.exits[0].circle.radius)",
            "small.toml:7:",
            "value: -0.3",
            "above 0",
        ],
    );
    refused(
        "v_max = 0.2",
        "v_max = -0.2",
        &[
            "`limits.v_max` is out of range",
            "small.toml:14:20 (robots.cop.limits.v_max)",
            "value: -0.2",
        ],
    );
    refused(
        "theta = 0.2 }",
        "theta = 9.0 }",
        &["(robots.thief.start_jitter.theta)", "between 0 and π (rad)"],
    );
    refused(
        "team = \"evader\"\nstart",
        "team = \"evader\"\nscan = { beams = 5000 }\nstart",
        &[
            "`scan.beams` is out of range",
            "value: 5000",
            "between 1 and 4096",
        ],
    );
    refused(
        "particles = 200",
        "gain = -1",
        &[
            "`gain` is out of range",
            "(processes.perception.params.gain)",
            "value: -1",
            "a number ≥ 0",
        ],
    );
}

#[test]
fn robots_have_unique_names_and_required_keys() {
    let without = &GOOD[..GOOD.find("[[robots]]").unwrap()];
    contains(
        &load(without).unwrap_err(),
        &["the scenario has no robots", "at least one [[robots]]"],
    );
    refused(
        "name = \"thief\"",
        "name = \"cop\"",
        &[
            "two robots are called `cop` (the other is at small.toml:17)",
            "small.toml:22:8",
        ],
    );
    refused(
        "team = \"police\"",
        "",
        &["missing key `team`", "small.toml:17:1 (robots.cop.team)"],
    );
    refused(
        "name = \"cop\"",
        "",
        &["missing key `name`", "robots[0].name"],
    );
    refused(
        "name = \"cop\"",
        "name = \"a cop\"",
        &[
            "name not allowed",
            "value: \"a cop\"",
            "1 to 48 of the characters",
        ],
    );
    refused(
        "[defaults.robot]",
        "[defaults.robot]\nstart = { x = 1, y = 1, theta = 0 }",
        &["`start` cannot be inherited"],
    );
    refused(
        "[defaults.robot]",
        "[defaults.robot]\npreset = \"turtlebot3\"",
        &[
            "`turtlebot3` is not one of the choices",
            "did you mean `turtlebot3_burger`?",
        ],
    );
    let block = |i: usize| {
        format!(
            "[[robots]]\nname = \"r{i}\"\nteam = \"neutral\"\nstart = {{ x = 0, y = 0, theta = 0 }}\n"
        )
    };
    let many: String = (0..65).map(block).collect();
    refused(
        "[[processes]]",
        &format!("{many}[[processes]]"),
        &["too many robots", "value: 67", "at most 64 robots"],
    );
    contains(
        &load(&changed("[[robots]]", "[robots]").replace("[[robots]]", "[x]")).unwrap_err(),
        &["robots", "wrong type: a table"],
    );
}

#[test]
fn robots_start_in_free_space_and_apart() {
    refused(
        "x = -3.0, y = 0.0",
        "x = 0.0, y = 0.5",
        &[
            "robot `cop` starts in a wall",
            "small.toml:20:9 (robots.cop.start)",
            "value: x = 0, y = 0.5 (m)",
        ],
    );
    refused(
        "x = -3.0, y = 0.0",
        "x = -0.25, y = 0.5",
        &[
            "robot `cop` starts in a wall: 0.050 m from its centre",
            "at least 0.105 m from every wall",
        ],
    );
    refused(
        "x = -3.0, y = 0.0",
        "x = 30.0, y = 0.0",
        &["robot `cop` starts in a wall or outside the map"],
    );
    refused(
        "x = -3.0, y = 0.0",
        "x = 2.1, y = 0.0",
        &[
            "robots `cop` and `thief` start in one place: 0.100 m apart",
            "(robots.thief.start)",
            "more than 0.210 m apart",
        ],
    );
    let tight = changed(
        "bounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }",
        "bounds = { min = [-4.0, -0.1051], max = [4.0, 0.1051] }",
    )
    .replace("half_extents = [0.2, 1.0]", "half_extents = [0.2, 0.01]")
    .replace("center = [0.0, 0.5]", "center = [0.0, 0.1]");
    contains(
        &load(&tight).unwrap_err(),
        &[
            "robot `thief` has no allowed start in 1000 draws",
            "(robots.thief.start_jitter)",
        ],
    );
    let far = changed(
        "name = \"thief\"",
        "name = \"thief\"\nrandom_start = { robot_distance = 20.0 }",
    );
    contains(
        &load(&far).unwrap_err(),
        &[
            "robot `thief` has no allowed start in 1000 draws",
            "(robots.thief.random_start)",
            "smaller distances",
        ],
    );
    let negative = far.replace("20.0", "-1.0");
    contains(
        &load(&negative).unwrap_err(),
        &["(robots.thief.random_start.robot_distance)", "value: -1"],
    );
}

#[test]
fn exits_and_goals_must_be_reachable() {
    let no_events = GOOD[..GOOD.find("[[events]]").unwrap()].to_owned();
    let closed = no_events.replace("half_extents = [0.2, 1.0]", "half_extents = [0.2, 3.0]");
    assert!(load(&closed).is_ok(), "the thief stands on the exit's side");
    let shut = closed.replace("center = [3.0, 0.0]", "center = [-3.0, 1.0]");
    contains(
        &load(&shut).unwrap_err(),
        &[
            "no evader can reach this exit",
            "small.toml:7:",
            "(rules.exits[0])",
            "x = -3, y = 1",
            "radius 0.105 m",
        ],
    );
    let goal = closed.replace(
        "name = \"cop\"",
        "name = \"cop\"\ngoal = { circle = { center = [3.0, 0.0], radius = 0.2 } }",
    );
    contains(
        &load(&goal).unwrap_err(),
        &["robot `cop` cannot reach its goal", "(robots.cop.goal)"],
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
    contains(
        &load(&evader).unwrap_err(),
        &["\"cop\" cannot reach any exit", "(robots.cop.start)"],
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
    contains(
        &error,
        &[
            "`run.hang_timeout_s` is out of range",
            "`run.ready_timeout_s` is out of range",
            "`start_jitter.x` is out of range",
            "`start_jitter.theta` is out of range",
            "`limits.v_max` is out of range",
            "`limits.omega_max` is out of range",
        ],
    );
}
