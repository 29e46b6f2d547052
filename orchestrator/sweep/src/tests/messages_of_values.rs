//! Errors of the values of an experiment: grid, seeds, names, modes.

use super::*;

#[test]
fn values_of_the_grid_are_checked() {
    refused(
        &[
            ("[0.8, 1.5, 2]", "[]"),
            ("[0.8, 1.5, 2]", "3"),
            ("[0.8, 1.5, 2]", "[1, 2, 1.0]"),
            ("[0.8, 1.5, 2]", "[\"fast\"]"),
            ("[0.8, 1.5, 2]", "[[1]]"),
            ("[0.8, 1.5, 2]", "[nan]"),
            ("relative_speed = [0.8", "relative_sped = [0.8"),
            ("relative_speed = [0.8, 1.5, 2]", ""),
            ("[grid]\nrelative_speed = [0.8, 1.5, 2]", ""),
        ],
        &expect![[r#"
            error: wrong type: an array
              --> small.toml:23:18 (grid.relative_speed)
               |
            23 | relative_speed = []
               |                  ^^
               = value: []
               = expected: a list of at least one value
            error: wrong type: a whole number
              --> small.toml:23:18 (grid.relative_speed)
               |
            23 | relative_speed = 3
               |                  ^
               = value: 3
               = expected: a list of at least one value
            error: `relative_speed` has the value 1.0 twice
              --> small.toml:23:25 (grid.relative_speed[2])
               |
            23 | relative_speed = [1, 2, 1.0]
               |                         ^^^
               = value: 1.0
               = expected: different values
            error: wrong type: text
              --> small.toml:23:19 (grid.relative_speed[0])
               |
            23 | relative_speed = ["fast"]
               |                   ^^^^^^
               = value: "fast"
               = expected: a number, for `relative_speed` is scaled
            error: wrong type: an array
              --> small.toml:23:19 (grid.relative_speed[0])
               |
            23 | relative_speed = [[1]]
               |                   ^^^
               = value: [1]
               = expected: a finite number, text, true or false
            error: wrong type: a number
              --> small.toml:23:19 (grid.relative_speed[0])
               |
            23 | relative_speed = [nan]
               |                   ^^^
               = value: nan
               = expected: a finite number, text, true or false
            error: parameter `relative_speed` has no values
              --> small.toml:22:1 (grid.relative_speed)
               |
            22 | [grid]
               | ^^^^^^
               = expected: a list of at least one value

            error: unknown parameter `relative_sped`
              --> small.toml:23:17 (grid.relative_sped)
               |
            23 | relative_sped = [0.8, 1.5, 2]
               |                 ^^^^^^^^^^^^^
               = value: [0.8, 1.5, 2]
               = expected: a name from [parameters]: `relative_speed`
               = help: did you mean `relative_speed`?
            error: the grid is empty
              --> small.toml:22:1 (grid)
               |
            22 | [grid]
               | ^^^^^^
               = expected: a list of values for every parameter, for example relative_speed = [1.0, 1.5]
            error: parameter `relative_speed` is not in the grid
              --> small.toml:17:1 (parameters.relative_speed)
               |
            17 | [parameters.relative_speed]
               | ^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = expected: a [grid] with a list of values for every parameter"#]],
    );
    let levels = "levels = { slow = { rules.time_limit = 5 } }";
    let unknown = changed(
        "set = \"teams.evader.limits.v_max\"\nscale = \"teams.police.limits.v_max\"",
        levels,
    )
    .replace("[0.8, 1.5, 2]", "[\"slwo\"]");
    let scaled = changed(
        "set = \"teams.evader.limits.v_max\"\n",
        &format!("{levels}\n"),
    );
    let many: Vec<String> = (1..=10_001).map(|i| format!("{i}")).collect();
    let many = changed("[0.8, 1.5, 2]", &format!("[{}]", many.join(",")));
    texts_refused(
        [unknown, scaled, many],
        &expect![[r#"
        error: `relative_speed` has no level `slwo`
          --> small.toml:22:19 (grid.relative_speed[0])
           |
        22 | relative_speed = ["slwo"]
           |                   ^^^^^^
           = value: "slwo"
           = expected: `slow`
           = help: did you mean `slow`?
        error: levels cannot be scaled
          --> small.toml:20:9 (parameters.relative_speed.scale)
           |
        20 | scale = "teams.police.limits.v_max"
           |         ^^^^^^^^^^^^^^^^^^^^^^^^^^^
           = value: "teams.police.limits.v_max"
           = expected: `scale` beside `set` only

        error: `relative_speed` has no level `0.8`
          --> small.toml:23:19 (grid.relative_speed[0])
           |
        23 | relative_speed = [0.8, 1.5, 2]
           |                   ^^^
           = value: 0.8
           = expected: `slow`

        error: `relative_speed` has no level `1.5`
          --> small.toml:23:24 (grid.relative_speed[1])
           |
        23 | relative_speed = [0.8, 1.5, 2]
           |                        ^^^
           = value: 1.5
           = expected: `slow`

        error: `relative_speed` has no level `2`
          --> small.toml:23:29 (grid.relative_speed[2])
           |
        23 | relative_speed = [0.8, 1.5, 2]
           |                             ^
           = value: 2
           = expected: `slow`
        error: the grid has more than 10000 combinations
          --> small.toml:23:18 (grid.relative_speed)
           |
        23 | relative_speed = [1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25,26,27,28,29,30,31,32,33,34…
           |                  ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
           = value: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, …
           = expected: fewer values, or several experiments"#]],
    );
}

#[test]
fn seeds_are_checked() {
    let seeds = [
        "{ first = 1, count = 0 }",
        "[1, 2]",
        "7",
        "{ first = 9223372036854775807, count = 2 }",
        "{ first = 1, count = 1000001 }",
    ];
    let texts = seeds.map(|seeds| changed("{ first = 1, count = 3 }", seeds));
    texts_refused(
        texts,
        &expect![[r#"
        error: no seeds: nothing to run
         --> small.toml:5:9 (seeds)
          |
        5 | seeds = { first = 1, count = 0 }
          |         ^^^^^^^^^^^^^^^^^^^^^^^^
          = expected: { first = 1, count = 200 }
        error: wrong type: an array
         --> small.toml:5:9 (seeds)
          |
        5 | seeds = [1, 2]
          |         ^^^^^^
          = value: [1, 2]
          = expected: { first = 1, count = 200 }
        error: wrong type: a whole number
         --> small.toml:5:9 (seeds)
          |
        5 | seeds = 7
          |         ^
          = value: 7
          = expected: { first = 1, count = 200 }
        error: `count` is out of range
         --> small.toml:5:48 (seeds.count)
          |
        5 | seeds = { first = 9223372036854775807, count = 2 }
          |                                                ^
          = value: 2
          = expected: seeds below 2^63
        error: `count` is out of range
         --> small.toml:5:30 (seeds.count)
          |
        5 | seeds = { first = 1, count = 1000001 }
          |                              ^^^^^^^
          = value: 1000001
          = expected: a whole number between 0 and 1000000"#]],
    );
    let options = LoadOptions {
        seeds: Some(super::super::Seeds::parse("5..6").unwrap()),
        ..LoadOptions::new(kinds::KINDS)
    };
    let text = changed("seeds = { first = 1, count = 3 }", "");
    assert_eq!(load_with(&text, &options).unwrap().seeds.len(), 2);
}

#[test]
fn names_numbers_and_figures_are_checked() {
    refused(
        &[
            ("name = \"small\"", "name = \"a/b\""),
            ("name = \"potential\"", "name = \"braitenberg\""),
            ("timeout_s = 100.0", "timeout_s = 0.0"),
            ("x = \"relative_speed\"", "x = \"speed\""),
            (
                "x = \"relative_speed\"",
                "x = \"relative_speed\"\nmetric = \"escape\"",
            ),
        ],
        &expect![[r#"
            error: `a/b` cannot be a name
             --> small.toml:2:8 (name)
              |
            2 | name = "a/b"
              |        ^^^^^
              = value: "a/b"
              = expected: 1 to 64 of a-z, A-Z, 0-9, `_`, `-`
            error: two cases `braitenberg`
              --> small.toml:12:8 (cases.braitenberg.name)
               |
            12 | name = "braitenberg"
               |        ^^^^^^^^^^^^^
               = value: "braitenberg"
               = expected: different names
            error: `timeout_s` is out of range
              --> small.toml:26:13 (run.timeout_s)
               |
            26 | timeout_s = 0.0
               |             ^^^
               = value: 0
               = expected: a number between 1 and 1000000 (s)
            error: `speed` is not a parameter of this experiment
              --> small.toml:30:5 (figures.chance.x)
               |
            30 | x = "speed"
               |     ^^^^^^^
               = value: "speed"
               = expected: `relative_speed`
               = help: did you mean `relative_speed`?
            error: `escape` is not one of the choices
              --> small.toml:31:10 (figures.chance.metric)
               |
            31 | metric = "escape"
               |          ^^^^^^^^
               = value: "escape"
               = expected: one of `escape_chance`, `capture_chance`, `held_out_chance`, `game_time`, `first_capture`, `first_escape`, `contacts`, `evader_mean_speed`, `escape_possible`, `lap_length`, `longest_lap`, `planned_mae` … (17 in all)
               = help: did you mean `escape_chance`?"#]],
    );
    let texts = [
        GOOD.replace("relative_speed", "seed"),
        "seeds = ".to_owned(),
    ];
    texts_refused(
        texts,
        &expect![[r#"
        error: `seed` cannot be the name of a column
          --> small.toml:17:1 (parameters.seed)
           |
        17 | [parameters.seed]
           | ^^^^^^^^^^^^^^^^^
           = expected: 1 to 48 of a-z, A-Z, 0-9, `_`, `-`, and not the name of another column of the results
        error: not valid TOML: string values must be quoted
         --> small.toml:1:9
          |
        1 | seeds = 
          |         ^
          = expected: literal string"#]],
    );
}

#[test]
fn an_unsuitable_sweep_is_refused() {
    refused(
        &[
            (
                "params.threat.gain = 0.0",
                "params.threat.gain = 0.0\nset.run.mode = \"real_time\"",
            ),
            (
                "{ kind = \"evader_braitenberg\", team = \"evader\" }",
                "{ name = \"mine\", command = [\"./mine\"], team = \"evader\" }",
            ),
        ],
        &expect![[r#"
            error: a sweep runs in lock-step (in case potential, relative_speed = 0.8)
             --> run.mode
              = value: "real_time"
              = expected: "lock_step": real-time results cannot be reproduced
            error: the scenario of case `braitenberg` starts an external program (in case braitenberg, relative_speed = 0.8)
             --> cases.braitenberg: processes.mine_evader_1.command
              = expected: --allow-external, after a review of the program

            error: the scenario of case `braitenberg` starts an external program (in case braitenberg, relative_speed = 0.8)
             --> cases.braitenberg: processes.mine_evader_2.command
              = expected: --allow-external, after a review of the program"#]],
    );
    let error = Experiment::load("/no/such.toml".as_ref(), &LoadOptions::new(kinds::KINDS));
    expect![[r#"
        error: /no/such.toml: cannot be read: No such file or directory (os error 2)
          = value: /no/such.toml
          = expected: the path of an experiment: a readable file"#]]
    .assert_eq(&error.unwrap_err().to_string());
}
