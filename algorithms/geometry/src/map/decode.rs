//! Reading of an image in any format.

use std::io::BufRead;

use super::image::{Image, ImageError};
use super::{pgm, png_image};

impl Image {
    /// Reads a PGM (P2, P5) or PNG image; memory use grows with the content of the file, not with the claims
    /// of its header.
    ///
    /// # Errors
    /// The error names the invalid part of the file and the expected value.
    ///
    /// ```
    /// use geometry::map::Image;
    ///
    /// let image = Image::read("P2 3 1 255 0 128 255".as_bytes())?;
    /// assert_eq!(image.samples, [0, 128, 255]);
    /// # Ok::<(), geometry::map::ImageError>(())
    /// ```
    pub fn read(mut input: impl BufRead) -> Result<Self, ImageError> {
        if png_image::is_png(input.fill_buf()?) {
            png_image::read(input)
        } else {
            pgm::read(input)
        }
    }
}
