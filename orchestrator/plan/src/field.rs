//! The fields of an instance, each read with its unit and range.

use trajectory_problem::problem::{MAX_NUMBER, MAX_OBSTACLES};
use trajectory_problem::{RobotLimits, Wheels};

use super::instance::{Body, Instance};
use super::loose::Loose;

/// Maximum number of corners of a polygon.
pub const MAX_CORNERS: usize = 1024;
/// Maximum magnitude of a coordinate (px), speed (px/s) or size.
const MAX_PIXELS: f64 = MAX_NUMBER;

/// An invalid field of an instance.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{field} = {value}: expected {expected}")]
pub struct FieldError {
    /// Path of the field, as `obstacles[3].r`.
    pub field: String,
    /// Value of the field.
    pub value: String,
    /// Description of a valid value.
    pub expected: String,
}

impl FieldError {
    pub(super) fn new(
        field: impl Into<String>,
        value: impl core::fmt::Display,
        expected: impl Into<String>,
    ) -> Self {
        Self {
            field: field.into(),
            value: value.to_string(),
            expected: expected.into(),
        }
    }
}

/// Range of a numeric field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Range {
    Any,
    NotNegative,
    NotPositive,
    Positive,
}

impl Range {
    fn words(self) -> &'static str {
        match self {
            Self::Any => "a number",
            Self::NotNegative => "a number ≥ 0",
            Self::NotPositive => "a number ≤ 0",
            Self::Positive => "a number > 0",
        }
    }

    fn has(self, value: f64) -> bool {
        match self {
            Self::Any => true,
            Self::NotNegative => value >= 0.0,
            Self::NotPositive => value <= 0.0,
            Self::Positive => value > 0.0,
        }
    }
}

/// Reads a required number.
fn number(value: Option<&Loose>, field: &str, range: Range, unit: &str) -> Result<f64, FieldError> {
    let expected = || format!("{} ({unit})", range.words());
    let number = match value {
        Some(Loose::Number(v)) => *v,
        Some(other) => return Err(FieldError::new(field, other, expected())),
        None => return Err(FieldError::new(field, "nothing", expected())),
    };
    if number.abs() > MAX_PIXELS {
        let expected = format!("{} of at most {MAX_PIXELS:e} in size", expected());
        return Err(FieldError::new(field, format_args!("{number:e}"), expected));
    }
    if !range.has(number) {
        return Err(FieldError::new(field, number, expected()));
    }
    Ok(number)
}

/// Reads an optional number.
fn optional(from: &Loose, key: &str, range: Range, unit: &str) -> Result<Option<f64>, FieldError> {
    let value = from.get(key);
    value
        .map(|value| number(Some(value), key, range, unit))
        .transpose()
}

/// Reads an instance; `id` is its name, which the caller has read.
///
/// # Errors
/// [`FieldError`] for the first invalid field.
pub fn read_instance(id: &str, from: &Loose) -> Result<Instance, FieldError> {
    use Range::{Any, NotNegative, NotPositive, Positive};
    let get = |key: &str, range, unit| number(from.get(key), key, range, unit);
    let of = |object: &str, key: &str, unit| {
        let value = from.get(object).and_then(|o| o.get(key));
        number(value, &format!("{object}.{key}"), Any, unit)
    };
    let goal = from.get("goal").unwrap_or(&Loose::Null);
    let heading = goal.get("theta");
    let v_max = get("vmax_px_s", Positive, "px/s")?;
    let instance = Instance {
        id: id.to_owned(),
        cm_per_px: get("cm_per_px", Positive, "cm/px")?,
        limits: RobotLimits {
            v_max,
            v_min: optional(from, "v_min", NotPositive, "px/s")?.unwrap_or(-v_max),
            omega_max: get("wmax_rad_s", Positive, "rad/s")?,
            wheels: wheels(from)?,
            acceleration: optional(from, "acceleration_px_s2", Positive, "px/s²")?,
            angular_acceleration: optional(
                from,
                "angular_acceleration_rad_s2",
                Positive,
                "rad/s²",
            )?,
        },
        buffer: get("buffer_px", NotNegative, "px")?,
        bounds: bounds(from)?,
        start: [
            of("start", "x", "px")?,
            of("start", "y", "px")?,
            of("start", "theta", "rad")?,
        ],
        start_speed: optional(from, "start_speed", Any, "px/s")?,
        start_turn_rate: optional(from, "start_turn_rate", Any, "rad/s")?,
        goal: [of("goal", "x", "px")?, of("goal", "y", "px")?],
        goal_heading: heading
            .map(|value| number(Some(value), "goal.theta", Any, "rad"))
            .transpose()?,
        goal_speed: optional(from, "goal_speed", Any, "px/s")?,
        obstacles: obstacles(from)?,
    };
    instance.check().map_err(|error| FieldError {
        field: error.field,
        value: error.value,
        expected: format!("{} (px, s, rad)", error.expected),
    })?;
    Ok(instance)
}

