//! `[expect]`: the results that `protean test` expects of a scenario. They are no part of the resolved scenario, and
//! therefore of no history.

use std::collections::BTreeMap;
use std::fmt;

use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

/// Expected results of missions.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ExpectSpec {
    /// Digest of the mission, or a table of digests by seed. `protean test --update` writes it in place of an empty text.
    pub digest: Option<Texts>,
    /// Outcome of the mission, `ended` or `time_limit`; or a table of outcomes by robot, such as `escaped`.
    pub outcome: Option<Texts>,
    /// Digests are not compared; `protean test --update` writes the outcomes of the robots.
    pub outcome_only: bool,
    /// No robot touches another one or an obstacle.
    pub no_contact: bool,
    /// Events that happen in this order, others between them. The words of each are its kind and the names of its
    /// robots and obstacle, as far as they matter: `captured evader_1`.
    pub events: Vec<String>,
    /// Values of a mission, by column of `results.csv`.
    pub columns: BTreeMap<String, Bound>,
    /// Values of a robot, by its name and column of `robots.csv`.
    pub robots: BTreeMap<String, BTreeMap<String, Bound>>,
    /// Share of the evaders that escape.
    pub escape_share: Option<ShareSpec>,
    /// Shares, by outcome: of the missions (`time_limit`), of the evaders (`caught`) or of the robots with a goal
    /// (`goal_reached`). With `columns`, the share of missions with such values, under any name.
    pub shares: BTreeMap<String, ShareSpec>,
    /// Means over the missions, by column of `results.csv`.
    pub means: BTreeMap<String, MeanSpec>,
}

/// A text, or a table of texts.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected a text, or a table of texts")]
pub enum Texts {
    /// A text for all.
    One(String),
    /// Texts by name.
    ByName(BTreeMap<String, String>),
}

/// Expected value of a column.
#[derive(Debug, Clone, PartialEq, JsonSchema)]
#[schemars(untagged)]
pub enum Bound {
    /// This truth value.
    Bool(bool),
    /// This number, up to rounding errors: one part in 10⁹.
    Number(f64),
    /// This text.
    Text(String),
    /// A range of numbers.
    Range(RangeSpec),
}

/// A range of numbers, both ends included; with several keys, the part that they have in common.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RangeSpec {
    /// Minimum.
    pub at_least: Option<f64>,
    /// Maximum.
    pub at_most: Option<f64>,
    /// Middle of the range; `within` is then the tolerance.
    pub value: Option<f64>,
    /// Minimum and maximum, `[low, high]`; or, with `value`, a tolerance.
    pub within: Option<Within>,
}

/// A tolerance, or a range.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected [low, high], or a tolerance beside `value`"
)]
pub enum Within {
    /// Maximum difference from the value.
    Tolerance(f64),
    /// Minimum and maximum.
    Ends([f64; 2]),
}

/// A share over missions, decided by its 95 % interval.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShareSpec {
    /// Number of missions, with the seeds from that of the test on; those of the test if absent.
    #[serde(default)]
    pub over: Option<u64>,
    /// Minimum and maximum of the share.
    pub within: [f64; 2],
    /// Values of the missions that count, by column of `results.csv`.
    #[serde(default)]
    pub columns: BTreeMap<String, Bound>,
}

/// A mean over missions, decided by its 95 % interval.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeanSpec {
    /// Number of missions, as for a share.
    #[serde(default)]
    pub over: Option<u64>,
    /// Minimum and maximum of the mean.
    pub within: [f64; 2],
}

/// By hand, because errors within an untagged enum have no place.
impl<'de> Deserialize<'de> for Bound {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Bound;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a value, or a range such as { at_most = 30.0 }")
            }

            fn visit_bool<E>(self, value: bool) -> Result<Bound, E> {
                Ok(Bound::Bool(value))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Bound, E> {
                Ok(Bound::Number(value as f64))
            }

            fn visit_f64<E>(self, value: f64) -> Result<Bound, E> {
                Ok(Bound::Number(value))
            }

            fn visit_str<E>(self, value: &str) -> Result<Bound, E> {
                Ok(Bound::Text(value.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Bound, A::Error> {
                RangeSpec::deserialize(MapAccessDeserializer::new(map)).map(Bound::Range)
            }
        }
        deserializer.deserialize_any(Reader)
    }
}
