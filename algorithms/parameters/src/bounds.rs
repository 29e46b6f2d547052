//! Range and unit of a parameter, as they stand in its declaration.

use schemars::Schema;
use schemars::transform::Transform;
use serde::Serialize;
use serde_json::{Map, Value};

/// The keyword that holds the unit of a number.
pub(crate) const UNIT: &str = "x-unit";

/// Range and unit of a number, or of each number of a list.
///
/// It is given to `#[schemars(transform = …)]` on the field. Floating-point numbers are finite
/// without being said so.
#[derive(Debug, Clone, Default)]
pub struct Bounds {
    keywords: Map<String, Value>,
    /// Levels of lists between the field and its numbers.
    depth: usize,
}

/// Numbers above `min`.
pub fn above(min: impl Serialize) -> Bounds {
    Bounds::default().set("exclusiveMinimum", min)
}

/// Numbers of at least `min`.
pub fn at_least(min: impl Serialize) -> Bounds {
    Bounds::default().set("minimum", min)
}

/// Numbers from `min` to `max`, both included.
pub fn between(min: impl Serialize, max: impl Serialize) -> Bounds {
    at_least(min).at_most(max)
}

/// Any number, with a unit.
pub fn unit(unit: &str) -> Bounds {
    Bounds::default().unit(unit)
}

/// The same bounds for each element of a list.
pub fn each(bounds: Bounds) -> Bounds {
    Bounds {
        depth: bounds.depth + 1,
        ..bounds
    }
}

impl Bounds {
    /// The numbers of these that are at most `max`.
    #[must_use]
    pub fn at_most(self, max: impl Serialize) -> Self {
        self.set("maximum", max)
    }

    /// The numbers of these that are below `max`.
    #[must_use]
    pub fn below(self, max: impl Serialize) -> Self {
        self.set("exclusiveMaximum", max)
    }

    /// These numbers, with a unit.
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
