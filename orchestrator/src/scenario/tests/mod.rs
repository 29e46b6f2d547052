//! Tests of the scenario system as a whole.

mod builtin;
mod event_messages;
mod messages;
mod messages_of_parts;
mod properties;
mod resolve;

use serde::{Deserialize, Serialize};
use sim_backend::params::ParamsError;

use super::files::Base;
use super::kinds::{KindInfo, Need, Product, check_params};
use super::{Loader, ResolvedScenario};

/// Parameters of the kinds below.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Params {
    knowledge: Knowledge,
    particles: usize,
    gain: f64,
}

#[derive(Debug, Serialize, Deserialize)]
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

impl Params {
    fn validate(&self) -> Result<(), ParamsError> {
        if self.gain >= 0.0 {
            return Ok(());
        }
        Err(ParamsError {
            field: "gain".into(),
            value: self.gain.to_string(),
            expected: "a number ≥ 0".into(),
        })
    }
}

const fn kind(name: &'static str, drives_robots: bool, provides_belief: bool) -> KindInfo {
    KindInfo {
        name,
        summary: "",
        remembers: false,
        drives_robots,
        makes: if provides_belief {
            &[Product::Beliefs]
        } else {
            &[]
        },
        check_params: |node| check_params(node, Params::validate),
        needs: |_| Vec::new(),
        presets: &[],
    }
}

/// Kinds like the real ones, but with parameters of our own.
static KINDS: &[KindInfo] = &[
    kind("perception", false, true),
    KindInfo {
        needs: |p| {
            if p["knowledge"] == "belief" {
                vec![Need::Belief]
            } else {
                Vec::new()
            }
        },
        presets: &[(
            "paper",
            || serde_json::json!({ "knowledge": "exact", "gain": 7.0 }),
        )],
        ..kind("pursuer", true, false)
    },
    KindInfo {
        needs: |_| vec![Need::Scan],
        ..kind("evader_braitenberg", true, false)
    },
    kind("evader_potential", true, false),
    KindInfo {
        makes: &[Product::Plans],
        ..kind("optimiser", false, false)
    },
    KindInfo {
        needs: |_| vec![Need::Plans],
        ..kind("navigator", true, false)
    },
];

/// A small scenario in which nothing is wrong.
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
    Loader::with_kinds(KINDS)
        .load_text("small.toml", text, &Base::Nothing, &overrides, None)
        .map_err(|e| e.to_string())
}

fn load(text: &str) -> Result<ResolvedScenario, String> {
    load_with(text, &[])
}

/// The small scenario with one part replaced (which must be there).
fn changed(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from:?} is not in the scenario");
    GOOD.replacen(from, to, 1)
}

/// What loading the changed scenario says, which must contain every one of `wants`.
#[track_caller]
fn refused(from: &str, to: &str, wants: &[&str]) {
    contains(
        &load(&changed(from, to)).expect_err("must be refused"),
        wants,
    );
}

#[track_caller]
fn contains(text: &str, wants: &[&str]) {
    for want in wants {
        assert!(text.contains(want), "missing {want:?} in:\n{text}");
    }
}
