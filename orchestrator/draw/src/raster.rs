//! Drawings as pixels, PNG and PDF. The font is part of the program: the same drawing has the same pixels everywhere.

use std::io;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree, WriteOptions, fontdb};
use svg2pdf::{ConversionOptions, PageOptions, to_pdf};

/// Pixels of a PNG file for each unit of the drawing, on high-resolution displays and paper.
const PNG_SCALE: f32 = 2.0;
/// Maximum width and height (px).
const MAX_SIDE: u32 = 16_384;
/// Fonts of the letters of Latin, Greek and Cyrillic, and of signs.
const FONTS: [&[u8]; 2] = [
    include_bytes!("../fonts/DejaVuSans.ttf"),
    include_bytes!("../fonts/DejaVuSans-Bold.ttf"),
];

static OWN_FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| fonts(false));
/// With those of the system, for other letters.
static ALL_FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| fonts(true));

/// Pixels of a drawing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pixels {
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Red, green and blue of each pixel, row by row from the top.
    pub rgb: Vec<u8>,
}

/// Returns an SVG document in the format that the ending of a file's name tells: PNG, PDF, or unchanged.
///
/// # Errors
/// The document is not a drawing, or is too large.
pub fn encoded(svg: String, file: &Path) -> io::Result<Vec<u8>> {
    let is = |ending: &str| {
        file.extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(ending))
    };
    if is("png") {
        let tree = tree(&svg)?;
        let size = tree.size().to_int_size();
        let image = render(&tree, PNG_SCALE, [size.width() * 2, size.height() * 2])?;
        image.encode_png().map_err(io::Error::other)
    } else if is("pdf") {
        // Letters become outlines, which need no font.
        let outlines = tree(&svg)?.to_string(&WriteOptions::default());
        to_pdf(
            &tree(&outlines)?,
            ConversionOptions::default(),
            PageOptions::default(),
        )
        .map_err(|error| io::Error::other(error.to_string()))
    } else {
        Ok(svg.into_bytes())
    }
}

/// Returns the pixels of an SVG document; with a size (px), it is fitted into it.
///
/// # Errors
/// As [`encoded`].
pub fn pixels(svg: &str, size: Option<[u32; 2]>) -> io::Result<Pixels> {
    let tree = tree(svg)?;
    let own = tree.size().to_int_size();
    let [width, height] = size.unwrap_or([own.width(), own.height()]);
    let [across, down] = [
        width as f32 / own.width() as f32,
        height as f32 / own.height() as f32,
    ];
    let image = render(&tree, across.min(down), [width, height])?;
    let (pixels, _) = image.data().as_chunks::<4>();
    Ok(Pixels {
        width,
        height,
        rgb: pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect(),
    })
}

fn render(tree: &Tree, scale: f32, [width, height]: [u32; 2]) -> io::Result<Pixmap> {
    let image = Pixmap::new(width, height).filter(|_| width.max(height) <= MAX_SIDE);
    let mut image = image.ok_or_else(|| {
        io::Error::other(format!(
            "{width} x {height} pixels: expected 1 to {MAX_SIDE} each"
        ))
    })?;
    image.fill(Color::WHITE);
    resvg::render(
        tree,
        Transform::from_scale(scale, scale),
        &mut image.as_mut(),
    );
    Ok(image)
}

fn tree(svg: &str) -> io::Result<Tree> {
    let is_own = |c: char| c < '\u{460}' || ('\u{1e00}'..'\u{2266}').contains(&c);
    let fonts = if svg.chars().all(is_own) {
        &OWN_FONTS
    } else {
        &ALL_FONTS
    };
    let options = Options {
        fontdb: Arc::clone(fonts),
        font_family: FAMILY.to_owned(),
        ..Options::default()
    };
    Tree::from_str(svg, &options).map_err(io::Error::other)
}

/// Name of the font.
const FAMILY: &str = "DejaVu Sans";

fn fonts(of_system: bool) -> Arc<fontdb::Database> {
    let mut fonts = fontdb::Database::new();
    for font in FONTS {
        fonts.load_font_data(font.to_vec());
    }
    fonts.set_sans_serif_family(FAMILY);
    if of_system {
        fonts.load_system_fonts();
    }
    Arc::new(fonts)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of 40 px, half of it red.
    const HALF: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40\" height=\"40\">\
                        <rect width=\"20\" height=\"40\" fill=\"#ff0000\"/></svg>";

    #[test]
    fn pixels_are_those_of_the_drawing_and_fit_a_size() {
        let square = pixels(HALF, None).unwrap();
        assert_eq!((square.width, square.height), (40, 40));
        let at = |pixels: &Pixels, x: usize, y: usize| {
            let first = (y * pixels.width as usize + x) * 3;
            [
                pixels.rgb[first],
                pixels.rgb[first + 1],
                pixels.rgb[first + 2],
            ]
        };
        assert_eq!(at(&square, 10, 30), [255, 0, 0]);
        assert_eq!(at(&square, 30, 30), [255, 255, 255]);
        let wide = pixels(HALF, Some([100, 20])).unwrap();
        assert_eq!((wide.width, wide.height, wide.rgb.len()), (100, 20, 6000));
        assert_eq!(at(&wide, 5, 10), [255, 0, 0]);
        assert_eq!(at(&wide, 15, 10), [255, 255, 255]);
        assert!(pixels(HALF, Some([0, 20])).is_err());
        assert!(pixels("<p/>", None).is_err());
    }

    #[test]
    fn the_ending_of_the_name_tells_the_format() {
        let encoded = |name: &str| encoded(HALF.to_owned(), Path::new(name)).unwrap();
        assert_eq!(encoded("a.svg"), HALF.as_bytes());
        assert_eq!(encoded("a"), HALF.as_bytes());
        assert!(encoded("a.PNG").starts_with(b"\x89PNG"));
        assert!(encoded("a.pdf").starts_with(b"%PDF"));
    }

    #[test]
    fn letters_are_drawn_in_every_format() {
        let text = |text: &str| {
            let mut canvas = crate::canvas::Canvas::new(200.0, 40.0, "", "");
            let style = crate::canvas::Style {
                size: 20.0,
                color: "#000000",
                bold: true,
                anchor: "start",
                halo: false,
            };
            canvas.label(5.0, 30.0, &style, text);
            canvas.finish()
        };
        let dark = |svg: &str| {
            let pixels = pixels(svg, None).unwrap();
            pixels.rgb.iter().filter(|&&value| value < 100).count()
        };
        for letters in ["Robot 1", "αβγ", "Ёж", "≤ 3 m² – 4°"] {
            assert!(dark(&text(letters)) > 200, "{letters}");
        }
        let pdf = |svg| encoded(svg, Path::new("a.pdf")).unwrap().len();
        assert!(pdf(text("Robot 1")) > pdf(text("")) + 300);
    }
}
