//! Every error names file, line, field, value and expected value.

use super::*;

#[test]
fn unknown_keys_are_named_and_the_nearest_is_suggested() {
    refused(
        &[
            ("title = \"A small", "titel = \"A small"),
            ("[grid]", "[gird]"),
            ("timeout_s", "timeout"),
            ("scale =", "scael ="),
            ("first = 1", "frist = 1"),
            (
                "x = \"relative_speed\"",
                "x = \"relative_speed\"\ncompares = \"a.csv\"",
            ),
            ("name = \"braitenberg\"", "name = \"braitenberg\"\nsett = 1"),
        ],
        &expect![[r#"
            error: unknown key `titel`
             --> small.toml:3:1 (titel)
              |
            3 | titel = "A small experiment"
              | ^^^^^
              = value: "A small experiment"
              = expected: one of `name`, `kind`, `title`, `description`, `scenario`, `task`, `seeds`, `cases`, `parameters`, `grid`, `run`, `figures`
              = help: did you mean `title`?
            error: parameter `relative_speed` is not in the grid
              --> small.toml:17:1 (parameters.relative_speed)
               |
            17 | [parameters.relative_speed]
               | ^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = expected: a [grid] with a list of values for every parameter

            error: unknown key `gird`
              --> small.toml:22:2 (gird)
               |
            22 | [gird]
               |  ^^^^
               = value: { relative_speed = [0.8, 1.5, 2] }
               = expected: one of `name`, `kind`, `title`, `description`, `scenario`, `task`, `seeds`, `cases`, `parameters`, `grid`, `run`, `figures`
               = help: did you mean `grid`?
            error: unknown key `timeout`
              --> small.toml:26:1 (run.timeout)
               |
            26 | timeout = 100.0
               | ^^^^^^^
               = value: 100.0
               = expected: `timeout_s`
               = help: did you mean `timeout_s`?
            error: unknown key `scael`
              --> small.toml:20:1 (parameters.relative_speed.scael)
               |
            20 | scael = "teams.police.limits.v_max"
               | ^^^^^
               = value: "teams.police.limits.v_max"
               = expected: one of `title`, `set`, `scale`, `levels`
               = help: did you mean `scale`?

            error: unknown parameter `relative_speed`
              --> small.toml:23:18 (grid.relative_speed)
               |
            23 | relative_speed = [0.8, 1.5, 2]
               |                  ^^^^^^^^^^^^^
               = value: [0.8, 1.5, 2]
               = expected: a name from [parameters]: nothing

            error: `relative_speed` is not a parameter of this experiment
              --> small.toml:30:5 (figures.chance.x)
               |
            30 | x = "relative_speed"
               |     ^^^^^^^^^^^^^^^^
               = value: "relative_speed"
               = expected: nothing
            error: unknown key `frist`
             --> small.toml:5:11 (seeds.frist)
              |
            5 | seeds = { frist = 1, count = 3 }
              |           ^^^^^
              = value: 1
              = expected: one of `first`, `count`
              = help: did you mean `first`?
            error: unknown key `compares`
              --> small.toml:31:1 (figures.chance.compares)
               |
            31 | compares = "a.csv"
               | ^^^^^^^^
               = value: "a.csv"
               = expected: one of `name`, `title`, `x`, `metric`, `compare`
               = help: did you mean `compare`?
            error: unknown key `sett`
              --> small.toml:13:1 (cases.braitenberg.sett)
               |
            13 | sett = 1
               | ^^^^
               = value: 1
               = expected: one of `name`, `title`, `scenario`, `set`
               = help: did you mean `set`?"#]],
    );
}

#[test]
fn missing_keys_are_named() {
    refused(
        &[
            ("scenario = \"builtin:chase_exact\"\n", ""),
            ("seeds = { first = 1, count = 3 }", ""),
            ("name = \"braitenberg\"", ""),
            ("x = \"relative_speed\"", ""),
            (
                "set = \"teams.evader.limits.v_max\"\nscale = \"teams.police.limits.v_max\"",
                "",
            ),
        ],
        &expect![[r#"
            error: missing key `scenario`
             --> small.toml:1:1 (scenario)
              |
            1 | 
              | ^
              = expected: the path of a scenario beside the experiment, or a built-in one such as "builtin:chase"
            error: missing key `seeds`
             --> small.toml:1:1 (seeds)
              |
            1 | 
              | ^
              = expected: { first = 1, count = 200 }
            error: missing key `name`
              --> small.toml:11:1 (cases[1].name)
               |
            11 | [[cases]]
               | ^^^^^^^^^
            error: missing key `x`
              --> small.toml:28:1 (figures.chance.x)
               |
            28 | [[figures]]
               | ^^^^^^^^^^^
            error: parameter `relative_speed` changes nothing
              --> small.toml:17:1 (parameters.relative_speed)
               |
            17 | [parameters.relative_speed]
               | ^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = expected: `set` (the key that takes the value), or `levels` (named tables of overrides)

            error: unknown parameter `relative_speed`
              --> small.toml:22:18 (grid.relative_speed)
               |
            22 | relative_speed = [0.8, 1.5, 2]
               |                  ^^^^^^^^^^^^^
               = value: [0.8, 1.5, 2]
               = expected: a name from [parameters]: nothing

            error: `relative_speed` is not a parameter of this experiment
              --> small.toml:29:5 (figures.chance.x)
               |
            29 | x = "relative_speed"
               |     ^^^^^^^^^^^^^^^^
               = value: "relative_speed"
               = expected: nothing"#]],
    );
}

#[test]
fn missing_scenarios_are_refused() {
    refused(
        &[
            ("builtin:chase_exact", "builtin:chase_exakt"),
            ("builtin:chase_exact", "nowhere.toml"),
            ("builtin:chase_exact", "chase"),
            ("builtin:chase_exact", "../x.toml"),
        ],
        &expect![[r#"
            error: there is no built-in scenario `chase_exakt`
             --> small.toml:4:12 (scenario)
              |
            4 | scenario = "builtin:chase_exakt"
              |            ^^^^^^^^^^^^^^^^^^^^^
              = value: "builtin:chase_exakt"
              = expected: one of `chase`, `chase_exact`, `chase_paper`, `chase_layouts`, `chase_braitenberg`, `chase_rrt_star`, `chase_popup`, `chase_referee`, `chase_reach_avoid`, `popup`, `popup_city`, `single_lane` … (23 in all)
              = help: did you mean `builtin:chase_exact`?
            error: nowhere.toml: cannot be read: No such file or directory (os error 2)
             --> small.toml:4:12 (scenario)
              |
            4 | scenario = "nowhere.toml"
              |            ^^^^^^^^^^^^^^
              = value: "nowhere.toml"
              = expected: a file: the path of a scenario beside the experiment, or a built-in one such as "builtin:chase"
            error: chase: cannot be read: No such file or directory (os error 2)
             --> small.toml:4:12 (scenario)
              |
            4 | scenario = "chase"
              |            ^^^^^^^
              = value: "chase"
              = expected: a file: the path of a scenario beside the experiment, or a built-in one such as "builtin:chase"
              = help: did you mean `builtin:chase`?
            error: path leads out of the scenario's folder
             --> small.toml:4:12 (scenario)
              |
            4 | scenario = "../x.toml"
              |            ^^^^^^^^^^^
              = value: "../x.toml"
              = expected: a relative path without `..`: the path of a scenario beside the experiment, or a built-in one such as "builtin:chase""#]],
    );
}

#[test]
fn a_mistake_in_an_override_points_at_its_line_and_names_the_cell() {
    refused(
        &[
            ("params.threat.gain = 0.0", "params.threat.gian = 0.0"),
            ("evader_braitenberg\"", "evader_braitenburg\""),
            (
                "teams.evader.scan = { beams = 72, angle_increment = 0.0872 }\n",
                "",
            ),
            (
                "set = \"teams.evader.limits.v_max\"",
                "set = \"robots.evader_7.limits.v_max\"",
            ), // One of the values is wrong; its cell is named.
            ("[0.8, 1.5, 2]", "[0.8, -1, 2]"),
        ],
        &expect![[r#"
            error: unknown key `gian` (in case potential)
             --> small.toml:9:46 (processes.evader_potential.params.threat.gian)
              |
            9 | set.processes.evader_potential.params.threat.gian = 0.0
              |                                              ^^^^
              = expected: one of `gain`, `reach`, `period_s`
              = help: did you mean `gain`?
            error: unknown process kind `evader_braitenburg` (in case braitenberg, relative_speed = 0.8)
             --> small.toml:15 (processes.evader_braitenburg.kind)
              |
            1 | processes.evader_potential={ kind = "evader_braitenburg", team = "evader" }
              |                                     ^^^^^^^^^^^^^^^^^^^^
              = value: "evader_braitenburg"
              = expected: one of `perception`, `referee`, `observer`, `attacker`, `pursuer`, `evader_braitenberg`, `evader_potential`, `evader_reach_avoid`, `evader_rrt_star`, `policy`, `optimiser`, `ros2_bridge` … (21 in all)
              = help: did you mean `evader_braitenberg`?
            error: robot `evader_1` has no range scanner, but process `evader_braitenberg_evader_1` (evader_braitenberg) steers by it (in case braitenberg, relative_speed = 0.8)
              --> chase_exact.toml:54:1 (robots.evader_1.scan)
               |
            54 | [[robots]]
               | ^^^^^^^^^^
               = expected: a `scan` table on the robot
               = help: scan = {} is the TurtleBot3's scanner: 360 beams, 3.5 m

            error: robot `evader_2` has no range scanner, but process `evader_braitenberg_evader_2` (evader_braitenberg) steers by it (in case braitenberg, relative_speed = 0.8)
              --> chase_exact.toml:59:1 (robots.evader_2.scan)
               |
            59 | [[robots]]
               | ^^^^^^^^^^
               = expected: a `scan` table on the robot
               = help: scan = {} is the TurtleBot3's scanner: 360 beams, 3.5 m
            error: `robots` has no element `evader_7` (in case potential)
              --> small.toml:19:7 (robots.evader_7)
               |
            19 | set = "robots.evader_7.limits.v_max"
               |       ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = expected: one of `police_1`, `police_2`, `police_3`, `police_4`, `evader_1`, `evader_2`, or an index from 0 to 5
               = help: did you mean `evader_1`?
            error: `limits.v_max` is out of range (in case potential, relative_speed = -1)
             --> small.toml:23 (robots.evader_1.limits.v_max)
              |
            1 | teams.evader.limits.v_max=-0.3
              |                           ^^^^
              = value: -0.3
              = expected: a number above 0 and at most 100000 (m/s)

            error: `limits.v_max` is out of range (in case potential, relative_speed = -1)
             --> small.toml:23 (robots.evader_2.limits.v_max)
              |
            1 | teams.evader.limits.v_max=-0.3
              |                           ^^^^
              = value: -0.3
              = expected: a number above 0 and at most 100000 (m/s)"#]],
    );
}

#[test]
fn a_misspelt_key_is_one_problem_at_its_own_line() {
    refused(
        &[
            // For all values of a parameter, and in both cases.
            ("teams.evader.limits.v_max\"", "teams.evader.limits.v_mx\""),
            ("teams.evader.limits.v_max\"", "teems.evader.limits.v_max\""),
            // For all values, in one case.
            ("teams.evader.scan", "teams.evader.scam"),
        ],
        &expect![[r#"
            error: unknown key `v_mx` (in case potential)
              --> small.toml:19:7 (teams.evader.limits.v_mx)
               |
            19 | set = "teams.evader.limits.v_mx"
               |       ^^^^^^^^^^^^^^^^^^^^^^^^^^
               = expected: one of `v_max`, `v_reverse_max`, `omega_max`, `acceleration`, `angular_acceleration`, `wheel_speed_max`
               = help: did you mean `v_max`?
            error: unknown key `teems` (in case potential)
              --> small.toml:19:7 (teems)
               |
            19 | set = "teems.evader.limits.v_max"
               |       ^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = expected: one of `name`, `title`, `description`, `run`, `world`, `rules`, `defaults`, `teams`, `robots`, `processes`, `events`, `links` … (14 in all)
               = help: did you mean `teams`?
            error: unknown key `scam` (in case braitenberg)
              --> small.toml:14:23 (teams.evader.scam)
               |
            14 | teams.evader.scam = { beams = 72, angle_increment = 0.0872 }
               |                       ^^^^^
               = expected: one of `name`, `count`, `team`, `role`, `hostile_to`, `start`, `start_jitter`, `random_start`, `preset`, `radius`, `wheel_separation`, `limits` … (16 in all)
               = help: did you mean `scan`?"#]],
    );
    let levels = GOOD.replace(
        "set = \"teams.evader.limits.v_max\"\nscale = \"teams.police.limits.v_max\"",
        "levels.slow = { rules.time_limt = 5 }\nlevels.fast = { rules.time_limt = 6 }",
    );
    let levels = levels.replace("[0.8, 1.5, 2]", "[\"slow\", \"fast\"]");
    // One problem for each of the two lines.
    texts_refused(
        [levels],
        &expect![[r#"
            error: unknown key `time_limt` (in case potential)
              --> small.toml:19:23 (rules.time_limt)
               |
            19 | levels.slow = { rules.time_limt = 5 }
               |                       ^^^^^^^^^
               = expected: one of `capture`, `exits`, `time_limit`, `end`, `coverage`, `blocked`, `caught`, `escaped`
               = help: did you mean `time_limit`?

            error: unknown key `time_limt` (in case potential)
              --> small.toml:20:23 (rules.time_limt)
               |
            20 | levels.fast = { rules.time_limt = 6 }
               |                       ^^^^^^^^^
               = expected: one of `capture`, `exits`, `time_limit`, `end`, `coverage`, `blocked`, `caught`, `escaped`
               = help: did you mean `time_limit`?"#]],
    );
}
