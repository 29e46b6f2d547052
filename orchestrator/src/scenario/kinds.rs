//! The kinds of processes that a scenario may name, and their parameters.

use coverage_planners::{BoustrophedonParams, ChebyshevParams, KeyedCoverageParams, RandomParams};
use evader_braitenberg::BraitenbergParams;
use evader_potential::EvaderParams;
use evader_reach_avoid::ReachAvoidParams;
use evader_rrt_star::RrtStarParams;
use navigator::NavigatorParams;
use observer::ObserverParams;
use optimiser::OptimiserParams;
use patrol_planners::{PatrolAwgParams, PatrolFtoParams};
use pursuer::PursuerParams;
use referee::RefereeParams;
use serde::Serialize;
use serde_json::Value as Json;
use tracking::params::PerceptionParams;

pub use super::kind::{KindInfo, Need, Preset, Product, check_params, find};
pub use super::params_fault::ParamsFault;
use super::params_fault::patrol_fault;

/// The kinds of this program, in the order in which they are listed.
pub static KINDS: &[KindInfo] = &[
    KindInfo {
        makes: &[Product::Beliefs],
        presets: &[("paper", || preset(&PerceptionParams::paper()))],
        ..KindInfo::new(
            "perception",
            "what the Police see, and what they believe about what they do not see",
            |node| check_params(node, PerceptionParams::validate),
        )
    },
    KindInfo::new(
        "referee",
        "says who reaches what first, and which evader can still be sure of an escape",
        |node| check_params(node, RefereeParams::validate),
    ),
    KindInfo {
        remembers: true,
        ..KindInfo::new(
            "observer",
            "watches robots, predicts where they will be, and measures how wrong it was",
            |node| check_params(node, ObserverParams::validate),
        )
    },
    KindInfo {
        needs: |params| {
            let by_belief = |at: &str| params.pointer(at).and_then(Json::as_str) == Some("belief");
            let beliefs = by_belief("/knowledge") || by_belief("/assignment/knowledge");
            if beliefs {
                vec![Need::Belief]
            } else {
                Vec::new()
            }
        },
        presets: &[("paper", || preset(&PursuerParams::paper()))],
        ..KindInfo::driver("pursuer", "chases evaders as one of a team", |node| {
            check_params(node, parameters::check::<PursuerParams>)
        })
    },
    KindInfo {
        needs: |_| vec![Need::Scan],
        presets: &[("paper", || preset(&BraitenbergParams::paper()))],
        ..KindInfo::driver(
            "evader_braitenberg",
            "flees by its range scan alone, away from what is near",
            |node| check_params(node, BraitenbergParams::validate),
        )
    },
    KindInfo {
        presets: &[("paper", || preset(&EvaderParams::paper()))],
        ..KindInfo::driver(
            "evader_potential",
            "flees to the nearest exit on a potential field",
            |node| check_params(node, parameters::check::<EvaderParams>),
        )
    },
    KindInfo::driver(
        "evader_reach_avoid",
        "flees by ways on which no pursuer can stop it, or to where it has most time",
        |node| check_params(node, ReachAvoidParams::validate),
    ),
    KindInfo {
        presets: &[
            ("paper", || preset(&RrtStarParams::paper())),
            ("paper_arc", || preset(&RrtStarParams::paper_arc())),
        ],
        ..KindInfo::driver(
            "evader_rrt_star",
            "plans its way to an exit past the Police with RRT*",
            |node| check_params(node, RrtStarParams::validate),
        )
    },
    KindInfo {
        makes: &[Product::Plans],
        ..KindInfo::new(
            "optimiser",
            "makes minimum-time trajectories for whoever asks",
            |node| check_params(node, OptimiserParams::validate),
        )
    },
    KindInfo {
        needs: |params| {
            let goals = params.get("goals").and_then(Json::as_array);
            let mut needs = vec![Need::Plans];
            if goals.is_none_or(Vec::is_empty) {
                needs.push(Need::Goal);
            }
            needs
        },
        presets: &[("paper", || preset(&NavigatorParams::paper()))],
        ..KindInfo::driver(
            "navigator",
            "drives to goals on trajectories of the optimiser, around what pops up",
            |node| check_params(node, NavigatorParams::validate),
        )
    },
    KindInfo {
        needs: |_| vec![Need::Scan],
        ..KindInfo::planner(
            "patrol_awg",
            "patrols a contour along a zig-zag that only its key foretells",
            |node| {
                check_params(node, |params: &PatrolAwgParams| {
                    params.validate().map_err(patrol_fault)
                })
            },
        )
    },
    KindInfo {
        needs: |_| vec![Need::Scan],
        ..KindInfo::planner(
            "patrol_fto",
            "patrols a contour past fictive obstacles, or mixes them with a zig-zag",
            |node| {
                check_params(node, |params: &PatrolFtoParams| {
                    params.validate().map_err(patrol_fault)
                })
            },
        )
    },
    KindInfo::planner(
        "coverage_chebyshev",
        "covers a workplace by chaotic sub-goals, rectangle after rectangle",
        |node| {
            check_params(node, |params: &ChebyshevParams| {
                if let Some(key) = &params.key {
                    key.validate().map_err(|error| ParamsFault::Refused {
                        field: "key".into(),
                        message: format!("`key`: {error}"),
                    })?;
                }
                params.validate().map_err(ParamsFault::from)
            })
        },
    ),
    KindInfo::planner(
        "keyed_coverage",
        "covers a workplace fast, by sub-goals that only its key foretells",
        |node| check_params(node, KeyedCoverageParams::validate),
    ),
    KindInfo::planner(
        "coverage_boustrophedon",
        "covers a workplace in parallel lanes: the fastest, and the easiest to foretell",
        |node| check_params(node, BoustrophedonParams::validate),
    ),
    KindInfo::planner(
        "coverage_random_bounce",
        "drives straight from wall to wall, away at random angles",
        |node| check_params(node, RandomParams::validate),
    ),
    KindInfo::planner(
        "coverage_uniform",
        "drives to independent, uniformly random sub-goals",
        |node| check_params(node, RandomParams::validate),
    ),
];

