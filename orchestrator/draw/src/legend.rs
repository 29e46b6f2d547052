//! Legend: rows of a symbol and its explanation.

use crate::canvas::{Style, wrap};
use crate::palette;

/// Font size (px).
const SIZE: f64 = 14.0;
/// Font size of secondary text (px).
const SMALL: f64 = 12.5;
/// Distance between two lines of a row (px).
const LINE: f64 = 18.0;
/// Space between two rows (px).
const BETWEEN: f64 = 9.0;
/// Width of the symbol at the left (px).
const SIGN: f64 = 38.0;
/// Distance of the symbol's centre from the left edge (px).
const SIGN_CENTER: f64 = 14.0;

/// A legend with symbols of type `S`.
#[derive(Debug, Clone)]
pub struct Legend<S> {
    width: f64,
    rows: Vec<Row<S>>,
}

/// A symbol and lines of text.
#[derive(Debug, Clone)]
struct Row<S> {
    sign: S,
    lines: Vec<Line>,
}

/// A line of text.
#[derive(Debug, Clone)]
struct Line {
    text: String,
    is_secondary: bool,
}

/// A row with its position on the page.
#[derive(Debug, Clone)]
pub struct PlacedRow<'a, S> {
    /// The symbol.
    pub sign: &'a S,
    /// Centre of the symbol (px).
    pub center: [f64; 2],
    /// Left end of the baseline (px), style and text of every line.
    pub lines: Vec<([f64; 2], Style, &'a str)>,
}

impl<S> Legend<S> {
    /// Creates a legend of this width (px) without rows.
    pub fn new(width: f64) -> Self {
        Self {
            width,
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    pub fn row(&mut self, sign: S, text: &str) {
        let lines = Vec::new();
        self.rows.push(Row { sign, lines });
        self.lines(text, SIZE, false);
    }

    /// Adds secondary text to the last row.
    pub fn detail(&mut self, text: &str) {
        self.lines(text, SMALL, true);
    }

    fn lines(&mut self, text: &str, size: f64, is_secondary: bool) {
        let Some(row) = self.rows.last_mut() else {
            return;
        };
        let lines = wrap(text, size, self.width - SIGN).into_iter();
        row.lines
            .extend(lines.map(|text| Line { text, is_secondary }));
    }

    /// Returns the height of all rows (px).
    pub fn height(&self) -> f64 {
        self.rows.iter().map(Row::height).sum()
    }

    /// Returns the rows with the legend's upper left corner at this point (px).
    pub fn placed(&self, left: f64, top: f64) -> impl Iterator<Item = PlacedRow<'_, S>> {
        let mut y = top;
        self.rows.iter().map(move |row| {
            let middle = y + LINE / 2.0;
            y += row.height();
            let lines = row.lines.iter().enumerate();
            PlacedRow {
                sign: &row.sign,
                center: [left + SIGN_CENTER, middle],
                lines: lines
                    .map(|(i, line)| {
                        let at = [left + SIGN, middle + 5.0 + i as f64 * LINE];
                        (at, line.style(), line.text.as_str())
                    })
                    .collect(),
            }
        })
    }
}

impl<S> Row<S> {
    fn height(&self) -> f64 {
        self.lines.len().max(1) as f64 * LINE + BETWEEN
    }
}

impl Line {
    fn style(&self) -> Style {
        let (size, color) = if self.is_secondary {
            (SMALL, palette::FAINT_INK)
        } else {
            (SIZE, palette::INK)
        };
        Style {
            size,
            color,
            bold: false,
            anchor: "start",
            halo: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_follow_each_other_and_long_texts_break() {
        let mut legend = Legend::new(160.0);
        legend.row('a', "one");
        legend.detail("more");
        legend.row('b', "a text that needs several lines in a narrow legend");
        let rows: Vec<_> = legend.placed(10.0, 20.0).collect();
        assert_eq!(rows.len(), 2);
        let texts: Vec<&str> = rows[0].lines.iter().map(|(.., text)| *text).collect();
        assert_eq!((*rows[0].sign, texts), ('a', vec!["one", "more"]));
        assert!(rows[0].lines[0].1.size > rows[0].lines[1].1.size);
        assert!(rows[1].lines.len() > 2);
        let last = |row: &PlacedRow<'_, char>| row.lines.last().unwrap().0[1];
        assert!(last(&rows[0]) < rows[1].center[1]);
        assert!(last(&rows[1]) < 20.0 + legend.height());
    }
}
