//! Curves of a chart.

use super::axes::Axes;
use super::chart::{Chart, Point, Series, Unit, number};
use super::drawing::{Drawing, Shape, Step};
use super::marks::{Look, MARK};

/// Maximum distance between the marks of two curves at the same value (px).
const APART: f64 = 5.0;

/// Draws all curves, marks on top.
pub(super) fn draw(chart: &Chart, axes: &Axes, drawing: &mut Drawing) {
    let count = chart.series.len();
    // Marks of different curves at the same value stand side by side, if the spacing allows.
    let room = axes.spacing() * 0.6 / count.max(1) as f64;
    let apart = APART.min(room);
    let curves: Vec<Curve> = chart
        .series
        .iter()
        .enumerate()
        .map(|(index, series)| Curve {
            look: Look::of(index),
            shift: if chart.lines_only {
                0.0
            } else {
                (index as f64 - (count as f64 - 1.0) / 2.0) * apart
            },
            chart,
            axes,
            points: drawable(&series.points, chart),
            series,
        })
        .collect();
    for curve in &curves {
        curve.band(drawing);
    }
    for curve in &curves {
        drawing.begin(&curve.series.name);
        curve.line(drawing);
        if !chart.lines_only {
            curve.marks(drawing);
        }
        drawing.end();
    }
}

fn drawable(points: &[Point], chart: &Chart) -> Vec<Point> {
    let points = points.iter().copied();
    let mut points: Vec<Point> = points.filter(|p| p.can_be_drawn(chart)).collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    points
}

/// One curve and its offset.
struct Curve<'a> {
    chart: &'a Chart,
    series: &'a Series,
    axes: &'a Axes,
    look: Look,
    /// Horizontal offset (px).
    shift: f64,
    points: Vec<Point>,
}

impl Curve<'_> {
    fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let [px, py] = self.axes.place(x, y);
        [px + self.shift, py]
    }

    /// Returns `true` if the points are joined; categories have no order and are not.
    fn joined(&self) -> bool {
        self.chart.x_names.is_empty()
    }

    fn band(&self, drawing: &mut Drawing) {
        let ends: Vec<_> = self
            .points
            .iter()
            .filter_map(|p| Some((p.x, p.interval?)))
            .collect();
        if ends.len() < 2 || !self.joined() {
            return;
        }
        let upper = ends.iter().map(|(x, (_, high))| self.place(*x, *high));
        let lower = ends.iter().rev().map(|(x, (low, _))| self.place(*x, *low));
        let mut outline = path(upper.chain(lower));
        outline.push(Step::Close);
        drawing.shape(&Shape {
            outline,
            fill: Some(self.look.color),
            opacity: 0.10,
            ..Shape::default()
        });
    }

    fn line(&self, drawing: &mut Drawing) {
        if self.points.len() < 2 || !self.joined() {
            return;
        }
        drawing.shape(&Shape {
            outline: path(self.points.iter().map(|p| self.place(p.x, p.y))),
            line: Some((self.look.color, 2.0)),
            dash: self.look.dash,
            ..Shape::default()
        });
    }

    fn marks(&self, drawing: &mut Drawing) {
        for point in &self.points {
            if let Some((low, high)) = point.interval {
                self.bar(drawing, point.x, low, high);
            }
        }
        // Reference points are drawn above the bars and below the marks.
        for point in drawable(&self.series.reference, self.chart) {
            if let Some((low, high)) = point.interval {
                let (top, bottom) = (self.place(point.x, high), self.place(point.x, low));
                drawing.shape(&Shape {
                    outline: path([bottom, top].into_iter()),
                    line: Some((self.look.color, 1.0)),
                    dash: &[2.0, 3.0],
                    ..Shape::default()
                });
            }
            let hint = self.hint(&point, &self.chart.reference);
            self.look
                .mark(drawing, self.place(point.x, point.y), true, hint);
        }
        for point in &self.points {
            let hint = self.hint(point, &self.series.name);
            self.look
                .mark(drawing, self.place(point.x, point.y), false, hint);
        }
    }

    fn bar(&self, drawing: &mut Drawing, x: f64, low: f64, high: f64) {
        let ([x, bottom], [_, top]) = (self.place(x, low), self.place(x, high));
        let cap = MARK * 0.6;
        drawing.shape(&Shape {
            outline: vec![
                Step::Move(x, bottom),
                Step::Line(x, top),
                Step::Move(x - cap, bottom),
                Step::Line(x + cap, bottom),
                Step::Move(x - cap, top),
                Step::Line(x + cap, top),
            ],
            line: Some((self.look.color, 1.5)),
            ..Shape::default()
        });
    }

    /// Returns the tooltip of a point: `RRT*, 1.5: 63.0 % (58.1 % … 67.6 %)`.
    fn hint(&self, point: &Point, name: &str) -> String {
        let x = match self.chart.x_names.get(point.x.max(0.0) as usize) {
            Some(name) => name.clone(),
            None => number(point.x),
        };
        let unit: Unit = self.chart.unit;
        let mut text = format!("{name}, {x}: {}", unit.text(point.y));
        if let Some((low, high)) = point.interval {
            text += &format!(" ({} … {})", unit.text(low), unit.text(high));
        }
        text
    }
}

fn path(points: impl Iterator<Item = [f64; 2]>) -> Vec<Step> {
    let step = |(i, [x, y]): (usize, [f64; 2])| {
        if i == 0 {
            Step::Move(x, y)
        } else {
            Step::Line(x, y)
        }
    };
    points.enumerate().map(step).collect()
}
