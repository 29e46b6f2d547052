//! Images of maps: gray or coloured, with or without transparency.

use std::io;

/// Maximum number of pixels of an image: no scenario may have a map of more cells.
pub const MAX_PIXELS: usize = 25_000_000;

/// An image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Number of samples of a pixel: 1 (gray), 2 (gray, alpha), 3 (red, green, blue) or 4 (with alpha).
    pub channels: usize,
    /// Value of a white or opaque sample, in [1, 65535].
    pub maxval: u16,
    /// Samples pixel by pixel, row by row from the *top*; `width * height * channels`, none above
    /// `maxval`.
    pub samples: Vec<u16>,
}

/// A pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pixel {
    /// Sum of red, green and blue; three times a gray.
    pub color: u32,
    /// Opacity; `None` in an image without transparency.
    pub alpha: Option<u16>,
}

/// Reason why an image is invalid.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file does not start like a PGM or PNG image.
    #[error(
        "magic number is {found}: expected P2 or P5 of a PGM image, or a PNG image; ImageMagick makes one of others: \
         `convert FILE map.png`"
    )]
    BadMagic {
        /// The first two bytes, and the format that they belong to.
        found: String,
    },
    /// A number of the header is missing or wrong.
    #[error("header: {field} = {value}: expected {expected}")]
    BadHeader {
        /// Name of the number.
        field: &'static str,
        /// Actual value.
        value: String,
        /// Expected value.
        expected: &'static str,
    },
    /// The header declares more pixels than the maximum.
    #[error("header: {width} × {height} pixels: expected at most {MAX_PIXELS} pixels")]
    TooLarge {
        /// Declared columns.
        width: u64,
        /// Declared rows.
        height: u64,
    },
    /// The file ends before its last pixel.
    #[error("truncated: {found} pixels of {width} × {height} = {expected} declared in the header")]
    Truncated {
        /// Actual number of pixels.
        found: usize,
        /// Declared columns.
        width: usize,
        /// Declared rows.
        height: usize,
        /// Declared number of pixels.
        expected: usize,
    },
    /// A pixel is not a number, or brighter than white.
    #[error("pixel {index}: {value}: expected a number in [0, {maxval}]")]
    BadPixel {
        /// Index of the pixel, from the top left.
        index: usize,
        /// Actual value.
        value: String,
        /// The value of white.
        maxval: u16,
    },
    /// The PNG image is damaged.
    #[error("PNG: {0}")]
    Png(#[from] png::DecodingError),
}

impl Image {
    /// Returns the pixels row by row from the top.
    pub fn pixels(&self) -> impl DoubleEndedIterator<Item = Pixel> + ExactSizeIterator {
        let pixels = self.samples.chunks_exact(self.channels.max(1));
        pixels.map(|samples| {
            let sum = |samples: &[u16]| samples.iter().map(|&sample| u32::from(sample)).sum();
            let (color, alpha) = match *samples {
                [gray] => (3 * u32::from(gray), None),
                [gray, alpha] => (3 * u32::from(gray), Some(alpha)),
                [ref color @ .., alpha] if color.len() == 3 => (sum(color), Some(alpha)),
                ref color => (sum(color), None),
            };
            Pixel { color, alpha }
        })
    }
}

/// Refuses an image with too many pixels.
pub fn check_size(width: u64, height: u64) -> Result<(), ImageError> {
    if width.saturating_mul(height) > MAX_PIXELS as u64 {
        return Err(ImageError::TooLarge { width, height });
    }
    Ok(())
}
