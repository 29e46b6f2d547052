//! One combination of case and parameters.

use config::{Node, Value as TomlValue, render_float};
use serde::{Deserialize, Serialize};

/// Value of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// A Boolean.
    Bool(bool),
    /// An integer.
    Int(i64),
    /// A finite number.
    Float(f64),
    /// Text.
    Text(String),
}

impl Value {
    /// Converts a node to a value; `None` if it is a table, an array, a date or not finite.
    pub fn from_node(node: &Node) -> Option<Self> {
        match &node.value {
            TomlValue::Bool(v) => Some(Self::Bool(*v)),
            TomlValue::Int(v) => Some(Self::Int(*v)),
            TomlValue::Float(v) if v.is_finite() => Some(Self::Float(*v)),
            TomlValue::Str(v) => Some(Self::Text(v.clone())),
            _ => None,
        }
    }

    /// Returns the value as a number, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Int(v) => Some(*v as f64),
            Self::Float(v) => Some(*v),
            _ => None,
        }
    }

    /// Returns `true` if two values are equal, also in different notation (1 and 1.0).
    pub fn same(&self, other: &Self) -> bool {
        match (self.number(), other.number()) {
            (Some(a), Some(b)) => a == b,
            _ => self == other,
        }
    }
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Bool(v) => write!(f, "{v}"),
            Self::Int(v) => write!(f, "{v}"),
            Self::Float(v) => f.write_str(&render_float(*v)),
            Self::Text(v) => f.write_str(v),
        }
    }
}

/// A combination of case and parameters, to be run with every seed.
#[derive(Debug, Clone)]
pub struct Cell<S> {
    /// Name of the case.
    pub case: String,
    /// Values of the parameters, in the order of the columns.
    pub values: Vec<Value>,
    /// The scenario, as `protean run` takes it; `planning` for plans.
    pub target: String,
    /// The overrides, as `--set` takes them, in their order.
    pub overrides: Vec<String>,
    /// `true` if it starts external programs.
    pub external: bool,
    /// Hash of the complete subject without its seed.
    pub blake3: String,
    /// Subject of its missions.
    pub subject: S,
}

/// Describes a combination: `case potential, relative_speed = 1.5`.
pub fn describe(case: &str, names: &[&str], values: &[Value]) -> String {
    let mut text = format!("case {case}");
    for (name, value) in names.iter().zip(values) {
        text.push_str(&format!(", {name} = {value}"));
    }
    text
}
