//! No input makes the loader panic, and a loaded scenario survives a round trip.

use proptest::prelude::*;

use super::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn arbitrary_text_never_panics(text in ".{0,300}") {
        let _ = load(&text);
    }

    #[test]
    fn a_scenario_with_a_line_replaced_never_panics(
        line in 0usize..47,
        with in prop_oneof![
            ".{0,30}",
            prop::sample::select(vec![
                "[[robots]]", "robots = 3", "[world]", "map = 'x'", "[[world.map.vector.obstacles]]",
                "shape = { polygon = { vertices = [] } }", "start = { x = 1e5, y = -1e5, theta = 1e300 }",
                "kind = 'perception'", "[teams.evader]", "seed = 0", "[[events]]", "robots = ['thief']",
                "shape = { polygon = { vertices = [[0,0],[1,1],[0,1],[1,0]] } }", "max_cells = 1",
                "when = { robot = 'thief', travelled = 1e-3 }", "when = { robot = 'cop', within = 9, of = [0, 0] }",
                "when = { robot = 'cop', progress = 0.5 }", "after_s = 1e9", "when = 3",
                "count = 3", "count = 1", "resolution = 1e-300", "resolution = 1e5", "radius = 1e5", "name = ''", "name = 'wall'",
            ]).prop_map(str::to_owned),
        ],
    ) {
        let text: Vec<&str> = GOOD.lines().enumerate().map(|(i, l)| if i == line { &with } else { l }).collect();
        if let Ok(s) = load(&text.join("\n")) {
            let again = load(&s.to_toml());
            prop_assert_eq!(again.as_ref(), Ok(&s));
        }
    }

    #[test]
    fn every_seed_and_start_round_trips(
        seed in 0..=i64::MAX as u64,
        x in -3.5f64..-1.0, y in -1.5f64..1.5, theta in -3.1f64..3.1, v in 1e-3f64..10.0,
    ) {
        let sets = [
            format!("run.seed={seed}"),
            format!("robots.cop.start={{ x = {x:?}, y = {y:?}, theta = {theta:?} }}"),
            format!("robots.cop.limits.v_max={v:?}"),
        ];
        let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
        let s = load_with(GOOD, &sets).unwrap();
        let cop = &s.world.robots[0];
        prop_assert_eq!((s.run.seed, cop.start.x, cop.start.theta, cop.model().v_max), (seed, x, theta, v));
        let again = load(&s.to_toml());
        prop_assert_eq!(again.as_ref(), Ok(&s));
    }
}
