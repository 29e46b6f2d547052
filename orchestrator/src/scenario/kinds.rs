//! The kinds of processes that a scenario may name, and their parameters.

use coverage_baselines::{BoustrophedonParams, RandomParams};
use coverage_chebyshev::ChebyshevParams;
use evader_braitenberg::BraitenbergParams;
use evader_potential::EvaderParams;
use evader_reach_avoid::ReachAvoidParams;
use evader_rrt_star::RrtStarParams;
use guidance::params::ParamsError;
use keyed_coverage::KeyedCoverageParams;
use navigator::NavigatorParams;
use observer::ObserverParams;
use optimiser::OptimiserParams;
use patrol::mission::MissionError;
use patrol_awg::{PatrolAwgParams, PatrolError};
use patrol_fto::{PatrolFtoError, PatrolFtoParams};
use pursuer::PursuerParams;
use referee::RefereeParams;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value as Json;
use sim_backend::spec::FieldError;
use tracking::params::PerceptionParams;

use super::text::{Node, ReadError, read_once};

/// A parameter out of its range, as a process crate reports it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldProblem {
    /// Dotted path of the parameter inside `params`.
    pub field: String,
    /// The value found.
    pub value: String,
    /// What would have been accepted.
    pub expected: String,
}

impl From<tracking::params::ParamsError> for FieldProblem {
    fn from(e: tracking::params::ParamsError) -> Self {
        Self {
            field: e.field.to_owned(),
            value: e.value.to_string(),
            expected: e.expected.to_owned(),
        }
    }
}

impl From<ParamsError> for FieldProblem {
    fn from(e: ParamsError) -> Self {
        Self {
            field: e.field,
            value: e.value,
            expected: e.expected.to_owned(),
        }
    }
}

impl From<FieldError> for FieldProblem {
    fn from(e: FieldError) -> Self {
        Self {
            field: e.field,
            value: e.value,
            expected: e.expected,
        }
    }
}

/// Why the parameters of a process were refused.
#[derive(Debug, Clone, PartialEq)]
pub enum ParamsFault {
    /// They do not fit their type.
    Read(ReadError),
    /// A value is out of its range.
    Field(FieldProblem),
    /// Values that do not go together, or a table that makes no sense, in words that say what to
    /// change.
    Refused {
        /// Dotted path of the parameter inside `params` at which it shows.
        field: String,
        /// What is wrong with it.
        message: String,
    },
    /// They cannot be written as JSON (a number that is not finite, say).
    Write(String),
}

impl<E: Into<FieldProblem>> From<E> for ParamsFault {
    fn from(e: E) -> Self {
        Self::Field(e.into())
    }
}

/// A patrol along a zig-zag that cannot be.
fn awg_fault(error: PatrolError) -> ParamsFault {
    match error {
        PatrolError::Params(error) => error.into(),
        PatrolError::Mission(error) => mission_fault(error),
    }
}

/// A patrol past fictive obstacles that cannot be.
fn fto_fault(error: PatrolFtoError) -> ParamsFault {
    match error {
        PatrolFtoError::Params(error) => error.into(),
        PatrolFtoError::Mission(error) => mission_fault(error),
        PatrolFtoError::Fto(error) => named_fault("fto", &error),
    }
}

fn mission_fault(error: MissionError) -> ParamsFault {
    match error {
        MissionError::Params(error) => error.within("mission").into(),
        error => named_fault("mission", &error),
    }
}

/// A refusal at the parameter of a table that its text names first.
fn named_fault(table: &str, error: &dyn core::fmt::Display) -> ParamsFault {
    let message = error.to_string();
    let field = match message.split('`').nth(1) {
        Some(named) => format!("{table}.{named}"),
        None => table.to_owned(),
    };
    ParamsFault::Refused { field, message }
}

/// Something that a process needs and another part of the scenario must provide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// Beliefs about the opponents: a `perception` process.
    Belief,
    /// A `scan` sensor on every robot that the process drives.
    Scan,
    /// Trajectories on request: an `optimiser` process.
    Plans,
    /// A `goal` of every robot that the process drives.
    Goal,
}

/// A name and the parameters that it stands for.
pub type Preset = (&'static str, fn() -> Json);

/// Something that a kind of process makes for others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Product {
    /// The beliefs that [`Need::Belief`] asks for.
    Beliefs,
    /// The plans that [`Need::Plans`] asks for.
    Plans,
    /// What becomes of waypoints (`robot/waypoint`).
    Waypoints,
}

