//! The letters of PNG pictures: DejaVu Sans, of which the program has the Latin and Greek letters
//! and the signs of formulas with it, so that a picture looks the same wherever it is made.

use tiny_skia::PathBuilder;
use ttf_parser::{Face, OutlineBuilder};

/// DejaVu Sans 2.37, reduced; its licence is in `orchestrator/fonts/LICENSE`.
const REGULAR: &[u8] = include_bytes!("../../fonts/DejaVuSans.ttf");
/// The same in bold.
const BOLD: &[u8] = include_bytes!("../../fonts/DejaVuSans-Bold.ttf");

/// A font.
pub(super) struct Font {
    face: Face<'static>,
    /// Size of a unit of the font at a font size of 1 px [px].
    unit: f32,
}

impl Font {
    /// The font of ordinary or bold text; `None` if it cannot be read.
    pub(super) fn new(bold: bool) -> Option<Self> {
        let face = Face::parse(if bold { BOLD } else { REGULAR }, 0).ok()?;
        let unit = 1.0 / f32::from(face.units_per_em());
        Some(Self { face, unit })
    }

    /// Width of a text [px] at a font size [px].
    pub(super) fn width(&self, text: &str, size: f32) -> f32 {
        text.chars().map(|c| self.advance(c)).sum::<f32>() * self.unit * size
    }

    /// Adds the outlines of a text whose base line begins at this point [px].
    pub(super) fn outline(&self, path: &mut PathBuilder, text: &str, size: f32, at: [f32; 2]) {
        let scale = self.unit * size;
        let mut pen = Pen {
            path,
            scale,
            x: at[0],
            y: at[1],
        };
        for c in text.chars() {
            // A letter that the font has not leaves a box: its glyph 0.
            let glyph = self.face.glyph_index(c).unwrap_or_default();
            self.face.outline_glyph(glyph, &mut pen);
            pen.x += self.advance(c) * scale;
        }
    }

    fn advance(&self, c: char) -> f32 {
        let glyph = self.face.glyph_index(c).unwrap_or_default();
        self.face.glyph_hor_advance(glyph).map_or(0.0, f32::from)
    }
}

/// Draws glyphs, which have y up, where the next letter stands.
struct Pen<'a> {
    path: &'a mut PathBuilder,
    scale: f32,
    x: f32,
    y: f32,
}

impl Pen<'_> {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + x * self.scale, self.y - y * self.scale)
    }
}

impl OutlineBuilder for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_letter_that_charts_use_is_there() {
        for bold in [false, true] {
            let font = Font::new(bold).unwrap();
            let text = "AZaz09 %.,:;()[]/+-*=<>äöüßéñ×±°·–—…“”‘’µ";
            for c in text.chars() {
                assert!(font.face.glyph_index(c).is_some(), "{c:?} bold: {bold}");
            }
        }
        let font = Font::new(false).unwrap();
        for c in "αβγσωΔ≤≥≈−→∞½√Σ".chars() {
            assert!(font.face.glyph_index(c).is_some(), "{c:?}");
        }
    }

    #[test]
    fn texts_have_the_width_of_their_letters() {
        let font = Font::new(false).unwrap();
        assert_eq!(font.width("", 14.0), 0.0);
        let (one, two) = (font.width("m", 10.0), font.width("mm", 20.0));
        assert!((two - 4.0 * one).abs() < 1e-3 && one > 5.0, "{one} {two}");
        assert!(font.width("i", 10.0) < one);
        // A letter that is not there takes the room of its box.
        assert!(font.width("\u{10ffff}", 10.0) > 0.0);
    }
}
