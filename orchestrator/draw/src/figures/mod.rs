//! Charts: measured points with their intervals, joined to curves, beside published ones; as SVG.
//!
//! * a [`Chart`] says what is to be seen, in numbers and words;
//! * [`fn@draw`] arranges it on a page, as a pure function;
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
