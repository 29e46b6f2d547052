//! Shapes and texts on a page, as SVG.

use crate::canvas::{Canvas, Num, Style, escape};

/// A page with shapes and texts; all coordinates are in pixels, y down.
pub struct Drawing {
    /// Width of the page (px).
    pub(super) width: f64,
    /// Height of the page (px).
    pub(super) height: f64,
    canvas: Canvas,
}

/// An outline, filled, stroked or both.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Shape {
    pub(super) outline: Vec<Step>,
    /// Fill colour, `#rrggbb`.
    pub(super) fill: Option<&'static str>,
    /// Colour and width (px) of the stroke.
    pub(super) line: Option<(&'static str, f64)>,
    /// Lengths of dashes and gaps (px); empty for a solid line.
    pub(super) dash: &'static [f32],
    /// Opacity, 0 to 1; 0 counts as 1.
    pub(super) opacity: f64,
    /// Tooltip.
    pub(super) hint: String,
}

/// A segment of an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step {
    Move(f64, f64),
    Line(f64, f64),
    /// A full circle: centre and radius.
    Circle(f64, f64, f64),
    Close,
}

impl Drawing {
    /// Creates an empty page of this size (px), with title and description for screen readers.
    pub(super) fn new(width: f64, height: f64, title: &str, description: &str) -> Self {
        Self {
            width,
            height,
            canvas: Canvas::new(width, height, title, description),
        }
    }

    /// Begins a group, which [`end`](Self::end) closes.
    pub(super) fn begin(&mut self, name: &str) {
        self.canvas
            .add(format_args!("<g><title>{}</title>\n", escape(name)));
    }

    /// Ends the group that [`begin`](Self::begin) began.
    pub(super) fn end(&mut self) {
        self.canvas.add(format_args!("</g>\n"));
    }

    /// Draws a shape.
    pub(super) fn shape(&mut self, shape: &Shape) {
        shape.svg(&mut self.canvas);
    }

    /// Draws a straight line.
    pub(super) fn line(&mut self, from: [f64; 2], to: [f64; 2], color: &'static str, width: f64) {
        self.shape(&Shape {
            outline: vec![Step::Move(from[0], from[1]), Step::Line(to[0], to[1])],
            line: Some((color, width)),
            ..Shape::default()
        });
    }

    /// Writes a line of text with its baseline at this point.
    pub(super) fn text(&mut self, x: f64, y: f64, style: Style, text: &str) {
        self.canvas.label(x, y, &style, text);
    }

    /// Writes a line of text, rotated to read upwards.
    pub(super) fn upright(&mut self, x: f64, y: f64, style: Style, text: &str) {
        self.canvas.add(format_args!(
            "<g transform=\"translate({} {}) rotate(-90)\">",
            Num(x),
            Num(y)
        ));
        self.canvas.label(0.0, 0.0, &style, text);
        self.canvas.add(format_args!("</g>\n"));
    }

    /// Returns the drawing as an SVG document.
    pub fn svg(self) -> String {
        self.canvas.finish()
    }
}

impl Shape {
    fn svg(&self, canvas: &mut Canvas) {
        canvas.add(format_args!("<path d=\""));
        for step in &self.outline {
            match *step {
                Step::Move(x, y) => canvas.add(format_args!("M{} {}", Num(x), Num(y))),
                Step::Line(x, y) => canvas.add(format_args!("L{} {}", Num(x), Num(y))),
                Step::Circle(x, y, r) => canvas.add(format_args!(
                    "M{left} {y}A{r} {r} 0 1 0 {right} {y}A{r} {r} 0 1 0 {left} {y}Z",
                    left = Num(x - r),
                    right = Num(x + r),
                    y = Num(y),
                    r = Num(r),
                )),
                Step::Close => canvas.add(format_args!("Z")),
            }
        }
        canvas.add(format_args!("\" fill=\"{}\"", self.fill.unwrap_or("none")));
        if let Some((color, width)) = self.line {
            canvas.add(format_args!(
                " stroke=\"{color}\" stroke-width=\"{}\" stroke-linejoin=\"round\"",
                Num(width)
            ));
        }
        if let [first, rest @ ..] = self.dash {
            canvas.add(format_args!(" stroke-dasharray=\"{first}"));
            for length in rest {
                canvas.add(format_args!(" {length}"));
            }
            canvas.add(format_args!("\""));
        }
        if self.opacity > 0.0 {
            canvas.add(format_args!(
                " opacity=\"{}\"",
                (self.opacity * 100.0).round() / 100.0
            ));
        }
        if self.hint.is_empty() {
            canvas.add(format_args!("/>\n"));
        } else {
            canvas.add(format_args!(
                "><title>{}</title></path>\n",
                escape(&self.hint)
            ));
        }
    }
}
