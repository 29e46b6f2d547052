//! The kinds of processes of this program.

use config::Diagnostics;
use coverage_planners::{
    BoustrophedonPlanner, ChebyshevPlanner, KeyedCoveragePlanner, RandomBouncePlanner,
    UniformPlanner,
};
use evader_braitenberg::process::BraitenbergPlanner;
use evader_potential::process::PotentialPlanner;
use evader_reach_avoid::process::ReachAvoidPlanner;
use evader_rrt_star::process::RrtStarPlanner;
use navigator::process::NavigatorPlanner;
use observer::process::ObserverProcess;
use optimiser::process::OptimiserProcess;
use patrol_planners::process::{PatrolAwgPlanner, PatrolFtoPlanner};
use perception::process::PerceptionProcess;
use planner::{Planner, PlannerProcess};
use pursuer::process::PursuerPlanner;
use referee::process::RefereeProcess;

use crate::scenario::kind::Kind;
use crate::scenario::{Loader, ResolvedScenario};

/// The kinds of this program, in the order in which they are listed.
pub static KINDS: &[Kind] = &[
    Kind::of::<PerceptionProcess>(),
    Kind::of::<RefereeProcess>(),
    Kind::of::<ObserverProcess>(),
    planner::<PursuerPlanner>(),
    planner::<BraitenbergPlanner>(),
    planner::<PotentialPlanner>(),
    planner::<ReachAvoidPlanner>(),
    planner::<RrtStarPlanner>(),
    Kind::of::<OptimiserProcess>(),
    planner::<NavigatorPlanner>(),
    planner::<PatrolAwgPlanner>(),
    planner::<PatrolFtoPlanner>(),
    planner::<ChebyshevPlanner>(),
    planner::<KeyedCoveragePlanner>(),
    planner::<BoustrophedonPlanner>(),
    planner::<RandomBouncePlanner>(),
    planner::<UniformPlanner>(),
];

/// The kind of the processes that steer robots by a planner.
pub const fn planner<P: Planner>() -> Kind {
    Kind::of::<PlannerProcess<P>>()
}

/// Loads a scenario with the kinds of this program; its files must lie in its folder.
///
/// # Errors
/// As [`Loader::load`].
pub fn load(
    target: &str,
    overrides: &[String],
    seed: Option<u64>,
) -> Result<ResolvedScenario, Diagnostics> {
    Loader::new(KINDS).load(target, overrides, seed)
}

#[cfg(test)]
mod reference;

#[cfg(test)]
mod tests {
    use config::Node;
    use runtime::kind::Need;
    use serde_json::{Value as Json, json};

    use super::*;
    use crate::scenario::kind::{ConfiguredKind, ParamsProblem, find};

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
            // A patrol must say where.
            let least = match kind.name {
                "patrol_awg" | "patrol_fto" => {
                    json!({ "mission": { "contour": [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]] } })
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
        let needs = |params: Json| read(pursuer, &params).needs(Need::Belief);
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
                Err(ParamsProblem::Fault(found)) => {
                    assert_eq!(found.field, field);
                }
                other => panic!("{}: {other:?}", kind.name),
            }
        }
    }
}
