//! Files that contradict themselves.

use super::*;

#[test]
fn a_key_set_by_case_and_parameter_is_a_contradiction() {
    refused(
        "params.threat.gain = 0.0",
        "params.threat.gain = 0.0\nset.teams.evader.limits.v_max = 0.5",
        &[
            "parameter `relative_speed` sets `teams.evader.limits.v_max`, which case `potential` sets too",
            "small.toml:",
            "value: teams.evader.limits.v_max=0.24",
        ],
    );
}

#[test]
fn elements_are_identified_by_index_and_name() {
    refused(
        "params.threat.gain = 0.0",
        "params.threat.gain = 0.0\nset.\"processes[1].params.threat.gain\" = 1.0",
        &[
            "case `potential` sets `processes.evader_potential.params.threat.gain`, which case `potential` sets too",
        ],
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
        "params.threat.gain = 0.0",
        "params.threat.gain = 0.0\nset.processes.evader_potential.name = \"x\"\nset.\"processes[1]\" = { kind = \"evader_potential\", team = \"evader\" }",
        &["which case `potential` sets too"],
    );
}

#[test]
fn a_key_and_levels_exclude_each_other() {
    refused(
        "scale =",
        "levels.a = { rules.time_limit = 1 }\nscale =",
        &["has both `set` and `levels`"],
    );
}

#[test]
fn the_seed_belongs_to_the_seeds() {
    refused(
        "params.threat.gain = 0.0",
        "params.threat.gain = 0.0\nset.run.seed = 4",
        &["case `potential` sets `run.seed`, which `seeds` varies"],
    );
}

#[test]
fn the_command_line_must_not_undo_a_parameter() {
    let options = LoadOptions {
        set: vec!["teams.evader.limits.v_max=1".into()],
        ..LoadOptions::new(kinds::KINDS)
    };
    let error = load_with(GOOD, &options).unwrap_err();
    assert!(
        error.contains("--set sets `teams.evader.limits.v_max`, which parameter"),
        "{error}"
    );
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
        "scale = \"teams.police.limits.v_max\"",
        "scale = \"teams.police.limits.omega_max\"",
        &[
            "`relative_speed` cannot be scaled by `teams.police.limits.omega_max`",
            "value: nothing",
            "a number that the scenario of case `potential` contains",
        ],
    );
    refused(
        "scale = \"teams.police.limits.v_max\"",
        "scale = true",
        &["wrong type", "scale"],
    );
}