fn bounds(from: &Loose) -> Result<[f64; 4], FieldError> {
    const EXPECTED: &str = "[x, y, x, y] (px) of the lower and the upper corner";
    let value = from.get("bounds_px");
    let Some(Loose::List(list, 4)) = value else {
        let found = value.map_or_else(|| "nothing".to_owned(), ToString::to_string);
        return Err(FieldError::new("bounds_px", found, EXPECTED));
    };
    let mut bounds = [0.0; 4];
    for (i, (bound, value)) in bounds.iter_mut().zip(list.iter()).enumerate() {
        *bound = number(Some(&value), &format!("bounds_px[{i}]"), Range::Any, "px")?;
    }
    if bounds[0] < bounds[2] && bounds[1] < bounds[3] {
        return Ok(bounds);
    }
    Err(FieldError::new(
        "bounds_px",
        format!("{bounds:?}"),
        EXPECTED,
    ))
}

fn wheels(from: &Loose) -> Result<Option<Wheels>, FieldError> {
    let speed = optional(from, "wheel_speed_px_s", Range::Positive, "px/s")?;
    let separation = optional(from, "wheel_separation_px", Range::Positive, "px")?;
    match (speed, separation) {
        (Some(speed), Some(separation)) => Ok(Some(Wheels { speed, separation })),
        (None, None) => Ok(None),
        (Some(_), None) => Err(FieldError::new(
            "wheel_separation_px",
            "nothing",
            "a number > 0 (px) beside wheel_speed_px_s",
        )),
        (None, Some(_)) => Err(FieldError::new(
            "wheel_speed_px_s",
            "nothing",
            "a number > 0 (px/s) beside wheel_separation_px",
        )),
    }
}

fn obstacles(from: &Loose) -> Result<Vec<Body>, FieldError> {
    let value = from.get("obstacles");
    let Some(Loose::List(list, count)) = value else {
        let found = value.map_or_else(|| "nothing".to_owned(), ToString::to_string);
        return Err(FieldError::new("obstacles", found, "a list, empty if none"));
    };
    if *count > MAX_OBSTACLES {
        let expected = format!("at most {MAX_OBSTACLES} obstacles");
        return Err(FieldError::new("obstacles", value_count(*count), expected));
    }
    let bodies = list.iter().enumerate();
    bodies.map(|(i, body)| obstacle(i, &body)).collect()
}

fn value_count(count: usize) -> String {
    format!("a list of {count}")
}

fn obstacle(index: usize, value: &Loose) -> Result<Body, FieldError> {
    let field = format!("obstacles[{index}]");
    let get = |key: &str, range| number(value.get(key), &format!("{field}.{key}"), range, "px");
    match value.get("polygon") {
        Some(corners) => polygon(&format!("{field}.polygon"), corners),
        None if matches!(value, Loose::Object(_)) => Ok(Body::Disc {
            x: get("x", Range::Any)?,
            y: get("y", Range::Any)?,
            r: get("r", Range::NotNegative)?,
        }),
        None => Err(FieldError::new(
            field,
            value,
            "{\"x\", \"y\", \"r\"} or {\"polygon\": [[x, y], …]}",
        )),
    }
}

fn polygon(field: &str, value: &Loose) -> Result<Body, FieldError> {
    let expected = || format!("a list of 3 to {MAX_CORNERS} corners [x, y] (px)");
    let Loose::List(list, count) = value else {
        return Err(FieldError::new(field, value, expected()));
    };
    if !(3..=MAX_CORNERS).contains(count) {
        return Err(FieldError::new(field, value, expected()));
    }
    let mut corners = Vec::with_capacity(*count);
    for (i, corner) in list.iter().enumerate() {
        let field = format!("{field}[{i}]");
        let Loose::List(pair, 2) = corner else {
            return Err(FieldError::new(field, corner, "a corner [x, y] (px)"));
        };
        let at = |k: usize| {
            number(
                pair.get(k).as_ref(),
                &format!("{field}[{k}]"),
                Range::Any,
                "px",
            )
        };
        corners.push([at(0)?, at(1)?]);
    }
    let convex = "the corners of a convex polygon with an area > 0, in order";
    counter_clockwise(corners)
        .map(Body::Polygon)
        .ok_or_else(|| FieldError::new(field, value_count(*count), convex))
}

/// Returns the corners of a convex polygon in counter-clockwise order; `None` if it is not one.
pub fn counter_clockwise(mut corners: Vec<[f64; 2]>) -> Option<Vec<[f64; 2]>> {
    corners.dedup();
    while corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    let n = corners.len();
    let at = |i: usize| corners.get(i % n.max(1)).copied().unwrap_or_default();
    let edge = |i: usize| {
        let (a, b) = (at(i), at(i + 1));
        [b[0] - a[0], b[1] - a[1]]
    };
    let turn = |i: usize| {
        let (a, b) = (edge(i), edge(i + 1));
        a[0] * b[1] - a[1] * b[0]
    };
    if n < 3 {
        return None;
    }
    let (left, right) = (0..n).fold((false, false), |(left, right), i| {
        (left || turn(i) > 0.0, right || turn(i) < 0.0)
    });
    let back = |i: usize| {
        let (a, b) = (edge(i), edge(i + 1));
        turn(i) == 0.0 && a[0] * b[0] + a[1] * b[1] < 0.0
    };
    // The edges of a polygon that winds around twice turn in one direction by 4π.
    let angle = |e: [f64; 2]| geometry::math::atan2(e[1], e[0]);
    let total: f64 = (0..n)
        .map(|i| geometry::math::angle_difference(angle(edge(i + 1)), angle(edge(i))))
        .sum();
    if left == right || (0..n).any(back) || total.abs() > 1.5 * core::f64::consts::TAU {
        return None;
    }
    if right {
        corners.reverse();
    }
    Some(corners)
}
