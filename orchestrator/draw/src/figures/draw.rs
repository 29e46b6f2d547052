//! Layout of a chart on a page.

use super::axes::Axes;
use super::chart::Chart;
use super::drawing::{Drawing, Shape, Step};
use super::legend;
use super::series;
use crate::canvas::{Style, wrap};
use crate::palette;

/// Width of the page (px).
const WIDTH: f64 = 860.0;
/// Height of the frame of the axes (px).
const FRAME: f64 = 380.0;
/// Margin of the page (px).
const MARGIN: f64 = 22.0;
/// Width of the legend (px).
const LEGEND: f64 = 200.0;
/// Font size of the heading (px).
const TITLE: f64 = 19.0;
/// Font size of the subtitle (px).
const SUBTITLE: f64 = 13.5;

/// Draws a chart; the same chart gives the same drawing. The background is always white.
pub fn draw(chart: &Chart) -> Drawing {
    let subtitle = wrap(&chart.subtitle, SUBTITLE, WIDTH - 2.0 * MARGIN);
    let top = MARGIN + TITLE + 18.0 * subtitle.len() as f64 + 16.0;
    let legend = legend::of(chart, LEGEND);
    let bottom = top + FRAME.max(legend.height());
    let left = MARGIN + Axes::room(chart) + 26.0;
    let right = WIDTH - MARGIN - LEGEND - 16.0;
    let height = bottom + 44.0 + MARGIN;
    let mut drawing = Drawing::new(WIDTH, height, &chart.title, &chart.subtitle);
    paper(&mut drawing);
    heading(&mut drawing, &chart.title, &subtitle);
    let axes = Axes::new(chart, [left, top, right, bottom]);
    axes.draw(chart, &mut drawing);
    series::draw(chart, &axes, &mut drawing);
    let marks = !chart.lines_only;
    legend::draw(&legend, &mut drawing, [right + 16.0, top], marks);
    if chart.points().next().is_none() {
        let style = Style {
            size: TITLE,
            color: palette::FAINT_INK,
            bold: false,
            anchor: "middle",
            halo: false,
        };
        let at = (f64::midpoint(left, right), f64::midpoint(top, bottom));
        drawing.text(at.0, at.1, style, "no results");
    }
    drawing
}

fn paper(drawing: &mut Drawing) {
    let (w, h) = (drawing.width, drawing.height);
    drawing.shape(&Shape {
        outline: vec![
            Step::Move(0.0, 0.0),
            Step::Line(w, 0.0),
            Step::Line(w, h),
            Step::Line(0.0, h),
            Step::Close,
        ],
        fill: Some(palette::PAPER),
        ..Shape::default()
    });
}

fn heading(drawing: &mut Drawing, title: &str, subtitle: &[String]) {
    let style = Style {
        size: TITLE,
        color: palette::INK,
        bold: true,
        anchor: "start",
        halo: false,
    };
    drawing.text(MARGIN, MARGIN + TITLE - 4.0, style, title);
    let style = Style {
        size: SUBTITLE,
        color: palette::FAINT_INK,
        bold: false,
        ..style
    };
    for (i, line) in subtitle.iter().enumerate() {
        let y = MARGIN + TITLE + 18.0 * (i as f64 + 1.0);
        drawing.text(MARGIN, y, style, line);
    }
}