/// A preset as [`KindInfo::presets`] holds it.
fn preset(params: &impl Serialize) -> Json {
    // Parameter structs are plain numbers, words and tables: they always have a JSON form.
    serde_json::to_value(params).unwrap_or(Json::Null)
}

#[cfg(test)]
mod tests {
    use config::Node;
    use serde_json::json;

    use super::*;

    fn complete(kind: &KindInfo, params: &Json) -> Json {
        (kind.check_params)(&Node::from_json(params).unwrap()).unwrap()
    }

    #[test]
    fn every_kind_has_valid_defaults_and_presets_and_is_found_by_its_name() {
        for kind in KINDS {
            assert!(
                std::ptr::eq(find(KINDS, kind.name).unwrap(), kind),
                "{}",
                kind.name
            );
            // A patrol must say where.
            let least = match kind.name {
                "patrol_awg" | "patrol_fto" => {
                    json!({ "mission": { "contour": [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]] } })
                }
                _ => json!({}),
            };
            let defaults = complete(kind, &least);
            assert_eq!(complete(kind, &defaults), defaults, "{}", kind.name);
            for (name, values) in kind.presets {
                let preset = complete(kind, &values());
                assert_ne!(preset, defaults, "{} {name}", kind.name);
            }
        }
    }

    #[test]
    fn a_pursuer_needs_beliefs_unless_everything_it_knows_is_exact() {
        let pursuer = find(KINDS, "pursuer").unwrap();
        let needs = |params: Json| (pursuer.needs)(&complete(pursuer, &params));
        assert_eq!(needs(json!({})), [Need::Belief]);
        assert_eq!(needs(json!({ "knowledge": "exact" })), [Need::Belief]);
        let exact = json!({ "knowledge": "exact", "assignment": { "knowledge": "exact" } });
        assert_eq!(needs(exact), []);
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
                "horizons_s.1",
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
            match (kind.check_params)(&Node::from_json(&params).unwrap()) {
                Err(ParamsFault::Field(found)) => assert_eq!(found.field, field),
                other => panic!("{}: {other:?}", kind.name),
            }
        }
    }
}
