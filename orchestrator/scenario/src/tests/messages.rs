//! Every error contains file, line, field, value and expected value.

use super::*;

#[test]
fn a_syntax_error_contains_its_line() {
    refused(
        &[("seed = 5", "seed = ")],
        &expect![[r#"
        error: not valid TOML: string values must be quoted
         --> small.toml:3:8
          |
        3 | seed = 
          |        ^
          = expected: literal string"#]],
    );
}

#[test]
fn unknown_keys_are_named_and_the_nearest_is_suggested() {
    refused(
        &[
            ("seed = 5", "sead = 5"),
            ("[rules]", "[rule]"),
            ("limits = { v_max = 0.2 }", "limits = { vmax = 0.2 }"),
            ("[teams.police]", "[teams.polize]"),
            ("action = \"appear\"", "action = \"appears\""),
        ],
        &expect![[r#"
            error: unknown key `sead`
             --> small.toml:3:1 (run.sead)
              |
            3 | sead = 5
              | ^^^^
              = value: 5
              = expected: one of `dt`, `seed`, `mode`, `real_time_factor`, `pin`, `hang_timeout_s`, `ready_timeout_s`, `command_deadline_s`
              = help: did you mean `seed`?
            error: unknown key `rule`
             --> small.toml:4:2 (rule)
              |
            4 | [rule]
              |  ^^^^
              = value: { time_limit = 30.0, capture = { radius = 0.3 }, exits = [{ …
              = expected: one of `name`, `title`, `description`, `run`, `world`, `rules`, `defaults`, `teams`, `robots`, `processes`, `events`, `links` … (14 in all)
              = help: did you mean `rules`?
            error: unknown key `vmax`
              --> small.toml:14:12 (defaults.robot.limits.vmax)
               |
            14 | limits = { vmax = 0.2 }
               |            ^^^^
               = value: 0.2
               = expected: one of `v_max`, `v_reverse_max`, `omega_max`, `acceleration`, `angular_acceleration`, `wheel_speed_max`
               = help: did you mean `v_max`?
            error: no robot is in team `polize`
              --> small.toml:15:1 (teams.polize)
               |
            15 | [teams.polize]
               | ^^^^^^^^^^^^^^
               = expected: a team: one of `police`, `evader`
               = help: did you mean `police`?
            error: `appears` is not one of the choices
              --> small.toml:41:10 (events[1].action)
               |
            41 | action = "appears"
               |          ^^^^^^^^^
               = value: "appears"
               = expected: one of `appear`, `disappear`, `move`
               = help: did you mean `appear`?"#]],
    );
}

#[test]
fn several_mistakes_are_reported_at_once_in_the_order_of_the_file() {
    let text = changed("seed = 5", "seed = \"five\"\ndt = 7.0")
        .replace("\"cop\"\nteam", "\"cop\"\ncolour = 3\nteam")
        .replace("particles = 200", "particels = 200, gain = \"x\"");
    texts_refused(
        [text],
        &expect![[r#"
            error: wrong type: text
             --> small.toml:3:8 (run.seed)
              |
            3 | seed = "five"
              |        ^^^^^^
              = value: "five"
              = expected: a whole number, 0 or more

            error: unknown key `colour`
              --> small.toml:20:1 (robots.cop.colour)
               |
            20 | colour = 3
               | ^^^^^^
               = value: 3
               = expected: one of `name`, `count`, `team`, `role`, `hostile_to`, `start`, `start_jitter`, `random_start`, `preset`, `radius`, `wheel_separation`, `limits` … (16 in all)
               = help: did you mean `count`?

            error: unknown key `particels`
              --> small.toml:36:12 (processes.perception.params.particels)
               |
            36 | params = { particels = 200, gain = "x" }
               |            ^^^^^^^^^
               = value: 200
               = expected: one of `knowledge`, `particles`, `gain`
               = help: did you mean `particles`?

            error: wrong type: text
              --> small.toml:36:36 (processes.perception.params.gain)
               |
            36 | params = { particels = 200, gain = "x" }
               |                                    ^^^
               = value: "x"
               = expected: a number"#]],
    );
}

#[test]
fn numbers_out_of_range_are_refused_with_their_limits() {
    refused(
        &[
            ("seed = 5", "dt = 7.0"),
            ("seed = 5", "dt = nan"),
            ("seed = 5", "seed = -5"),
            ("time_limit = 30.0", "time_limit = -1"),
            ("radius = 0.3 } }]", "radius = -0.3 } }]"),
            ("v_max = 0.2", "v_max = -0.2"),
            ("theta = 0.2 }", "theta = 9.0 }"),
            (
                "team = \"evader\"\nstart",
                "team = \"evader\"\nscan = { beams = 5000 }\nstart",
            ),
            ("particles = 200", "gain = -1"),
        ],
        &expect![[r#"
            error: `run.dt` is out of range
             --> small.toml:3:6 (run.dt)
              |
            3 | dt = 7.0
              |      ^^^
              = value: 7
              = expected: a number between 0.0001 and 1 (s)
            error: value not allowed
             --> small.toml:3:6 (run.dt)
              |
            3 | dt = nan
              |      ^^^
              = value: nan
              = expected: a finite number
            error: value not allowed
             --> small.toml:3:8 (run.seed)
              |
            3 | seed = -5
              |        ^^
              = value: -5
              = expected: a whole number, 0 or more
            error: `rules.time_limit` is out of range
             --> small.toml:5:14 (rules.time_limit)
              |
            5 | time_limit = -1
              |              ^^
              = value: -1
              = expected: a number above 0 and at most 1000000000 (s)
            error: `rules.exits[0].circle.radius` is out of range
             --> small.toml:7:53 (rules.exits[0].circle.radius)
              |
            7 | exits = [{ circle = { center = [3.0, 0.0], radius = -0.3 } }]
              |                                                     ^^^^
              = value: -0.3
              = expected: a number above 0 and at most 100000 (m)
            error: `limits.v_max` is out of range
              --> small.toml:14:20 (robots.cop.limits.v_max)
               |
            14 | limits = { v_max = -0.2 }
               |                    ^^^^
               = value: -0.2
               = expected: a number above 0 and at most 100000 (m/s)
            error: `start_jitter.theta` is out of range
              --> small.toml:25:44 (robots.thief.start_jitter.theta)
               |
            25 | start_jitter = { x = 0.1, y = 0.1, theta = 9.0 }
               |                                            ^^^
               = value: 9
               = expected: a number between 0 and π (rad)
            error: `scan.beams` is out of range
              --> small.toml:24:18 (robots.thief.scan.beams)
               |
            24 | scan = { beams = 5000 }
               |                  ^^^^
               = value: 5000
               = expected: a whole number between 1 and 4096
            error: `gain` is out of range
              --> small.toml:34:19 (processes.perception.params.gain)
               |
            34 | params = { gain = -1 }
               |                   ^^
               = value: -1
               = expected: a number ≥ 0"#]],
    );
}

#[test]
fn robots_have_unique_names_and_required_keys() {
    let without = GOOD[..GOOD.find("[[robots]]").unwrap()].to_owned();
    let table = changed("[[robots]]", "[robots]").replace("[[robots]]", "[x]");
    texts_refused(
        [without, table],
        &expect![[r#"
            error: the scenario has no robots
             --> small.toml:1:1 (robots)
              |
            1 | title = "Small"
              | ^
              = expected: at least one [[robots]] block
            error: wrong type: a table
              --> small.toml:17:1 (robots)
               |
            17 | [robots]
               | ^^^^^^^^
               = value: { name = "cop", team = "police", start = { x = -3.0, y = 0.0…
               = expected: an array

            error: wrong type: a table
              --> small.toml:17:1 (robots)
               |
            17 | [robots]
               | ^^^^^^^^
               = expected: [[robots]] blocks

            error: unknown key `x`
              --> small.toml:21:2 (x)
               |
            21 | [x]
               |  ^
               = value: { name = "thief", team = "evader", start = { x = 2.0, y = 0.…
               = expected: one of `name`, `title`, `description`, `run`, `world`, `rules`, `defaults`, `teams`, `robots`, `processes`, `events`, `links` … (14 in all)

            error: no robot is called `cop`
              --> small.toml:28:11 (processes.pursuer.robots[0])
               |
            28 | robots = ["cop"]
               |           ^^^^^
               = value: "cop"
               = expected: nothing

            error: no robot is in team `evader`
              --> small.toml:31:8 (processes.evader_potential.team)
               |
            31 | team = "evader"
               |        ^^^^^^^^
               = value: "evader"
               = expected: nothing"#]],
    );
    refused(
        &[
            ("name = \"thief\"", "name = \"cop\""),
            ("team = \"police\"", ""),
            ("name = \"cop\"", ""),
            ("name = \"cop\"", "name = \"a cop\""),
            (
                "[defaults.robot]",
                "[defaults.robot]\nstart = { x = 1, y = 1, theta = 0 }",
            ),
            (
                "[defaults.robot]",
                "[defaults.robot]\npreset = \"turtlebot3\"",
            ),
        ],
        &expect![[r#"
            error: two robots are called `cop` (the other is at small.toml:17)
              --> small.toml:22:8 (robots.cop.name)
               |
            22 | name = "cop"
               |        ^^^^^
               = value: "cop"
               = expected: a unique name for every robot
            error: missing key `team`
              --> small.toml:17:1 (robots.cop.team)
               |
            17 | [[robots]]
               | ^^^^^^^^^^
               = expected: team = "…"
            error: missing key `name`
              --> small.toml:17:1 (robots[0].name)
               |
            17 | [[robots]]
               | ^^^^^^^^^^
               = expected: name = "…"
            error: name not allowed
              --> small.toml:18:8 (robots."a cop".name)
               |
            18 | name = "a cop"
               |        ^^^^^^^
               = value: "a cop"
               = expected: 1 to 48 of the characters a–z, A–Z, 0–9, _ and -
            error: `start` cannot be inherited: every robot has its own
              --> small.toml:14:1 (defaults.robot.start)
               |
            14 | start = { x = 1, y = 1, theta = 0 }
               | ^^^^^
               = value: { x = 1, y = 1, theta = 0 }
               = expected: `start` in each [[robots]] block
            error: `turtlebot3` is not one of the choices
              --> small.toml:14:10 (defaults.robot.preset)
               |
            14 | preset = "turtlebot3"
               |          ^^^^^^^^^^^^
               = value: "turtlebot3"
               = expected: one of `turtlebot3_burger`, `lego_nxt`
               = help: did you mean `turtlebot3_burger`?"#]],
    );
    let block = |i: usize| {
        format!(
            "[[robots]]\nname = \"r{i}\"\nteam = \"neutral\"\nstart = {{ x = 0, y = 0, theta = 0 }}\n"
        )
    };
    let many: String = (0..65).map(block).collect();
    refused(
        &[("[[processes]]", &format!("{many}[[processes]]"))],
        &expect![[r#"
            error: too many robots
               --> small.toml:274:1 (robots.r62)
                |
            274 | [[robots]]
                | ^^^^^^^^^^
                = value: 67
                = expected: at most 64 robots"#]],
    );
}
