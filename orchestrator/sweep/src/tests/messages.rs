//! Every error names file, line, field, value and expected value.

use super::*;

#[test]
fn unknown_keys_are_named_and_the_nearest_is_suggested() {
    for (from, to, key, near) in [
        ("title = \"A small", "titel = \"A small", "titel", "title"),
        ("[grid]", "[gird]", "gird", "grid"),
        ("timeout_s", "timeout", "timeout", "timeout_s"),
        ("scale =", "scael =", "scael", "scale"),
        ("first = 1", "frist = 1", "frist", "first"),
        (
            "x = \"relative_speed\"",
            "x = \"relative_speed\"\ncompares = \"a.csv\"",
            "compares",
            "compare",
        ),
    ] {
        let unknown = format!("unknown key `{key}`");
        let help = format!("did you mean `{near}`?");
        refused(from, to, &[&unknown, "small.toml:", &help]);
    }
    refused(
        "name = \"braitenberg\"",
        "name = \"braitenberg\"\nsett = 1",
        &[
            "unknown key `sett`",
            "cases.braitenberg.sett",
            "did you mean `set`?",
        ],
    );
}

#[test]
fn missing_keys_are_named() {
    refused(
        "scenario = \"builtin:chase_exact\"\n",
        "",
        &["missing key `scenario`", "small.toml:", "builtin:chase"],
    );
    refused(
        "seeds = { first = 1, count = 3 }",
        "",
        &["missing key `seeds`", "small.toml:1", "{ first = 1"],
    );
    refused(
        "name = \"braitenberg\"",
        "",
        &["missing key `name`", "small.toml:11"],
    );
    refused("x = \"relative_speed\"", "", &["missing key `x`"]);
    refused(
        "set = \"teams.evader.limits.v_max\"\nscale = \"teams.police.limits.v_max\"",
        "",
        &[
            "parameter `relative_speed` changes nothing",
            "`set`",
            "`levels`",
        ],
    );
}

#[test]
fn missing_scenarios_are_refused() {
    refused(
        "builtin:chase_exact",
        "builtin:chase_exakt",
        &[
            "there is no built-in scenario `chase_exakt`",
            "did you mean `builtin:chase_exact`?",
        ],
    );
    refused(
        "builtin:chase_exact",
        "nowhere.toml",
        &["nowhere.toml: cannot be read", "small.toml:4:"],
    );
    refused(
        "builtin:chase_exact",
        "chase",
        &["did you mean `builtin:chase`?"],
    );
    refused(
        "builtin:chase_exact",
        "../x.toml",
        &["leads out of the scenario's folder"],
    );
}

#[test]
fn a_mistake_in_an_override_points_at_its_line_and_names_the_cell() {
    refused(
        "params.threat.gain = 0.0",
        "params.threat.gian = 0.0",
        &[
            "unknown key `gian` (in case potential)\n",
            "small.toml:9:",
            "gian = 0.0",
            "did you mean `gain`?",
        ],
    );
    refused(
        "evader_braitenberg\"",
        "evader_braitenburg\"",
        &["small.toml:15", "did you mean `evader_braitenberg`?"],
    );
    refused(
        "teams.evader.scan = { beams = 72, angle_increment = 0.0872 }\n",
        "",
        &["in case braitenberg", "scan"],
    );
    refused(
        "set = \"teams.evader.limits.v_max\"",
        "set = \"robots.evader_7.limits.v_max\"",
        &[
            "`robots` has no element `evader_7`",
            "did you mean `evader_1`?",
        ],
    );
    // One of the values is wrong; its cell is named.
    refused(
        "[0.8, 1.5, 2]",
        "[0.8, -1, 2]",
        &["-0.3", "relative_speed = -1"],
    );
}

