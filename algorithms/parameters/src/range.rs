//! The values that a schema accepts, as text and as a test.

use core::f64::consts::{PI, TAU};

use ciborium::Value as Data;
use serde_json::{Map, Value};

use crate::bounds::UNIT;

/// The values that one schema accepts.
pub struct Range<'a>(pub &'a Map<String, Value>);

impl<'a> Range<'a> {
    /// Returns `true` if a number is inside.
    pub(crate) fn contains(&self, number: &Data) -> bool {
        let holds =
            |keyword: &str, compare: fn(f64, f64) -> bool, exact: fn(i128, i128) -> bool| {
                let Some(bound) = self.0.get(keyword) else {
                    return true;
                };
                match (number, whole(bound), bound.as_f64()) {
                    (Data::Integer(n), Some(bound), _) => exact(i128::from(*n), bound),
                    (Data::Integer(n), None, Some(bound)) => compare(i128::from(*n) as f64, bound),
                    (Data::Float(x), _, Some(bound)) => compare(*x, bound),
                    _ => true,
                }
            };
        let finite = !matches!(number, Data::Float(x) if !x.is_finite());
        finite
            && holds("minimum", |x, bound| x >= bound, |x, bound| x >= bound)
            && holds("maximum", |x, bound| x <= bound, |x, bound| x <= bound)
            && holds(
                "exclusiveMinimum",
                |x, bound| x > bound,
                |x, bound| x > bound,
            )
            && holds(
                "exclusiveMaximum",
                |x, bound| x < bound,
                |x, bound| x < bound,
            )
    }

    /// Returns `true` if a list may have this many elements.
    pub(crate) fn contains_length(&self, length: usize) -> bool {
        let bound = |keyword: &str| self.0.get(keyword).and_then(Value::as_u64);
        bound("minItems").is_none_or(|min| length as u64 >= min)
            && bound("maxItems").is_none_or(|max| length as u64 <= max)
    }

    /// The unit, if it has one.
    pub fn unit(&self) -> Option<&'a str> {
        self.0.get(UNIT).and_then(Value::as_str)
    }

    /// The usual maximum magnitude of an angle without a declared one, or of a rate of angles: a direction is within a
    /// full turn, a deviation within half of one.
    pub(crate) fn usual_angle(&self) -> Option<f64> {
        let has =
            |keywords: [&str; 2]| keywords.iter().any(|&keyword| self.0.contains_key(keyword));
        match self.unit()? {
            "rad" if has(["maximum", "exclusiveMaximum"]) => None,
            "rad" if !has(["minimum", "exclusiveMinimum"]) => Some(TAU),
            "rad/s" => Some(20.0),
            "rad/s²" => Some(60.0),
            unit => unit.starts_with("rad").then_some(PI),
        }
    }

    /// The accepted numbers in words, with their unit.
    pub(crate) fn numbers(&self, kind: Kind) -> String {
        let get = |keyword: &str| self.0.get(keyword).map(plain);
        let lower = match (get("exclusiveMinimum"), get("minimum")) {
            (Some(min), _) => Some(format!("above {min}")),
            (None, min) => min.map(|min| format!("of at least {min}")),
        };
        let upper = match (get("exclusiveMaximum"), get("maximum")) {
            (Some(max), _) => Some(format!("below {max}")),
            (None, max) => max.map(|max| format!("of at most {max}")),
        };
        let noun = match kind {
            Kind::Whole => "a whole number",
            Kind::Real if lower.is_some() && upper.is_some() => "a number",
            Kind::Real => "a finite number",
        };
        let range = match (lower, upper) {
            (Some(_), Some(_)) if self.is_closed() => {
                let bound = |keyword: &str| self.0.get(keyword).unwrap_or(&Value::Null);
                let (min, max) = (bound("minimum"), bound("maximum"));
                match symmetric(min, max) {
                    Some(most) => format!(" within ±{most}"),
                    None => format!(" between {} and {}", plain(min), plain(max)),
                }
            }
            (Some(lower), Some(upper)) => {
                format!(" {lower} and {}", upper.trim_start_matches("of "))
            }
            (Some(one), None) | (None, Some(one)) => format!(" {one}"),
            (None, None) => String::new(),
        };
        let unit = self.unit().map_or(String::new(), |u| format!(" ({u})"));
        format!("{noun}{range}{unit}")
    }

    /// The accepted numbers in symbols, without their unit.
    pub fn short(&self) -> String {
        let get = |keyword: &str, sign: &str| {
            let bound = self.0.get(keyword)?;
            Some(format!("{sign} {}", plain(bound)))
        };
        if let (true, Some(min), Some(max)) = (
            self.is_closed(),
            self.0.get("minimum"),
            self.0.get("maximum"),
        ) {
            return match symmetric(min, max) {
                Some(most) => format!("±{most}"),
                None => format!("{} to {}", plain(min), plain(max)),
            };
        }
        let lower = get("exclusiveMinimum", ">").or_else(|| get("minimum", "≥"));
        let upper = get("exclusiveMaximum", "<").or_else(|| get("maximum", "≤"));
        let bounds: Vec<String> = lower.into_iter().chain(upper).collect();
        bounds.join(", ")
    }

    /// The accepted numbers of elements of a list, or of characters of a text, in words; empty if any number is
    /// accepted.
    pub fn lengths(&self) -> String {
        let bound = |keyword: &str| self.0.get(keyword).and_then(Value::as_u64);
        let (min, max, noun) = match (bound("minLength"), bound("maxLength")) {
            (None, None) => (bound("minItems"), bound("maxItems"), "values"),
            (min, max) => (min, max, "characters"),
        };
        match (min, max) {
            (Some(min), Some(max)) if min == max => format!("{min} {noun}"),
            (Some(min), Some(max)) => format!("{min} to {max} {noun}"),
            (Some(min), None) => format!("at least {min} {noun}"),
            (None, Some(max)) => format!("at most {max} {noun}"),
            (None, None) => String::new(),
        }
    }

    fn is_closed(&self) -> bool {
        !self.0.contains_key("exclusiveMinimum") && !self.0.contains_key("exclusiveMaximum")
    }
}

/// Numbers with or without a fraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Without a fraction.
    Whole,
    /// With a fraction.
    Real,
}

fn whole(bound: &Value) -> Option<i128> {
    let signed = bound.as_i64().map(i128::from);
    signed.or_else(|| bound.as_u64().map(i128::from))
}

/// The positive bound of a symmetric range; `None` for another range.
fn symmetric(min: &Value, max: &Value) -> Option<String> {
    let (low, high) = (min.as_f64()?, max.as_f64()?);
    (high > 0.0 && low == -high).then(|| plain(max))
}

/// A number for display: 5 for 5.0, and π by its name.
pub fn plain(number: &Value) -> String {
    match (whole(number), number.as_f64()) {
        (_, Some(real)) if real < 0.0 => format!("-{}", plain(&Value::from(-real))),
        (None, Some(PI)) => "π".to_owned(),
        (None, Some(TAU)) => "2π".to_owned(),
        (None, Some(real)) => real.to_string(),
        _ => number.to_string(),
    }
}
