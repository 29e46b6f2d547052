//! Legend of a chart.

use super::chart::Chart;
use super::drawing::{Drawing, Shape, Step};
use super::marks::Look;
use crate::legend::Legend;
use crate::palette;

/// Symbol of a row.
#[derive(Debug, Clone, Copy)]
pub(super) enum Sign {
    /// The curve with this index.
    Curve(usize),
    /// Marks of reference values.
    Hollow,
    /// An interval.
    Bar,
}

/// Returns the legend of a chart, in lines of at most this width (px).
pub(super) fn of(chart: &Chart, width: f64) -> Legend<Sign> {
    let mut legend = Legend::new(width);
    for (index, series) in chart.series.iter().enumerate() {
        legend.row(Sign::Curve(index), &series.name);
    }
    let has_bar = chart
        .series
        .iter()
        .flat_map(|s| &s.points)
        .any(|p| p.interval.is_some());
    if has_bar {
        let text = match chart.interval.as_str() {
            "" => "95 % interval",
            interval => interval,
        };
        legend.note(Sign::Bar, text);
    }
    if chart.has_reference() {
        legend.note(Sign::Hollow, &chart.reference);
    }
    legend
}

/// Draws a legend with its upper left corner at this point (px); `marks` is `true` for curves with marks.
pub(super) fn draw(
    legend: &Legend<Sign>,
    drawing: &mut Drawing,
    [left, top]: [f64; 2],
    marks: bool,
) {
    for row in legend.placed(left, top) {
        row.sign.draw(drawing, row.center, marks);
        for ([x, y], style, text) in row.lines {
            drawing.text(x, y, style, text);
        }
    }
}

impl Sign {
    fn draw(self, drawing: &mut Drawing, at: [f64; 2], marks: bool) {
        let [x, y] = at;
        match self {
            Self::Curve(index) => {
                let look = Look::of(index);
                drawing.shape(&Shape {
                    outline: vec![Step::Move(x - 14.0, y), Step::Line(x + 14.0, y)],
                    line: Some((look.color, 2.0)),
                    dash: look.dash,
                    ..Shape::default()
                });
                if marks {
                    look.mark(drawing, at, false, String::new());
                }
            }
            Self::Hollow => {
                for (index, x) in [x - 10.0, x + 1.0, x + 12.0].into_iter().enumerate() {
                    Look::of(index).mark(drawing, [x, y], true, String::new());
                }
            }
            Self::Bar => {
                let (up, down) = (y - 8.0, y + 8.0);
                for (from, to) in [
                    ([x, up], [x, down]),
                    ([x - 3.0, up], [x + 3.0, up]),
                    ([x - 3.0, down], [x + 3.0, down]),
                ] {
                    drawing.line(from, to, palette::FAINT_INK, 1.5);
                }
            }
        }
    }
}
