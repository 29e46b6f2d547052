//! Charts as SVG: measured points with intervals, joined to curves, and published points for comparison.
//!
//! * a [`Chart`] contains the data and texts;
//! * [`fn@draw`] lays it out on a page, as a pure function;
//! * a [`Drawing`] is an SVG document ([`Drawing::svg`]).

mod axes;
mod chart;
mod draw;
mod drawing;
mod legend;
mod marks;
mod series;
mod stack;
mod ticks;

#[cfg(test)]
mod tests;

pub use chart::{Chart, Point, Scale, Series, Unit};
pub use draw::draw;
pub use drawing::Drawing;
pub use stack::{Bar, Stack};
