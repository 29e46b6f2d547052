//! Legend of a chart.

use super::chart::Chart;
use super::drawing::{Drawing, Shape, Step};
use super::marks::Look;
use crate::canvas::{Style, wrap};
use crate::palette;

/// Font size (px).
const SIZE: f64 = 14.0;
/// Font size of explanations (px).
const SMALL: f64 = 12.5;
/// Distance between two lines of a row (px).
const LINE: f64 = 18.0;
/// Space between two rows (px).
const BETWEEN: f64 = 9.0;
/// Width of the symbol at the left (px).
const SIGN: f64 = 38.0;

/// A row of the legend: a curve, or the explanation of a symbol.
struct Row {
    sign: Sign,
    lines: Vec<String>,
}

enum Sign {
    Curve(usize),
    Hollow,
    Bar,
}

/// The legend of a chart.
pub(super) struct Legend {
    rows: Vec<Row>,
    marks: bool,
}

impl Legend {
    /// Creates the rows for a chart, in lines of at most this width (px).
    pub(super) fn of(chart: &Chart, width: f64) -> Self {
        let lines = |text: &str, size: f64| wrap(text, size, width - SIGN);
        let mut rows: Vec<Row> = chart
            .series
            .iter()
            .enumerate()
            .map(|(index, series)| Row {
                sign: Sign::Curve(index),
                lines: lines(&series.name, SIZE),
            })
            .collect();
        let has_bar = chart
            .series
            .iter()
            .flat_map(|s| &s.points)
            .any(|p| p.interval.is_some());
        if has_bar {
            rows.push(Row {
                sign: Sign::Bar,
                lines: lines(
                    match chart.interval.as_str() {
                        "" => "95 % interval",
                        interval => interval,
                    },
                    SMALL,
                ),
            });
        }
        if chart.has_reference() {
            rows.push(Row {
                sign: Sign::Hollow,
                lines: lines(&chart.reference, SMALL),
            });
        }
        Self {
            rows,
            marks: !chart.lines_only,
        }
    }

    /// Returns the height of all rows (px).
    pub(super) fn height(&self) -> f64 {
        self.rows.iter().map(Row::height).sum()
    }

    /// Draws the legend with its upper left corner at this point (px).
    pub(super) fn draw(&self, drawing: &mut Drawing, left: f64, top: f64) {
        let mut y = top;
        for row in &self.rows {
            let middle = y + LINE / 2.0;
            let at = [left + 14.0, middle];
            let (size, color) = match row.sign {
                Sign::Curve(index) => {
                    let look = Look::of(index);
                    drawing.shape(&Shape {
                        outline: vec![Step::Move(left, middle), Step::Line(left + 28.0, middle)],
                        line: Some((look.color, 2.0)),
                        dash: look.dash,
                        ..Shape::default()
                    });
                    if self.marks {
                        look.mark(drawing, at, false, String::new());
                    }
                    (SIZE, palette::INK)
                }
                Sign::Hollow => {
                    for (index, x) in [left + 4.0, left + 15.0, left + 26.0]
                        .into_iter()
                        .enumerate()
                    {
                        Look::of(index).mark(drawing, [x, middle], true, String::new());
                    }
                    (SMALL, palette::FAINT_INK)
                }
                Sign::Bar => {
                    let (x, up, down) = (at[0], middle - 8.0, middle + 8.0);
                    for (from, to) in [
                        ([x, up], [x, down]),
                        ([x - 3.0, up], [x + 3.0, up]),
                        ([x - 3.0, down], [x + 3.0, down]),
                    ] {
                        drawing.line(from, to, palette::FAINT_INK, 1.5);
                    }
                    (SMALL, palette::FAINT_INK)
                }
            };
            let style = Style {
                size,
                color,
                bold: false,
                anchor: "start",
                halo: false,
            };
            for (i, line) in row.lines.iter().enumerate() {
                drawing.text(left + SIGN, middle + 5.0 + i as f64 * LINE, style, line);
            }
            y += row.height();
        }
    }
}

impl Row {
    fn height(&self) -> f64 {
        self.lines.len().max(1) as f64 * LINE + BETWEEN
    }
}