#[test]
fn values_of_the_grid_are_checked() {
    refused(
        "[0.8, 1.5, 2]",
        "[]",
        &["grid.relative_speed", "at least one value"],
    );
    refused(
        "[0.8, 1.5, 2]",
        "3",
        &["wrong type", "a list of at least one value"],
    );
    refused(
        "[0.8, 1.5, 2]",
        "[1, 2, 1.0]",
        &["the value 1.0 twice", "grid.relative_speed[2]"],
    );
    refused("[0.8, 1.5, 2]", "[\"fast\"]", &["a number", "is scaled"]);
    refused("[0.8, 1.5, 2]", "[[1]]", &["wrong type: an array"]);
    refused("[0.8, 1.5, 2]", "[nan]", &["finite"]);
    refused(
        "relative_speed = [0.8",
        "relative_sped = [0.8",
        &[
            "unknown parameter `relative_sped`",
            "did you mean `relative_speed`?",
            "has no values",
        ],
    );
    refused("relative_speed = [0.8, 1.5, 2]", "", &["the grid is empty"]);
    refused(
        "[grid]\nrelative_speed = [0.8, 1.5, 2]",
        "",
        &["is not in the grid", "[grid]"],
    );
    let levels = "levels = { slow = { rules.time_limit = 5 } }";
    let text = changed(
        "set = \"teams.evader.limits.v_max\"\nscale = \"teams.police.limits.v_max\"",
        levels,
    )
    .replace("[0.8, 1.5, 2]", "[\"slwo\"]");
    refused_text(&text, &["has no level `slwo`", "did you mean `slow`?"]);
    let text = changed(
        "set = \"teams.evader.limits.v_max\"\n",
        &format!("{levels}\n"),
    );
    refused_text(&text, &["levels cannot be scaled"]);
    let many: Vec<String> = (1..=10_001).map(|i| format!("{i}")).collect();
    refused(
        "[0.8, 1.5, 2]",
        &format!("[{}]", many.join(",")),
        &["more than 10000"],
    );
}

#[test]
fn seeds_are_checked() {
    for (seeds, words) in [
        ("{ first = 1, count = 0 }", "no seeds"),
        ("[1, 2]", "wrong type"),
        ("7", "wrong type"),
        (
            "{ first = 9223372036854775807, count = 2 }",
            "seeds below 2^63",
        ),
        ("{ first = 1, count = 1000001 }", "`count` is out of range"),
    ] {
        refused(
            "{ first = 1, count = 3 }",
            seeds,
            &[words, "small.toml:5:", "(seeds"],
        );
    }
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
        "name = \"small\"",
        "name = \"a/b\"",
        &["`a/b` cannot be a name", "small.toml:2:"],
    );
    refused(
        "name = \"potential\"",
        "name = \"braitenberg\"",
        &["two cases `braitenberg`"],
    );
    refused(
        "timeout_s = 100.0",
        "timeout_s = 0.0",
        &["`timeout_s` is out of range", "(s)"],
    );
    refused(
        "x = \"relative_speed\"",
        "x = \"speed\"",
        &["not a parameter", "figures.chance.x"],
    );
    refused(
        "x = \"relative_speed\"",
        "x = \"relative_speed\"\nmetric = \"escape\"",
        &["not one of the choices", "escape_chance"],
    );
    let text = GOOD.replace("relative_speed", "seed");
    refused_text(&text, &["`seed` cannot be the name of a column"]);
    refused_text("seeds = ", &["not valid TOML", "small.toml:1:"]);
}

#[test]
fn an_unsuitable_sweep_is_refused() {
    refused(
        "params.threat.gain = 0.0",
        "params.threat.gain = 0.0\nset.run.mode = \"real_time\"",
        &["a sweep runs in lock-step", "run.mode"],
    );
    refused(
        "{ kind = \"evader_braitenberg\", team = \"evader\" }",
        "{ name = \"mine\", command = [\"./mine\"], team = \"evader\" }",
        &["starts an external program", "--allow-external"],
    );
    let error = Experiment::load("/no/such.toml".as_ref(), &LoadOptions::new(kinds::KINDS));
    assert!(error.unwrap_err().to_string().contains("/no/such.toml"));
}

#[test]
fn a_misspelt_key_is_one_problem_at_its_own_line() {
    let text = |from, to| load(&changed(from, to)).unwrap_err();
    for (from, to, place) in [
        // For all values of a parameter, and in both cases.
        (
            "teams.evader.limits.v_max\"",
            "teams.evader.limits.v_mx\"",
            "small.toml:19:7 ",
        ),
        (
            "teams.evader.limits.v_max\"",
            "teems.evader.limits.v_max\"",
            "small.toml:19:7 ",
        ),
        // For all values, in one case.
        ("teams.evader.scan", "teams.evader.scam", "small.toml:14:"),
    ] {
        let error = text(from, to);
        assert_eq!(error.matches("error: ").count(), 1, "{error}");
        assert!(
            error.contains("unknown key") && error.contains(place),
            "{error}"
        );
    }
    let levels = GOOD.replace(
        "set = \"teams.evader.limits.v_max\"\nscale = \"teams.police.limits.v_max\"",
        "levels.slow = { rules.time_limt = 5 }\nlevels.fast = { rules.time_limt = 6 }",
    );
    let error = load(&levels.replace("[0.8, 1.5, 2]", "[\"slow\", \"fast\"]")).unwrap_err();
    // One for each of the two lines.
    assert_eq!(error.matches("error: ").count(), 2, "{error}");
    assert!(
        error.contains("small.toml:19:") && error.contains("small.toml:20:"),
        "{error}"
    );
}
