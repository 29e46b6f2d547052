//! A drawing as pixels.

use tiny_skia::{
    Color, FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform,
};

use super::drawing::{Drawing, Item, Shape, Step};
use super::font::Font;
use crate::picture::canvas::Style;
use crate::picture::palette;

/// Largest width and height of a picture [pixels].
const LARGEST: f64 = 20_000.0;
/// Width of the rim around a text with a halo [px].
const HALO: f32 = 3.5;

/// Why a drawing could not be made a PNG picture.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// The picture would be too large or have no size.
    #[error("a picture of {width:.0} × {height:.0} pixels: expected 1 to 20000 in both directions")]
    Size {
        /// Width [pixels].
        width: f64,
        /// Height [pixels].
        height: f64,
    },
    /// The font that comes with the program is damaged.
    #[error("the font that is built in cannot be read")]
    Font,
    /// The picture could not be packed.
    #[error("cannot write PNG: {reason}")]
    Encode {
        /// What the encoder said.
        reason: String,
    },
}

impl Drawing {
    /// The drawing as a PNG picture, with so many pixels for one of the page.
    ///
    /// Letters are those of the font that is built in; the same drawing gives the same bytes.
    ///
    /// # Errors
    /// [`PngError`].
    pub fn png(&self, zoom: f64) -> Result<Vec<u8>, PngError> {
        let (width, height) = ((self.width * zoom).round(), (self.height * zoom).round());
        let size = || PngError::Size { width, height };
        if !((1.0..=LARGEST).contains(&width) && (1.0..=LARGEST).contains(&height)) {
            return Err(size());
        }
        let mut page = Page {
            pixels: Pixmap::new(width as u32, height as u32).ok_or_else(size)?,
            zoom: Transform::from_scale(zoom as f32, zoom as f32),
            regular: Font::new(false).ok_or(PngError::Font)?,
            bold: Font::new(true).ok_or(PngError::Font)?,
        };
        page.pixels.fill(color(palette::PAPER, 1.0));
        for item in &self.items {
            match item {
                Item::Begin(_) | Item::End => {}
                Item::Shape(shape) => page.shape(shape),
                Item::Text {
                    x,
                    y,
                    style,
                    upright,
                    text,
                } => page.text([*x as f32, *y as f32], style, *upright, text),
            }
        }
        page.pixels.encode_png().map_err(|e| PngError::Encode {
            reason: e.to_string(),
        })
    }
}

struct Page {
    pixels: Pixmap,
    zoom: Transform,
    regular: Font,
    bold: Font,
}

impl Page {
    fn shape(&mut self, shape: &Shape) {
        let Some(path) = path(shape) else {
            return;
        };
        let opacity = if shape.opacity > 0.0 {
            shape.opacity
        } else {
            1.0
        };
        if let Some(fill) = shape.fill {
            self.fill(&path, color(fill, opacity), self.zoom);
        }
        if let Some((line, width)) = shape.line {
            let stroke = Stroke {
                width: width as f32,
                line_join: LineJoin::Round,
                dash: StrokeDash::new(shape.dash.to_vec(), 0.0),
                ..Stroke::default()
            };
            self.stroke(&path, color(line, opacity), &stroke, self.zoom);
        }
    }

    fn text(&mut self, at: [f32; 2], style: &Style, upright: bool, text: &str) {
        let font = if style.bold {
            &self.bold
        } else {
            &self.regular
        };
        let size = style.size as f32;
        let shift = match style.anchor {
            "end" => -font.width(text, size),
            "middle" => -font.width(text, size) / 2.0,
            _ => 0.0,
        };
        let mut builder = PathBuilder::new();
        font.outline(&mut builder, text, size, [shift, 0.0]);
        let Some(path) = builder.finish() else {
            return;
        };
        let mut place = self.zoom.pre_translate(at[0], at[1]);
        if upright {
            // x along the page's −y: the matrix of −90°, exactly.
            place = place.pre_concat(Transform::from_row(0.0, -1.0, 1.0, 0.0, 0.0, 0.0));
        }
        if style.halo {
            let stroke = Stroke {
                width: HALO,
                line_join: LineJoin::Round,
                ..Stroke::default()
            };
            self.stroke(&path, color(palette::PAPER, 1.0), &stroke, place);
        }
        self.fill(&path, color(style.color, 1.0), place);
    }

