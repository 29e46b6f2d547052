//! Files that contradict themselves.

use super::*;

#[test]
fn a_key_set_by_case_and_parameter_is_a_contradiction() {
    refused(
        &[(
            "params.threat.gain = 0.0",
            "params.threat.gain = 0.0\nset.teams.evader.limits.v_max = 0.5",
        )],
        &expect![[r#"
            error: parameter `relative_speed` sets `teams.evader.limits.v_max`, which case `potential` sets too
             --> small.toml:24: teams.evader.limits.v_max
              = value: teams.evader.limits.v_max=0.24
              = expected: every key set in one place

            error: parameter `relative_speed` sets `teams.evader.limits.v_max`, which case `potential` sets too
             --> small.toml:24: teams.evader.limits.v_max
              = value: teams.evader.limits.v_max=0.45
              = expected: every key set in one place

            error: parameter `relative_speed` sets `teams.evader.limits.v_max`, which case `potential` sets too
             --> small.toml:24: teams.evader.limits.v_max
              = value: teams.evader.limits.v_max=0.6
              = expected: every key set in one place"#]],
    );
}

#[test]
fn elements_are_identified_by_index_and_name() {
    refused(
        &[(
            "params.threat.gain = 0.0",
            "params.threat.gain = 0.0\nset.\"processes[1].params.threat.gain\" = 1.0",
        )],
        &expect![[r#"
            error: case `potential` sets `processes.evader_potential.params.threat.gain`, which case `potential` sets too
             --> small.toml:10: processes.evader_potential.params.threat.gain
              = value: processes[1].params.threat.gain=1.0
              = expected: every key set in one place"#]],
    );
}

#[test]
fn replacing_an_earlier_change_is_a_contradiction_and_refining_is_not() {
    let text = changed(
        "set = \"teams.evader.limits.v_max\"\nscale = \"teams.police.limits.v_max\"",
        "set = \"processes.evader_braitenberg.params.turn_gain\"",
    );
    let text = text.replacen("[[cases]]\nname = \"potential\"\nset.processes.evader_potential.params.threat.gain = 0.0\n", "", 1);
    assert_eq!(
        load(&text).unwrap().cells.len(),
        3,
        "a parameter of the process that the case brought"
    );
    refused(
        &[(
            "params.threat.gain = 0.0",
            "params.threat.gain = 0.0\nset.processes.evader_potential.name = \"x\"\nset.\"processes[1]\" = { kind = \"evader_potential\", team = \"evader\" }",
        )],
        &expect![[r#"
            error: case `potential` sets `processes.x`, which case `potential` sets too
             --> small.toml:11: processes.x
              = value: processes[1]={ kind = "evader_potential", team = "evader" }
              = expected: every key set in one place"#]],
    );
}

#[test]
fn a_key_and_levels_exclude_each_other() {
    refused(
        &[("scale =", "levels.a = { rules.time_limit = 1 }\nscale =")],
        &expect![[r#"
            error: parameter `relative_speed` has both `set` and `levels`
              --> small.toml:17:1 (parameters.relative_speed)
               |
            17 | [parameters.relative_speed]
               | ^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = expected: `set` (the key that takes the value), or `levels` (named tables of overrides)

            error: unknown parameter `relative_speed`
              --> small.toml:24:18 (grid.relative_speed)
               |
            24 | relative_speed = [0.8, 1.5, 2]
               |                  ^^^^^^^^^^^^^
               = value: [0.8, 1.5, 2]
               = expected: a name from [parameters]: nothing

            error: `relative_speed` is not a parameter of this experiment
              --> small.toml:31:5 (figures.chance.x)
               |
            31 | x = "relative_speed"
               |     ^^^^^^^^^^^^^^^^
               = value: "relative_speed"
               = expected: nothing"#]],
    );
}

#[test]
fn the_seed_belongs_to_the_seeds() {
    refused(
        &[(
            "params.threat.gain = 0.0",
            "params.threat.gain = 0.0\nset.run.seed = 4",
        )],
        &expect![[r#"
            error: case `potential` sets `run.seed`, which `seeds` varies
             --> small.toml:10: run.seed
              = value: run.seed=4
              = expected: every key set in one place"#]],
    );
}

#[test]
fn the_command_line_must_not_undo_a_parameter() {
    let options = LoadOptions {
        set: vec!["teams.evader.limits.v_max=1".into()],
        ..LoadOptions::new(kinds::KINDS)
    };
    let error = load_with(GOOD, &options).unwrap_err();
    expect![[r#"
        error: --set sets `teams.evader.limits.v_max`, which parameter `relative_speed` sets too
         --> --set: teams.evader.limits.v_max
          = value: teams.evader.limits.v_max=1
          = expected: every key set in one place"#]]
    .assert_eq(&error);
    let options = LoadOptions {
        set: vec!["rules.time_limit=5".into()],
        ..LoadOptions::new(kinds::KINDS)
    };
    let experiment = load_with(GOOD, &options).unwrap();
    let limit = |cell: usize| {
        experiment.cells[cell]
            .scenario(1)
            .unwrap()
            .world
            .rules
            .time_limit
    };
    assert_eq!((limit(0), limit(5)), (Some(5.0), Some(5.0)));
}

#[test]
fn a_factor_must_be_written_in_the_scenario() {
    refused(
        &[
            (
                "scale = \"teams.police.limits.v_max\"",
                "scale = \"teams.police.limits.omega_max\"",
            ),
            ("scale = \"teams.police.limits.v_max\"", "scale = true"),
        ],
        &expect![[r#"
            error: `relative_speed` cannot be scaled by `teams.police.limits.omega_max`
             --> small.toml:20: parameters.relative_speed.scale
              = value: nothing
              = expected: a number that the scenario of case `potential` contains, or a number in its place

            error: `relative_speed` cannot be scaled by `teams.police.limits.omega_max`
             --> small.toml:20: parameters.relative_speed.scale
              = value: nothing
              = expected: a number that the scenario of case `braitenberg` contains, or a number in its place
            error: wrong type: true/false
              --> small.toml:20:9 (parameters.relative_speed.scale)
               |
            20 | scale = true
               |         ^^^^
               = value: true
               = expected: a number, or the key of a number in the scenario

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
               = expected: nothing"#]],
    );
}
