//! Tests of the scenario system as a whole.

#![allow(
    clippy::too_many_lines,
    reason = "lists of cases with the texts of their errors"
)]

mod counts;
mod event_messages;
mod messages;
mod messages_of_files;
mod messages_of_parts;
mod messages_of_places;
mod messages_of_starts;
mod properties;
mod remarks;
mod resolve;
mod teams;

use expect_test::{Expect, expect};
use ipc_types::bus::Bus;
use ipc_types::topics::{Belief, Commands, OptimiserPlan, Predictions, Topic, Verdicts};
use parameters::{Parameters, ParamsError};
use runtime::declaration::{Declaration, Flow, Input, Output, When};
use runtime::{Process, ProcessConfig, ProcessError, ProcessKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::files::Base;
use super::kind::Kind;
use super::{Loader, ResolvedScenario};

/// Parameters of the kinds below.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct Params {
    knowledge: Knowledge,
    particles: usize,
    gain: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Knowledge {
    Belief,
    Exact,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            knowledge: Knowledge::Belief,
            particles: 100,
            gain: 0.5,
        }
    }
}

impl Parameters for Params {
    fn check_relations(&self) -> Result<(), ParamsError> {
        if self.gain >= 0.0 {
            return Ok(());
        }
        Err(ParamsError::new("gain", &self.gain, "a number ≥ 0"))
    }
}

/// Kinds like the real ones, but with other parameters. They cannot run.
macro_rules! kinds {
    ($($type:ident $name:literal { $($of_it:tt)* })+) => {
        $(
            struct $type;

            impl Process for $type {
                fn connect(&mut self) -> Result<(), ProcessError> {
                    Ok(())
                }

                fn step(&mut self, _: u64) -> Result<(), ProcessError> {
                    Ok(())
                }
            }

            impl ProcessKind for $type {
                const NAME: &'static str = $name;
                const SUMMARY: &'static str = "";
                type Params = Params;

                fn open(_: &ProcessConfig, _: &Params, _: &Bus) -> Result<Self, ProcessError> {
                    Ok(Self)
                }

                $($of_it)*
            }
        )+

        static KINDS: &[Kind] = &[$(Kind::from_type::<$type>()),+];
    };
}

kinds! {
    Perception "perception" {
        fn declare(_: &Params) -> Declaration {
            Declaration::default().writes(Output::new::<Belief>(1).at(When::ThisTick).sole())
        }
    }
    Pursuer "pursuer" {
        fn declare(params: &Params) -> Declaration {
            steers().reads_if(params.knowledge == Knowledge::Belief, Input::BELIEFS)
        }

        fn presets() -> Vec<(&'static str, Params)> {
            let paper = Params {
                knowledge: Knowledge::Exact,
                gain: 7.0,
                ..Params::default()
            };
            vec![("paper", paper)]
        }
    }
    Braitenberg "evader_braitenberg" {
        fn declare(_: &Params) -> Declaration {
            steers().reads(Input::SCANS)
        }
    }
    Potential "evader_potential" {
        fn declare(_: &Params) -> Declaration {
            steers()
        }
    }
    Ping "ping" {
        fn declare(_: &Params) -> Declaration {
            relays::<Predictions, Verdicts>()
        }
    }
    Pong "pong" {
        fn declare(_: &Params) -> Declaration {
            relays::<Verdicts, Predictions>()
        }
    }
    Optimiser "optimiser" {
        fn declare(_: &Params) -> Declaration {
            Declaration::default().answers::<OptimiserPlan>(1)
        }
    }
    Navigator "navigator" {
        fn declare(_: &Params) -> Declaration {
            steers().asks::<OptimiserPlan>(1)
        }
    }
}

/// A process that reads one flow within the tick and writes another.
fn relays<From: Topic, To: Topic>() -> Declaration {
    Declaration::default()
        .reads(Input::new(Flow::for_topic::<From>(), When::ThisTick))
        .writes(Output::new::<To>(1).at(When::ThisTick))
}

fn steers() -> Declaration {
    Declaration::default().writes(Output::new::<Commands>(1))
}

/// A small scenario without errors.
const GOOD: &str = r#"title = "Small"
[run]
seed = 5
[rules]
time_limit = 30.0
capture = { radius = 0.3 }
exits = [{ circle = { center = [3.0, 0.0], radius = 0.3 } }]
[world.map.vector]
bounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }
[[world.map.vector.obstacles]]
name = "wall"
shape = { rectangle = { center = [0.0, 0.5], half_extents = [0.2, 1.0] } }
[defaults.robot]
limits = { v_max = 0.2 }
[teams.police]
limits = { omega_max = 1.5 }
[[robots]]
name = "cop"
team = "police"
start = { x = -3.0, y = 0.0, theta = 0.0 }
[[robots]]
name = "thief"
team = "evader"
start = { x = 2.0, y = 0.0, theta = 0.0 }
start_jitter = { x = 0.1, y = 0.1, theta = 0.2 }
[[processes]]
kind = "pursuer"
robots = ["cop"]
[[processes]]
kind = "evader_potential"
team = "evader"
[[processes]]
kind = "perception"
params = { particles = 200 }
[[events]]
time_s = 5.0
action = "disappear"
obstacle = "wall"
[[events]]
time_s = 2.5
action = "appear"
obstacle = "block"
shape = { circle = { center = [1.0, -1.0], radius = 0.2 } }
"#;

fn load_with(text: &str, overrides: &[&str]) -> Result<ResolvedScenario, String> {
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    Loader::new(KINDS)
        .load_text("small.toml", text, &Base::Nothing, &overrides, None)
        .map_err(|e| e.to_string())
}

fn load(text: &str) -> Result<ResolvedScenario, String> {
    load_with(text, &[])
}

/// Returns the small scenario with one part replaced; the part must be present.
fn changed(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from:?} is not in the scenario");
    GOOD.replacen(from, to, 1)
}

/// Compares the errors of these scenarios with the snapshot.
#[track_caller]
fn texts_refused(texts: impl IntoIterator<Item = String>, errors: &Expect) {
    let refused = |text: String| load(&text).expect_err(&text);
    let found: Vec<String> = texts.into_iter().map(refused).collect();
    errors.assert_eq(&found.join("\n"));
}

/// Compares the errors of the small scenario, each time with one part replaced, with the snapshot.
#[track_caller]
fn refused(changes: &[(&str, &str)], errors: &Expect) {
    texts_refused(changes.iter().map(|(from, to)| changed(from, to)), errors);
}
