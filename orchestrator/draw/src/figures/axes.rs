//! Axes, grid and frame of a chart.

use super::chart::{Chart, Scale, Unit, number};
use super::drawing::{Drawing, Shape, Step};
use super::ticks::Ticks;
use crate::canvas::{Style, text_width};
use crate::palette;

/// Colour of grid lines, the faintest of the chart.
const GRID: &str = "#e3e6ea";
/// Font size of tick labels (px).
const TICK: f64 = 13.0;
/// Font size of axis labels (px).
const LABEL: f64 = 14.5;

/// The axes of a chart and their area of the page.
pub(super) struct Axes {
    x: Ticks,
    y: Ticks,
    x_scale: Scale,
    y_scale: Scale,
    /// Left, top, right, bottom (px).
    area: [f64; 4],
}

impl Axes {
    /// Creates axes for the points of a chart, in an area of the page: left, top, right, bottom (px).
    pub(super) fn new(chart: &Chart, area: [f64; 4]) -> Self {
        Self {
            x: horizontal(chart),
            y: vertical(chart),
            x_scale: chart.x_scale,
            y_scale: chart.y_scale,
            area,
        }
    }

    /// Returns the width of the tick labels of the vertical axis (px).
    pub(super) fn room(chart: &Chart) -> f64 {
        let widths = vertical(chart).values.into_iter();
        let widths = widths.map(|v| text_width(&tick_text(chart.unit, v), TICK));
        widths.fold(0.0, f64::max)
    }

    /// Returns the position of a point on the page (px).
    pub(super) fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let [left, top, right, bottom] = self.area;
        let part = |v: f64, ticks: &Ticks| (v - ticks.low) / (ticks.high - ticks.low);
        [
            left + part(self.x_scale.place(x), &self.x) * (right - left),
            bottom - part(self.y_scale.place(y), &self.y).clamp(-0.02, 1.02) * (bottom - top),
        ]
    }

    /// Returns the minimum distance of two different values of the horizontal axis (px).
    pub(super) fn spacing(&self) -> f64 {
        let pairs = self.x.values.iter().zip(self.x.values.iter().skip(1));
        let gaps = pairs.map(|(a, b)| self.place(*b, 0.0)[0] - self.place(*a, 0.0)[0]);
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// Draws grid, frame, tick labels and axis labels.
    pub(super) fn draw(&self, chart: &Chart, drawing: &mut Drawing) {
        let [left, top, right, bottom] = self.area;
        let tick = Style {
            size: TICK,
            color: palette::INK,
            bold: false,
            anchor: "end",
            halo: false,
        };
        for &value in &self.y.values {
            let y = self.place(self.x.low, value)[1];
            drawing.line([left, y], [right, y], GRID, 1.0);
            drawing.text(left - 8.0, y + 4.5, tick, &tick_text(chart.unit, value));
        }
        let middle = Style {
            anchor: "middle",
            ..tick
        };
        let mut written = f64::NEG_INFINITY;
        // Long numbers need more space between them.
        let apart = if self.x_scale == Scale::Linear {
            3.0
        } else {
            12.0
        };
        for &value in &self.x.values {
            let x = self.place(value, 0.0)[0];
            drawing.line([x, bottom], [x, bottom + 5.0], palette::INK, 1.2);
            let text = match chart.x_names.get(value as usize) {
                Some(name) => name.clone(),
                None => number(value),
            };
            // Labels that would overlap are left out.
            let half = text_width(&text, TICK) / 2.0;
            if x - half >= written {
                drawing.text(x, bottom + 20.0, middle, &text);
                written = x + half + apart;
            }
        }
        drawing.shape(&Shape {
            outline: vec![
                Step::Move(left, top),
                Step::Line(left, bottom),
                Step::Line(right, bottom),
            ],
            line: Some((palette::INK, 1.2)),
            ..Shape::default()
        });
        let label = Style {
            size: LABEL,
            ..middle
        };
        drawing.text(
            f64::midpoint(left, right),
            bottom + 44.0,
            label,
            &chart.x_label,
        );
        let x = left - Self::room(chart) - 20.0;
        drawing.upright(x, f64::midpoint(top, bottom), label, &chart.y_label);
    }
}

/// Returns ticks at the values of the points if they are few, else at round numbers.
fn horizontal(chart: &Chart) -> Ticks {
    if !chart.x_names.is_empty() {
        let places = 0..chart.x_names.len() as u32;
        let mut ticks = Ticks::at(places.map(f64::from).collect());
        (ticks.low, ticks.high) = (-0.5, chart.x_names.len() as f64 - 0.5);
        return ticks;
    }
    if chart.x_scale == Scale::Logarithmic {
        return decades(chart.points().map(|p| p.x));
    }
    let ticks = Ticks::at(chart.points().map(|p| p.x).collect());
    if ticks.values.len() <= 12 {
        return ticks;
    }
    let round = Ticks::over(ticks.low, ticks.high, 8.0);
    let within = |v: &f64| ticks.low <= *v && *v <= ticks.high;
    Ticks {
        values: round.values.into_iter().filter(within).collect(),
        ..ticks
    }
}

/// Returns ticks at powers of ten around all values; `low` and `high` are exponents.
fn decades(values: impl Iterator<Item = f64>) -> Ticks {
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values.fold(ends, |(low, high), value| {
        let at = Scale::Logarithmic.place(value);
        (at.floor().min(low), at.ceil().max(high))
    });
    let (low, high) = if low < high {
        (low, high)
    } else if low.is_finite() {
        (low - 1.0, low + 1.0)
    } else {
        (0.0, 1.0)
    };
    let exponents = low as i32..=high as i32;
    Ticks {
        low,
        high,
        values: exponents.map(|e| 10_f64.powi(e)).collect(),
    }
}

fn vertical(chart: &Chart) -> Ticks {
    match chart.unit {
        Unit::Share => Ticks::over(0.0, 1.0, 5.0),
        Unit::Number if chart.y_scale == Scale::Logarithmic => {
            let reach = chart.points().map(super::chart::Point::reach);
            decades(reach.flat_map(|(low, high)| [low, high]))
        }
        Unit::Number => {
            let reach = || chart.points().map(super::chart::Point::reach);
            let low = reach().map(|r| r.0).fold(0.0, f64::min);
            let high = reach().map(|r| r.1).fold(0.0, f64::max);
            Ticks::over(low, if high > low { high } else { low + 1.0 }, 5.0)
        }
    }
}

fn tick_text(unit: Unit, value: f64) -> String {
    match unit {
        Unit::Share => format!("{:.0} %", 100.0 * value),
        Unit::Number => number(value),
    }
}
