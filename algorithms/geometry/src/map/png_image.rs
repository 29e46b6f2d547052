//! Portable Network Graphics (PNG).

use std::io::{BufRead, Cursor};

use png::{BitDepth, Decoder, Limits, Transformations};

use super::image::{Image, ImageError, MAX_PIXELS, check_size};

/// First bytes of every PNG file.
const SIGNATURE: &[u8] = b"\x89PNG";
/// Maximum number of bytes of a pixel.
const MAX_PIXEL_BYTES: usize = 8;

/// Returns `true` if a file that begins with these bytes is a PNG image.
pub fn is_png(start: &[u8]) -> bool {
    start.starts_with(SIGNATURE)
}

/// Reads an image: the first one of an animation. Palettes become colours; samples have 8 or 16 bits.
///
/// # Errors
/// As [`Image::read`].
pub fn read(mut input: impl BufRead) -> Result<Image, ImageError> {
    let mut file = Vec::new();
    input.read_to_end(&mut file)?;
    let limits = Limits {
        bytes: MAX_PIXELS * MAX_PIXEL_BYTES,
    };
    let mut decoder = Decoder::new_with_limits(Cursor::new(file), limits);
    decoder.set_transformations(Transformations::EXPAND);
    let header = decoder.read_header_info()?;
    let (width, height) = (header.width, header.height);
    check_size(u64::from(width), u64::from(height))?;
    let mut reader = decoder.read_info()?;
    let (color, depth) = reader.output_color_type();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap_or_default()];
    reader.next_frame(&mut bytes)?;
    let (maxval, samples) = if depth == BitDepth::Sixteen {
        let pairs = bytes.chunks_exact(2);
        let samples = pairs.map(|pair| u16::from_be_bytes([pair[0], pair[1]]));
        (u16::MAX, samples.collect())
    } else {
        (255, bytes.into_iter().map(u16::from).collect())
    };
    Ok(Image {
        width: width as usize,
        height: height as usize,
        channels: color.samples(),
        maxval,
        samples,
    })
}

#[cfg(test)]
mod tests {
    use png::{ColorType, Encoder};

    use super::*;

    fn encoded(color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, 2, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette(vec![0, 0, 0, 10, 20, 30]);
            encoder.set_trns(vec![255, 128]);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        writer.finish().unwrap();
        file
    }

    fn pixels(color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<(u32, Option<u16>)> {
        let image = read(&encoded(color, depth, data)[..]).unwrap();
        assert_eq!((image.width, image.height), (2, 1));
        image.pixels().map(|p| (p.color, p.alpha)).collect()
    }

    #[test]
    fn every_colour_type_becomes_colour_and_alpha() {
        use BitDepth::{Eight, One, Sixteen};
        assert_eq!(
            pixels(ColorType::Grayscale, Eight, &[0, 205]),
            [(0, None), (615, None)]
        );
        assert_eq!(
            pixels(ColorType::Grayscale, One, &[0b0100_0000]),
            [(0, None), (765, None)]
        );
        assert_eq!(
            pixels(ColorType::Grayscale, Sixteen, &[1, 2, 255, 255]),
            [(3 * 0x0102, None), (3 * 0xffff, None)]
        );
        assert_eq!(
            pixels(ColorType::GrayscaleAlpha, Eight, &[9, 255, 7, 0]),
            [(27, Some(255)), (21, Some(0))]
        );
        assert_eq!(
            pixels(ColorType::Rgb, Eight, &[1, 2, 3, 4, 5, 6]),
            [(6, None), (15, None)]
        );
        assert_eq!(
            pixels(ColorType::Rgba, Eight, &[1, 2, 3, 4, 5, 6, 7, 8]),
            [(6, Some(4)), (18, Some(8))]
        );
        assert_eq!(
            pixels(ColorType::Indexed, Eight, &[0, 1]),
            [(0, Some(255)), (60, Some(128))]
        );
    }

    #[test]
    fn damaged_and_enormous_files_are_refused() {
        let file = encoded(ColorType::Rgb, BitDepth::Eight, &[1, 2, 3, 4, 5, 6]);
        for end in 4..file.len() - 13 {
            let found = read(&file[..end]).unwrap_err();
            assert!(matches!(found, ImageError::Png(_)), "{end}: {found}");
        }
        let mut flipped = file.clone();
        flipped[45] ^= 0x20;
        assert!(read(&flipped[..]).is_err());
        let mut large = Vec::new();
        let encoder = Encoder::new(&mut large, 100_000, 10_000);
        drop(encoder.write_header().unwrap());
        let found = read(&large[..]).unwrap_err().to_string();
        assert!(found.contains("100000 × 10000 pixels"), "{found}");
    }
}
