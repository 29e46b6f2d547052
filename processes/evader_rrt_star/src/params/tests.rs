use super::*;

#[test]
fn all_presets_are_valid_and_differ() {
    let presets = [
        RrtStarParams::default(),
        RrtStarParams::paper(),
        RrtStarParams::paper_arc(),
    ];
    for preset in presets {
        preset.validate().unwrap();
    }
    assert_ne!(presets[0], presets[1]);
    assert_ne!(presets[1], presets[2]);
}

#[test]
fn a_budget_of_nothing_is_refused() {
    let params: RrtStarParams = toml::from_str("[search]\niterations = 0").unwrap();
    assert_eq!(
        params.validate().unwrap_err().to_string(),
        "`search.iterations` is 0, but must be a number from 1 to 1000000: without iterations \
         there is no plan"
    );
    let params: RrtStarParams = toml::from_str("timing = { real_time_budget_s = 0.0 }").unwrap();
    assert_eq!(
        params.validate().unwrap_err().field,
        "timing.real_time_budget_s"
    );
}

#[test]
fn errors_carry_the_path_of_the_field() {
    for (text, field) in [
        ("margin = -0.1", "margin"),
        ("search = { goal_bias = 1.5 }", "search.goal_bias"),
        ("search = { min_edge = 5.0 }", "search.min_edge"),
        ("search = { refine_share = 0.95 }", "search.refine_share"),
        ("cost = { closest = 0.0 }", "cost.closest"),
        ("arc = { max_bearing = 2.0 }", "arc.max_bearing"),
        ("replan = { period_s = 0.0 }", "replan.period_s"),
        ("tracking = { look_ahead = 0.0 }", "tracking.look_ahead"),
        ("field = { avoid = { reach = -1.0 } }", "field.avoid.reach"),
        ("tree_edges = 9999", "tree_edges"),
    ] {
        let params: RrtStarParams = toml::from_str(text).unwrap();
        assert_eq!(params.validate().unwrap_err().field, field);
    }
    assert!(toml::from_str::<RrtStarParams>("iterations = 3").is_err());
}
