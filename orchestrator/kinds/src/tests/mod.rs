//! The kinds of this program: parameters and scenarios.

mod builtin;

use config::Node;
use runtime::declaration::Input;
use serde_json::{Value as Json, json};

use scenario::kind::Kind;
use scenario::{Loader, MapCache};

use crate::{KINDS, load};
use scenario::kind::{ConfiguredKind, ParamsProblem, find};
use sim_backend::world::World;

fn read(kind: &Kind, params: &Json) -> ConfiguredKind {
    kind.read(&Node::from_json(params).unwrap()).unwrap()
}

#[test]
fn every_kind_has_valid_defaults_and_presets_and_is_found_by_its_name() {
    for kind in KINDS {
        assert!(
            std::ptr::eq(find(KINDS, kind.name).unwrap(), kind),
            "{}",
            kind.name
        );
        // A patrol needs a contour, an attacker places, a policy its model.
        let least = match kind.name {
            "patrol_awg" | "patrol_fto" => {
                json!({ "mission": { "contour": [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]] } })
            }
            "attacker" => json!({ "places": [[1.0, 1.0]] }),
            "policy" => {
                let model = include_bytes!("../../../../tests/policy/to_the_exit.onnx");
                json!({ "model": runtime::files::value(model) })
            }
            _ => json!({}),
        };
        let defaults = read(kind, &least);
        assert_eq!(read(kind, &defaults.json()), defaults, "{}", kind.name);
        for (name, values) in kind.presets() {
            let preset = read(kind, &values.json());
            assert_eq!(preset, values, "{} {name}", kind.name);
            assert_ne!(preset, defaults, "{} {name}", kind.name);
        }
    }
}

#[test]
fn a_pursuer_needs_beliefs_unless_everything_it_knows_is_exact() {
    let pursuer = find(KINDS, "pursuer").unwrap();
    let needs = |params: Json| {
        let declaration = read(pursuer, &params).declaration();
        declaration.input(Input::BELIEFS.flow).is_some()
    };
    assert!(needs(json!({})));
    assert!(needs(json!({ "knowledge": "exact" })));
    let exact = json!({ "knowledge": "exact", "assignment": { "knowledge": "exact" } });
    assert!(!needs(exact));
}

#[test]
fn parameters_out_of_range_name_their_field() {
    for (kind, params, field) in [
        (
            "perception",
            json!({ "filter": { "particles": 0 } }),
            "filter.particles",
        ),
        (
            "pursuer",
            json!({ "assignment": { "period_s": 0.0 } }),
            "assignment.period_s",
        ),
        (
            "evader_potential",
            json!({ "avoid": { "reach": -1.0 } }),
            "avoid.reach",
        ),
        (
            "evader_reach_avoid",
            json!({ "speed_fraction": 0.0 }),
            "speed_fraction",
        ),
        (
            "evader_rrt_star",
            json!({ "search": { "iterations": 0 } }),
            "search.iterations",
        ),
        (
            "referee",
            json!({ "dominance": { "pitch": -1.0 } }),
            "dominance.pitch",
        ),
        (
            "observer",
            json!({ "horizons_s": [1.0, -1.0] }),
            "horizons_s[1]",
        ),
        (
            "observer",
            json!({ "cat": { "alpha": 1.7 } }),
            "cat.contour",
        ),
        ("optimiser", json!({ "workers": 0 }), "workers"),
        ("navigator", json!({ "margin": -1.0 }), "margin"),
        (
            "evader_braitenberg",
            json!({ "turn_gain": -1.0 }),
            "turn_gain",
        ),
    ] {
        let kind = find(KINDS, kind).unwrap();
        match kind.read(&Node::from_json(&params).unwrap()) {
            Err(ParamsProblem::Faults(found)) => {
                assert_eq!(found[0].field, field);
            }
            other => panic!("{}: {other:?}", kind.name),
        }
    }
}

#[test]
fn a_template_with_a_seed_is_the_scenario_with_that_seed() {
    let mut map_cache = MapCache::default();
    for name in ["chase", "chase_popup", "hello"] {
        let draft = Loader::new(KINDS).draft(name).unwrap();
        let template = draft.template(&mut map_cache).unwrap();
        for seed in [0, 1, 77, i64::MAX as u64] {
            let loaded = load(name, &[], Some(seed)).unwrap();
            assert_eq!(template.with_seed(seed).unwrap(), loaded, "{name} {seed}");
        }
    }
}

#[test]
fn a_template_draws_the_random_starts_of_the_scenario_and_the_world_accepts_them() {
    let draft = Loader::new(KINDS).draft("chase_layouts").unwrap();
    let template = draft.template(&mut MapCache::default()).unwrap();
    for seed in 0..200 {
        let drawn = template.with_seed(seed).unwrap();
        if seed < 5 {
            assert_eq!(drawn, load("chase_layouts", &[], Some(seed)).unwrap());
        }
        World::new(drawn.world).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
    }
}
