//! Stacked bars.

use super::drawing::{Drawing, Shape, Step};
use super::marks::Look;
use super::ticks::Ticks;
use crate::canvas::{Style, text_width};
use crate::palette;

const WIDTH: f64 = 860.0;
const MARGIN: f64 = 22.0;
const BAR: f64 = 34.0;
const BETWEEN: f64 = 14.0;
const TEXT: f64 = 13.0;
const TITLE: f64 = 19.0;
const ROW: f64 = 21.0;

/// Horizontal stacked bars with the same parts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stack {
    /// Heading.
    pub title: String,
    /// Subtitle.
    pub subtitle: String,
    /// Label of the axis, with its unit.
    pub label: String,
    /// Names of the parts.
    pub parts: Vec<String>,
    /// The bars.
    pub bars: Vec<Bar>,
}

/// One bar.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bar {
    /// Name.
    pub name: String,
    /// Lengths of its parts; values that are not finite and positive are left out.
    pub parts: Vec<f64>,
}

impl Stack {
    /// Draws the bars on a page.
    pub fn draw(&self) -> Drawing {
        let style = Style {
            size: TEXT,
            color: palette::INK,
            bold: false,
            anchor: "start",
            halo: false,
        };
        let per_row = 3;
        let rows = self.parts.len().div_ceil(per_row) as f64;
        let names = self.bars.iter().map(|bar| text_width(&bar.name, TEXT));
        let left = MARGIN + names.fold(0.0, f64::max) + 10.0;
        let right = WIDTH - MARGIN - 16.0;
        let legend = MARGIN + TITLE + 26.0;
        let top = legend + rows * ROW + 6.0;
        let bottom = top + self.bars.len() as f64 * (BAR + BETWEEN) + 2.0;
        let mut drawing = Drawing::new(WIDTH, bottom + 62.0, &self.title, &self.subtitle);
        let bold = Style {
            size: TITLE,
            bold: true,
            ..style
        };
        drawing.text(MARGIN, MARGIN + TITLE - 6.0, bold, &self.title);
        let faint = Style {
            color: palette::FAINT_INK,
            ..style
        };
        drawing.text(MARGIN, MARGIN + TITLE + 13.0, faint, &self.subtitle);
        for (index, part) in self.parts.iter().enumerate() {
            let column = (WIDTH - 2.0 * MARGIN) / per_row as f64;
            let x = MARGIN + (index % per_row) as f64 * column;
            let y = legend + (index / per_row) as f64 * ROW;
            rectangle(
                &mut drawing,
                [x, y, x + 14.0, y + 14.0],
                index,
                String::new(),
            );
            drawing.text(x + 20.0, y + 12.0, style, part);
        }
        let most = self.bars.iter().map(Bar::length).fold(0.0, f64::max);
        let ticks = Ticks::over(0.0, if most > 0.0 { most } else { 1.0 }, 6.0);
        let place =
            |value: f64| left + (value - ticks.low) / (ticks.high - ticks.low) * (right - left);
        let middle = Style {
            anchor: "middle",
            ..style
        };
        for &value in &ticks.values {
            let x = place(value);
            drawing.line([x, top], [x, bottom], "#e3e6ea", 1.0);
            drawing.text(x, bottom + 18.0, middle, &super::chart::number(value));
        }
        drawing.text(
            f64::midpoint(left, right),
            bottom + 42.0,
            middle,
            &self.label,
        );
        let end = Style {
            anchor: "end",
            ..style
        };
        for (row, bar) in self.bars.iter().enumerate() {
            let y = top + row as f64 * (BAR + BETWEEN) + BETWEEN / 2.0;
            drawing.text(left - 8.0, y + BAR / 2.0 + 4.5, end, &bar.name);
            let mut from = 0.0;
            for (index, length) in bar.parts.iter().enumerate() {
                if !is_drawn(*length) {
                    continue;
                }
                let hint = match self.parts.get(index) {
                    Some(part) => format!("{part}: {}", super::chart::number(*length)),
                    None => String::new(),
                };
                let sides = [place(from), y, place(from + length), y + BAR];
                rectangle(&mut drawing, sides, index, hint);
                from += length;
            }
        }
        drawing
    }
}

impl Bar {
    fn length(&self) -> f64 {
        self.parts.iter().copied().filter(|v| is_drawn(*v)).sum()
    }
}

fn is_drawn(length: f64) -> bool {
    length.is_finite() && length > 0.0
}

/// Draws a part; `sides` are left, top, right and bottom (px).
fn rectangle(drawing: &mut Drawing, sides: [f64; 4], index: usize, hint: String) {
    let [left, top, right, bottom] = sides;
    drawing.shape(&Shape {
        outline: vec![
            Step::Move(left, top),
            Step::Line(right, top),
            Step::Line(right, bottom),
            Step::Line(left, bottom),
            Step::Close,
        ],
        fill: Some(Look::of(index).color),
        line: Some((palette::PAPER, 0.75)),
        // The second cycle through the colours is paler.
        opacity: if index < 6 { 1.0 } else { 0.45 },
        hint,
        ..Shape::default()
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_valid_part_is_drawn() {
        let stack = Stack {
            title: "a < b".into(),
            parts: vec!["one".into(), "two".into(), "three".into()],
            bars: vec![Bar {
                name: "bar".into(),
                parts: vec![1.0, f64::NAN, 3.0],
            }],
            ..Stack::default()
        };
        let svg = stack.draw().svg();
        assert!(svg.contains("one: 1") && svg.contains("three: 3"), "{svg}");
        assert!(!svg.contains("two:") && !svg.contains("NaN") && !svg.contains("a < b"));
        let empty = Stack::default().draw().svg();
        assert!(empty.contains("</svg>") && !empty.contains("NaN"));
    }
}
