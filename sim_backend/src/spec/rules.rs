//! The rules of the game.

use geometry::extent::{not_negative, positive};
use geometry::map::MAX_EXITS;
use geometry::region::Region;
use parameters::{Parameters, above};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::CoverageSpec;

/// Rules of a mission; the defaults are a world without a game: no capture, no exits, no end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RulesSpec {
    /// When Police catch evaders; never if absent.
    pub capture: Option<CaptureSpec>,
    /// Where evaders escape; the map's own exits count as well.
    #[schemars(length(max = MAX_EXITS))]
    pub exits: Vec<Region>,
    /// Simulated time after which evaders and robots with a goal are timed out; never if absent.
    #[schemars(transform = above(0).at_most(1e9).unit("s"))]
    pub time_limit: Option<f64>,
    /// Which area counts as visited; nothing is accounted for if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage: Option<CoverageSpec>,
    /// What a robot does whose way is blocked.
    pub blocked: Blocked,
    /// What becomes of a caught evader's body.
    pub caught: OutOfPlay,
    /// What becomes of the body of an escaped evader (it left the arena: removed by default).
    pub escaped: OutOfPlay,
}

impl Default for RulesSpec {
    fn default() -> Self {
        Self {
            capture: None,
            exits: Vec::new(),
            time_limit: None,
            coverage: None,
            blocked: Blocked::Slide,
            caught: OutOfPlay::Stay,
            escaped: OutOfPlay::Remove,
        }
    }
}

/// When Police catch an evader.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CaptureSpec {
    /// A Police centre strictly nearer than this to the evader's centre catches it.
    #[schemars(transform = positive("m"))]
    pub radius: f64,
    /// How long some Police robot must have been that near without interruption. At 0 the first
    /// tick catches.
    #[schemars(transform = not_negative("s"))]
    pub dwell: f64,
}

impl Default for CaptureSpec {
    /// The chasing game's 0.3 m, at once.
    fn default() -> Self {
        Self {
            radius: 0.3,
            dwell: 0.0,
        }
    }
}

/// What a robot does that runs into something.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Blocked {
    /// It keeps the part of its motion along the obstacle.
    #[default]
    Slide,
    /// It stays where it touched until its motion leads away.
    Stop,
}

/// What becomes of the body of a robot that is out of the game.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OutOfPlay {
    /// It stands where it is, as an obstacle to the others and to their scans.
    #[default]
    Stay,
    /// It is taken away: nothing touches or sees it.
    Remove,
}

impl Parameters for RulesSpec {}

#[cfg(test)]
mod tests {
    use parameters::check;

    use super::*;

    #[test]
    fn absent_rules_are_a_world_without_a_game() {
        let rules: RulesSpec = toml::from_str("").unwrap();
        assert_eq!(rules.capture, None);
        assert_eq!(rules.caught, OutOfPlay::Stay);
        assert_eq!(rules.escaped, OutOfPlay::Remove);
        assert_eq!(rules.blocked, Blocked::Slide);
        let rules: RulesSpec = toml::from_str(
            "capture = {}\nexits = [{ circle = { center = [9, 0], radius = 0.5 } }]",
        )
        .unwrap();
        assert_eq!(rules.capture.unwrap().radius, 0.3);
        assert!(check(&rules).is_ok());
    }

    #[test]
    fn bad_rules_are_named() {
        let rules: RulesSpec = toml::from_str("time_limit = -1.0").unwrap();
        assert!(
            check(&rules)
                .unwrap_err()
                .to_string()
                .contains("`time_limit` is -1")
        );
        assert!(toml::from_str::<RulesSpec>("capture = { radios = 1 }").is_err());
    }
}
