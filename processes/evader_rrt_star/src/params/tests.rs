use super::*;
use parameters::check;

#[test]
fn all_presets_are_valid_and_differ() {
    let presets = [
        RrtStarParams::default(),
        RrtStarParams::paper(),
        RrtStarParams::paper_arc(),
    ];
    for preset in presets {
        check(&preset).unwrap();
    }
    assert_ne!(presets[0], presets[1]);
    assert_ne!(presets[1], presets[2]);
}

#[test]
fn a_budget_of_nothing_is_refused() {
    let params: RrtStarParams = toml::from_str("[search]\niterations = 0").unwrap();
    assert_eq!(
        check(&params).unwrap_err().to_string(),
        "`search.iterations` is 0: expected a whole number between 1 and 1000000"
    );
}

#[test]
fn errors_carry_the_path_of_the_field() {
    for (text, field) in [
        ("margin = -0.1", "margin"),
        ("search = { goal_bias = 0.75 }", "search.goal_bias"),
        ("search = { max_edge = 0.0 }", "search.max_edge"),
        (
            "search = { algorithm = \"published\", max_edge = 0.1 }",
            "search.max_edge",
        ),
        ("cost = { reach = 1.5 }", "cost.reach"),
        ("arc = { min_radius = 0.0 }", "arc.min_radius"),
        (
            "timing = { time_per_iteration_s = -1.0 }",
            "timing.time_per_iteration_s",
        ),
        ("replan = { period_s = 0.0 }", "replan.period_s"),
    ] {
        let params: RrtStarParams = toml::from_str(text).unwrap();
        assert_eq!(check(&params).unwrap_err().field, field);
    }
    assert!(toml::from_str::<RrtStarParams>("iterations = 3").is_err());
}

#[test]
fn a_value_out_of_range_is_named_with_its_range() {
    let bad = CostParams {
        reach: 1.5,
        ..CostParams::default()
    };
    assert_eq!(
        check(&bad).unwrap_err().to_string(),
        "`reach` is 1.5: expected a number between 0 and 1"
    );
}
