//! Tests of the public interface of the crate.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod c_library;
mod division;
mod planners;
mod random_map;
mod tables;
mod walks;

use nalgebra::Point2;

/// Points of a straight leg (m), without the start and with the end, in equal parts of at most `step` (m).
fn interpolate(from: Point2<f64>, to: Point2<f64>, step: f64) -> impl Iterator<Item = Point2<f64>> {
    let line = to - from;
    let parts = (line.norm() / step).ceil().max(1.0) as u32;
    (1..=parts).map(move |part| from + line * (f64::from(part) / f64::from(parts)))
}