    fn fill(&mut self, path: &Path, color: Color, place: Transform) {
        let paint = paint(color);
        self.pixels
            .fill_path(path, &paint, FillRule::Winding, place, None);
    }

    fn stroke(&mut self, path: &Path, color: Color, stroke: &Stroke, place: Transform) {
        self.pixels
            .stroke_path(path, &paint(color), stroke, place, None);
    }
}

fn paint(color: Color) -> Paint<'static> {
    let mut paint = Paint {
        anti_alias: true,
        ..Paint::default()
    };
    paint.set_color(color);
    paint
}

fn path(shape: &Shape) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for step in &shape.outline {
        match *step {
            Step::Move(x, y) => builder.move_to(x as f32, y as f32),
            Step::Line(x, y) => builder.line_to(x as f32, y as f32),
            Step::Circle(x, y, r) => builder.push_circle(x as f32, y as f32, r as f32),
            Step::Close => builder.close(),
        }
    }
    builder.finish()
}

/// A colour written `#rrggbb`; ink for anything else.
fn color(text: &str, opacity: f64) -> Color {
    let part = |at: usize| {
        let hex = text.strip_prefix('#').and_then(|hex| hex.get(at..at + 2));
        hex.and_then(|hex| u8::from_str_radix(hex, 16).ok())
            .unwrap_or(0)
    };
    let alpha = (opacity.clamp(0.0, 1.0) * 255.0).round() as u8;
    Color::from_rgba8(part(0), part(2), part(4), alpha)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_read() {
        assert_eq!(color("#0072b2", 1.0), Color::from_rgba8(0, 0x72, 0xb2, 255));
        assert_eq!(color("ink", 0.5), Color::from_rgba8(0, 0, 0, 128));
    }

    #[test]
    fn pixels_are_where_they_were_drawn() {
        let mut drawing = Drawing::new(20.0, 10.0, "", "");
        drawing.shape(Shape {
            outline: vec![
                Step::Move(0.0, 0.0),
                Step::Line(10.0, 0.0),
                Step::Line(10.0, 10.0),
                Step::Line(0.0, 10.0),
                Step::Close,
            ],
            fill: Some("#d55e00"),
            ..Shape::default()
        });
        let png = drawing.png(2.0).unwrap();
        let pixels = Pixmap::decode_png(&png).unwrap();
        assert_eq!((pixels.width(), pixels.height()), (40, 20));
        let at = |x, y| {
            let p = pixels.pixel(x, y).unwrap();
            (p.red(), p.green(), p.blue(), p.alpha())
        };
        assert_eq!(at(5, 5), (0xd5, 0x5e, 0x00, 255));
        assert_eq!(at(35, 5), (255, 255, 255, 255), "paper");
        assert_eq!(drawing.png(2.0).unwrap(), png, "the same bytes again");
    }

    #[test]
    fn texts_lie_and_stand() {
        let style = Style {
            size: 20.0,
            color: "#000000",
            bold: true,
            anchor: "middle",
            halo: true,
        };
        // Ink in the columns and rows of a page of 100 × 100.
        let extent = |upright: bool| {
            let mut drawing = Drawing::new(100.0, 100.0, "", "");
            if upright {
                drawing.upright(50.0, 50.0, style, "MMMM");
            } else {
                drawing.text(50.0, 50.0, style, "MMMM");
            }
            let pixels = Pixmap::decode_png(&drawing.png(1.0).unwrap()).unwrap();
            let dark = |x, y| pixels.pixel(x, y).unwrap().red() < 100;
            let columns = (0..100).filter(|&x| (0..100).any(|y| dark(x, y))).count();
            let rows = (0..100).filter(|&y| (0..100).any(|x| dark(x, y))).count();
            (columns, rows)
        };
        let (lying, standing) = (extent(false), extent(true));
        assert!(lying.0 > 60 && (10..20).contains(&lying.1), "{lying:?}");
        assert!(
            standing.1 > 60 && (10..20).contains(&standing.0),
            "{standing:?}"
        );
    }

    #[test]
    fn senseless_sizes_are_refused() {
        let drawing = Drawing::new(100.0, 100.0, "", "");
        for zoom in [0.0, -1.0, f64::NAN, 1e6] {
            assert!(
                matches!(drawing.png(zoom), Err(PngError::Size { .. })),
                "{zoom}"
            );
        }
    }
}
