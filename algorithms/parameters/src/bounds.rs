//! Range and unit of a parameter in its declaration.

use schemars::Schema;
use schemars::transform::Transform;
use serde::Serialize;
use serde_json::{Map, Value};

/// The keyword that holds the unit of a number.
pub const UNIT: &str = "x-unit";

/// Range and unit of a number, or of each number of a list.
///
/// Stands in brackets behind the type of a field in [`table!`](macro@crate::table), or in `#[schemars(transform = …)]`.
/// Floating-point numbers must always be finite.
#[derive(Debug, Clone, Default)]
pub struct Bounds {
    keywords: Map<String, Value>,
    /// Number of nested lists between the field and its numbers.
    depth: usize,
}

/// Accepts numbers above `min`.
pub fn above(min: impl Serialize) -> Bounds {
    Bounds::default().set("exclusiveMinimum", min)
}

/// Accepts numbers of at least `min`.
pub fn at_least(min: impl Serialize) -> Bounds {
    Bounds::default().set("minimum", min)
}

/// Accepts numbers from `min` to `max`, both included.
pub fn between(min: impl Serialize, max: impl Serialize) -> Bounds {
    at_least(min).at_most(max)
}

/// Accepts any number, with a unit.
pub fn unit(unit: &str) -> Bounds {
    Bounds::default().unit(unit)
}

/// Applies the bounds to each element of a list.
pub fn each(bounds: Bounds) -> Bounds {
    Bounds {
        depth: bounds.depth + 1,
        ..bounds
    }
}

impl Bounds {
    /// Restricts the numbers to at most `max`.
    #[must_use]
    pub fn at_most(self, max: impl Serialize) -> Self {
        self.set("maximum", max)
    }

    /// Restricts the numbers to those below `max`.
    #[must_use]
    pub fn below(self, max: impl Serialize) -> Self {
        self.set("exclusiveMaximum", max)
    }

    /// Adds a unit.
    #[must_use]
    pub fn unit(self, unit: &str) -> Self {
        self.set(UNIT, unit)
    }

    fn set(mut self, keyword: &str, value: impl Serialize) -> Self {
        // A bound is a number and a unit is text: both have a JSON form.
        let value = serde_json::to_value(value).unwrap_or_default();
        self.keywords.insert(keyword.to_owned(), value);
        self
    }
}

impl Transform for Bounds {
    fn transform(&mut self, schema: &mut Schema) {
        let mut object = Some(schema.ensure_object());
        for _ in 0..self.depth {
            object = object
                .and_then(|o| o.get_mut("items"))
                .and_then(Value::as_object_mut);
        }
        if let Some(object) = object {
            object.extend(self.keywords.clone());
        }
    }
}