/// A kind of process.
pub struct KindInfo {
    /// The name that scenarios use (`kind = "…"`).
    pub name: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
    /// Whether it commands robots (and then must be given some).
    pub drives_robots: bool,
    /// What it makes for others.
    pub makes: &'static [Product],
    /// Reads and checks `params`, and gives them back complete: every default filled in.
    pub check_params: fn(&Node) -> Result<Json, ParamsFault>,
    /// What it needs, given its complete parameters.
    pub needs: fn(&Json) -> Vec<Need>,
    /// Most allowed of the numeric parameters named.
    pub caps: &'static [(&'static str, f64)],
    /// Sets of parameters that `params.preset` names; keys beside it change single values.
    pub presets: &'static [Preset],
}

/// Reads parameters into `P`, checks them, and writes them back complete; the body of most
/// [`KindInfo::check_params`]:
///
/// ```text
/// check_params: |node| check_params(node, PursuerParams::validate),
/// ```
///
/// # Errors
/// What does not fit `P`, or what `validate` refuses.
pub fn check_params<P, E>(
    node: &Node,
    validate: impl FnOnce(&P) -> Result<(), E>,
) -> Result<Json, ParamsFault>
where
    P: DeserializeOwned + Serialize,
    E: Into<ParamsFault>,
{
    let params: P = read_once(node).map_err(ParamsFault::Read)?;
    validate(&params).map_err(E::into)?;
    serde_json::to_value(&params).map_err(|e| ParamsFault::Write(e.to_string()))
}

impl KindInfo {
    /// Whether it makes something for others.
    pub fn makes(&self, product: Product) -> bool {
        self.makes.contains(&product)
    }
}

/// The kind with this name.
pub fn find<'k>(kinds: &'k [KindInfo], name: &str) -> Option<&'k KindInfo> {
    kinds.iter().find(|k| k.name == name)
}

