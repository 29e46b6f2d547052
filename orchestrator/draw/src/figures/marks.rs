//! Colours, marks and dashes that distinguish curves, also in print and with colour-vision deficiency.

use super::drawing::{Drawing, Shape, Step};
use crate::palette;

/// Okabe and Ito's palette without yellow, which has too little contrast on white.
const COLORS: [&str; 6] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9",
];
/// Dash patterns, one for each cycle through the colours.
const DASHES: [&[f32]; 4] = [&[], &[7.0, 4.0], &[2.0, 3.0], &[9.0, 3.0, 2.0, 3.0]];

/// Style of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Look {
    pub(super) color: &'static str,
    pub(super) dash: &'static [f32],
    mark: usize,
}

/// Half width of a mark (px).
pub(super) const MARK: f64 = 5.0;

impl Look {
    /// Returns the style of the curve with this index.
    pub(super) fn of(index: usize) -> Self {
        Self {
            color: COLORS
                .get(index % COLORS.len())
                .copied()
                .unwrap_or(palette::INK),
            dash: DASHES
                .get(index / COLORS.len() % DASHES.len())
                .copied()
                .unwrap_or_default(),
            // Seven marks and six colours: a pair repeats after 42 curves.
            mark: index % 7,
        }
    }

    /// Draws the mark of the curve, with a tooltip.
    pub(super) fn mark(&self, drawing: &mut Drawing, at: [f64; 2], hollow: bool, hint: String) {
        // Larger, so that it is visible around a filled mark at the same point.
        let size = if hollow { MARK * 1.3 } else { MARK };
        let corners = |corners: &[(f64, f64)]| {
            let mut outline: Vec<Step> = Vec::new();
            for (i, (dx, dy)) in corners.iter().enumerate() {
                let (x, y) = (at[0] + dx * size, at[1] + dy * size);
                outline.push(if i == 0 {
                    Step::Move(x, y)
                } else {
                    Step::Line(x, y)
                });
            }
            outline.push(Step::Close);
            outline
        };
        let outline = match self.mark {
            0 => vec![Step::Circle(at[0], at[1], size)],
            1 => corners(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]),
            2 => corners(&[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)]),
            3 => corners(&[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)]),
            4 => corners(&[(0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)]),
            5 => corners(&[(1.2, 0.0), (-0.8, 1.1), (-0.8, -1.1)]),
            _ => corners(&[(-1.2, 0.0), (0.8, 1.1), (0.8, -1.1)]),
        };
        let (fill, line) = if hollow {
            (palette::PAPER, (self.color, 2.0))
        } else {
            // An outline in the background colour separates overlapping marks.
            (self.color, (palette::PAPER, 1.0))
        };
        drawing.shape(&Shape {
            outline,
            fill: Some(fill),
            line: Some(line),
            hint,
            ..Shape::default()
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_curves_have_different_styles() {
        let looks: Vec<Look> = (0..24).map(Look::of).collect();
        for (i, a) in looks.iter().enumerate() {
            assert!(looks.iter().skip(i + 1).all(|b| a != b), "{i}");
        }
        assert!(looks.iter().take(6).all(|l| l.dash.is_empty()));
    }
}
