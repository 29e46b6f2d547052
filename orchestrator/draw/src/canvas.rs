//! Writer of SVG documents.

use core::fmt::{self, Write as _};

/// Font family: at least one of these fonts exists on every system.
const FONTS: &str = "system-ui,-apple-system,'Segoe UI',Helvetica,Arial,'DejaVu Sans',sans-serif";

/// Mean width of a letter relative to the font size, in the widest of these fonts.
const LETTER: f64 = 0.58;
/// The same for bold text.
const BOLD_LETTER: f64 = 0.66;

/// An SVG document being written; all coordinates are in pixels, y down.
pub struct Canvas {
    text: String,
}

/// Style of a text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// Font size (px).
    pub size: f64,
    /// Colour.
    pub color: &'static str,
    /// `true` for bold text.
    pub bold: bool,
    /// Text anchor: `start`, `middle` or `end`.
    pub anchor: &'static str,
    /// `true` for an outline in the background colour, which keeps the text legible on any background.
    pub halo: bool,
}

impl Canvas {
    /// Creates a document of this size (px), with title and description for screen readers.
    pub fn new(width: f64, height: f64, title: &str, description: &str) -> Self {
        let mut canvas = Self {
            text: String::new(),
        };
        let (w, h) = (Num(width), Num(height));
        canvas.add(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" \
             viewBox=\"0 0 {w} {h}\" role=\"img\" font-family=\"{FONTS}\">\n\
             <title>{}</title>\n<desc>{}</desc>\n",
            escape(title),
            escape(description),
        ));
        canvas
    }

    /// Appends SVG markup without escaping.
    pub fn add(&mut self, text: fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = self.text.write_fmt(text);
    }

    /// Writes a line of text with its baseline at this point (px).
    pub fn label(&mut self, x: f64, y: f64, style: &Style, text: &str) {
        if style.halo {
            // A second text below the first: not every program knows `paint-order`.
            let outline = " stroke=\"#ffffff\" stroke-width=\"3.5\" stroke-linejoin=\"round\" \
                           class=\"halo\" aria-hidden=\"true\"";
            self.text_element(x, y, style, outline, text);
        }
        self.text_element(x, y, style, "", text);
    }

    /// Writes a `text` element with these further attributes.
    fn text_element(&mut self, x: f64, y: f64, style: &Style, attributes: &str, text: &str) {
        let weight = if style.bold {
            " font-weight=\"600\""
        } else {
            ""
        };
        self.add(format_args!(
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\" \
             text-anchor=\"{}\"{weight}{attributes}>{}</text>\n",
            Num(x),
            Num(y),
            Num(style.size),
            style.color,
            style.anchor,
            escape(text)
        ));
    }

    /// Ends the document and returns it.
    pub fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }
}

/// Estimates the width of a text (px); exact widths depend on the fonts of the viewer.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * size * LETTER
}

/// Estimates the width of a bold text (px).
pub fn bold_width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * size * BOLD_LETTER
}

/// Breaks a text at spaces into lines of at most this width (px).
pub fn wrap(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line)
                if text_width(line, size) + text_width(word, size) + size * LETTER <= width =>
            {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A number with at most one decimal, in as few characters as possible.
#[derive(Debug, Clone, Copy)]
pub struct Num(pub f64);

impl fmt::Display for Num {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Callers pass finite numbers; for others a zero keeps the SVG valid.
        let tenths = if self.0.is_finite() {
            (self.0 * 10.0).round() as i64
        } else {
            0
        };
        let sign = if tenths < 0 { "-" } else { "" };
        let (whole, rest) = (tenths.unsigned_abs() / 10, tenths.unsigned_abs() % 10);
        if rest == 0 {
            write!(f, "{sign}{whole}")
        } else {
            write!(f, "{sign}{whole}.{rest}")
        }
    }
}

/// Escapes text for XML: markup characters become entities, characters that XML cannot represent are
/// replaced.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\t' | '\n' | '\r' => escaped.push(' '),
            '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            c if c.is_control() => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_have_no_negative_zero() {
        for (number, text) in [
            (0.0, "0"),
            (-0.01, "0"),
            (1.0, "1"),
            (-1.26, "-1.3"),
            (-0.4, "-0.4"),
            (760.04, "760"),
            (f64::NAN, "0"),
        ] {
            assert_eq!(Num(number).to_string(), text);
        }
    }

    #[test]
    fn markup_and_control_characters_are_escaped() {
        assert_eq!(
            escape("a<b>&\"c\"\n\u{1}"),
            "a&lt;b&gt;&amp;&quot;c&quot; \u{fffd}"
        );
    }

    #[test]
    fn a_halo_is_a_text_below_the_text_and_needs_no_paint_order() {
        let style = Style {
            size: 14.0,
            color: "#000000",
            bold: true,
            anchor: "middle",
            halo: true,
        };
        let mut canvas = Canvas::new(10.0, 10.0, "", "");
        canvas.label(1.0, 2.0, &style, "a<b");
        let svg = canvas.finish();
        assert!(!svg.contains("paint-order"));
        let texts: Vec<&str> = svg.lines().filter(|line| line.contains("a&lt;b")).collect();
        assert_eq!(texts.len(), 2);
        assert!(texts[0].contains("stroke=") && texts[0].contains("aria-hidden"));
        assert!(!texts[1].contains("stroke="), "{}", texts[1]);
    }

    #[test]
    fn lines_break_at_spaces_and_long_words_stay_whole() {
        assert_eq!(wrap("one two three", 10.0, 48.0), ["one two", "three"]);
        assert_eq!(wrap("incomprehensible", 10.0, 20.0), ["incomprehensible"]);
        assert!(wrap("", 10.0, 20.0).is_empty());
    }
}
