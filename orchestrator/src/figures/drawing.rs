//! A drawing: lines, areas and texts on a page, to be written as SVG or PNG.

use crate::picture::canvas::{Canvas, Num, Style, escape};

/// Lines, areas and texts on a page; all coordinates are in pixels, y down.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Width of the page [px].
    pub(super) width: f64,
    /// Height of the page [px].
    pub(super) height: f64,
    title: String,
    description: String,
    pub(super) items: Vec<Item>,
}

/// Something drawn.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Item {
    /// A group with a name begins.
    Begin(String),
    /// The group that began last ends.
    End,
    /// Lines and areas.
    Shape(Shape),
    /// A line of text, its base line at this point, turned by −90° if upright.
    Text {
        x: f64,
        y: f64,
        style: Style,
        upright: bool,
        text: String,
    },
}

/// An outline, filled or drawn or both.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Shape {
    pub(super) outline: Vec<Step>,
    /// Colour inside, `#rrggbb`.
    pub(super) fill: Option<&'static str>,
    /// Colour and width [px] of the line.
    pub(super) line: Option<(&'static str, f64)>,
    /// Lengths of dashes and gaps [px]; empty for a whole line.
    pub(super) dash: &'static [f32],
    /// 0 for invisible to 1; 0 counts as 1.
    pub(super) opacity: f64,
    /// Text shown for it when pointed at.
    pub(super) hint: String,
}

/// A piece of an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step {
    Move(f64, f64),
    Line(f64, f64),
    /// A whole circle by its centre and radius.
    Circle(f64, f64, f64),
    Close,
}

impl Drawing {
    /// An empty page of this size [px], with words for those who cannot see it.
    pub(super) fn new(width: f64, height: f64, title: &str, description: &str) -> Self {
        Self {
            width,
            height,
            title: title.to_owned(),
            description: description.to_owned(),
            items: Vec::new(),
        }
    }

    /// Everything drawn until [`end`](Self::end) belongs together.
    pub(super) fn begin(&mut self, name: &str) {
        self.items.push(Item::Begin(name.to_owned()));
    }

    /// Ends what [`begin`](Self::begin) began.
    pub(super) fn end(&mut self) {
        self.items.push(Item::End);
    }

    /// Draws a shape.
    pub(super) fn shape(&mut self, shape: Shape) {
        self.items.push(Item::Shape(shape));
    }

    /// Draws a straight line.
    pub(super) fn line(&mut self, from: [f64; 2], to: [f64; 2], color: &'static str, width: f64) {
        self.shape(Shape {
            outline: vec![Step::Move(from[0], from[1]), Step::Line(to[0], to[1])],
            line: Some((color, width)),
            ..Shape::default()
        });
    }

    /// Writes a line of text with its base line at this point.
    pub(super) fn text(&mut self, x: f64, y: f64, style: Style, text: &str) {
        self.items.push(Item::Text {
            x,
            y,
            style,
            upright: false,
            text: text.to_owned(),
        });
    }

    /// Writes a line of text upwards.
    pub(super) fn upright(&mut self, x: f64, y: f64, style: Style, text: &str) {
        self.items.push(Item::Text {
            x,
            y,
            style,
            upright: true,
            text: text.to_owned(),
        });
    }

    /// The drawing as an SVG document.
    pub fn svg(&self) -> String {
        let mut canvas = Canvas::new(self.width, self.height, &self.title, &self.description);
        for item in &self.items {
            match item {
                Item::Begin(name) => {
                    canvas.add(format_args!("<g><title>{}</title>\n", escape(name)));
                }
                Item::End => canvas.add(format_args!("</g>\n")),
                Item::Shape(shape) => shape.svg(&mut canvas),
                Item::Text {
                    x,
                    y,
                    style,
                    upright: false,
                    text,
                } => canvas.label(*x, *y, style, text),
                Item::Text {
                    x, y, style, text, ..
                } => {
                    canvas.add(format_args!(
                        "<g transform=\"translate({} {}) rotate(-90)\">",
                        Num(*x),
                        Num(*y)
                    ));
                    canvas.label(0.0, 0.0, style, text);
                    canvas.add(format_args!("</g>\n"));
                }
            }
        }
        canvas.finish()
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