/// The kinds of this program, in the order in which they are listed.
pub static KINDS: &[KindInfo] = &[
    KindInfo {
        name: "perception",
        summary: "what the Police see, and what they believe about what they do not see",
        drives_robots: false,
        makes: &[Product::Beliefs],
        check_params: |node| check_params(node, PerceptionParams::validate),
        needs: |_| Vec::new(),
        caps: &[
            ("filter.particles", super::spec::MAX_PARTICLES as f64),
            ("filter.adaptive.most", super::spec::MAX_PARTICLES as f64),
        ],
        presets: &[("paper", || preset(&PerceptionParams::paper()))],
    },
    KindInfo {
        name: "referee",
        summary: "says who reaches what first, and which evader can still be sure of an escape",
        drives_robots: false,
        makes: &[],
        check_params: |node| check_params(node, RefereeParams::validate),
        needs: |_| Vec::new(),
        caps: &[],
        presets: &[],
    },
    KindInfo {
        name: "observer",
        summary: "watches robots, predicts where they will be, and measures how wrong it was",
        drives_robots: false,
        makes: &[],
        check_params: |node| check_params(node, ObserverParams::validate),
        needs: |_| Vec::new(),
        caps: &[
            ("filter.particles", super::spec::MAX_PARTICLES as f64),
            ("filter.adaptive.most", super::spec::MAX_PARTICLES as f64),
        ],
        presets: &[],
    },
    KindInfo {
        name: "pursuer",
        summary: "chases evaders as one of a team",
        drives_robots: true,
        makes: &[],
        check_params: |node| check_params(node, PursuerParams::validate),
        needs: |params| {
            let by_belief = |at: &str| params.pointer(at).and_then(Json::as_str) == Some("belief");
            let beliefs = by_belief("/knowledge") || by_belief("/assignment/knowledge");
            if beliefs {
                vec![Need::Belief]
            } else {
                Vec::new()
            }
        },
        caps: &[],
        presets: &[("paper", || preset(&PursuerParams::paper()))],
    },
    KindInfo {
        name: "evader_braitenberg",
        summary: "flees by its range scan alone, away from what is near",
        drives_robots: true,
        makes: &[],
        check_params: |node| check_params(node, BraitenbergParams::validate),
        needs: |_| vec![Need::Scan],
        caps: &[],
        presets: &[("paper", || preset(&BraitenbergParams::paper()))],
    },
    KindInfo {
        name: "evader_potential",
        summary: "flees to the nearest exit on a potential field",
        drives_robots: true,
        makes: &[],
        check_params: |node| check_params(node, EvaderParams::validate),
        needs: |_| Vec::new(),
        caps: &[],
        presets: &[("paper", || preset(&EvaderParams::paper()))],
    },
    KindInfo {
        name: "evader_reach_avoid",
        summary: "flees by ways on which no pursuer can stop it, or to where it has most time",
        drives_robots: true,
        makes: &[],
        check_params: |node| check_params(node, ReachAvoidParams::validate),
        needs: |_| Vec::new(),
        caps: &[],
        presets: &[],
    },
    KindInfo {
        name: "evader_rrt_star",
        summary: "plans its way to an exit past the Police with RRT*",
        drives_robots: true,
        makes: &[],
        check_params: |node| check_params(node, RrtStarParams::validate),
        needs: |_| Vec::new(),
        caps: &[],
        presets: &[
            ("paper", || preset(&RrtStarParams::paper())),
            ("paper_arc", || preset(&RrtStarParams::paper_arc())),
        ],
    },
    KindInfo {
        name: "optimiser",
        summary: "makes minimum-time trajectories for whoever asks",
        drives_robots: false,
        makes: &[Product::Plans],
        check_params: |node| check_params(node, OptimiserParams::validate),
        needs: |_| Vec::new(),
        caps: &[],
        presets: &[],
    },
    KindInfo {
        name: "navigator",
        summary: "drives to goals on trajectories of the optimiser, around what pops up",
        drives_robots: true,
        makes: &[],
        check_params: |node| check_params(node, NavigatorParams::validate),
        needs: |params| {
            let goals = params.get("goals").and_then(Json::as_array);
            let mut needs = vec![Need::Plans];
            if goals.is_none_or(Vec::is_empty) {
                needs.push(Need::Goal);
            }
            needs
        },
        caps: &[],
        presets: &[("paper", || preset(&NavigatorParams::paper()))],
    },
    KindInfo {
        name: "patrol_awg",
        summary: "patrols a contour along a zig-zag that only its key foretells",
        drives_robots: true,
        makes: &[Product::Waypoints],
        check_params: |node| {
            check_params(node, |params: &PatrolAwgParams| {
                params.validate().map_err(awg_fault)
            })
        },
        needs: |_| vec![Need::Scan],
        caps: &[],
        presets: &[],
    },
    KindInfo {
        name: "patrol_fto",
        summary: "patrols a contour past fictive obstacles, or mixes them with a zig-zag",
        drives_robots: true,
        makes: &[Product::Waypoints],
        check_params: |node| {
            check_params(node, |params: &PatrolFtoParams| {
                params.validate().map_err(fto_fault)
            })
        },
        needs: |_| vec![Need::Scan],
        caps: &[],
        presets: &[],
    },
    KindInfo {
        name: "coverage_chebyshev",
        summary: "covers a workplace by chaotic sub-goals, rectangle after rectangle",
        drives_robots: true,
        makes: &[Product::Waypoints],
        check_params: |node| {
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
        needs: |_| Vec::new(),
        caps: &[],
        presets: &[],
    },
    KindInfo {
        name: "keyed_coverage",
        summary: "covers a workplace fast, by sub-goals that only its key foretells",
        drives_robots: true,
        makes: &[Product::Waypoints],
        check_params: |node| check_params(node, KeyedCoverageParams::validate),
        needs: |_| Vec::new(),
        caps: &[],
        presets: &[],
    },
    KindInfo {
        name: "coverage_boustrophedon",
        summary: "covers a workplace in parallel lanes: the fastest, and the easiest to foretell",
        drives_robots: true,
        makes: &[Product::Waypoints],
        check_params: |node| check_params(node, BoustrophedonParams::validate),
        needs: |_| Vec::new(),
        caps: &[],
        presets: &[],
    },
    KindInfo {
        name: "coverage_random_bounce",
        summary: "drives straight from wall to wall, away at random angles",
        drives_robots: true,
        makes: &[Product::Waypoints],
        check_params: |node| check_params(node, RandomParams::validate),
        needs: |_| Vec::new(),
        caps: &[],
        presets: &[],
    },
    KindInfo {
        name: "coverage_uniform",
        summary: "drives to independent, uniformly random sub-goals",
        drives_robots: true,
        makes: &[Product::Waypoints],
        check_params: |node| check_params(node, RandomParams::validate),
        needs: |_| Vec::new(),
        caps: &[],
        presets: &[],
    },
];

/// A preset as [`KindInfo::presets`] holds it.
fn preset(params: &impl Serialize) -> Json {
    // Parameter structs are plain numbers, words and tables: they always have a JSON form.
    serde_json::to_value(params).unwrap_or(Json::Null)
}

#[cfg(test)]
mod tests {
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
                json!({ "dominance": { "wave": { "sight": -1.0 } } }),
                "dominance.wave.sight",
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
