//! Portable graymaps (PGM), plain (P2) and raw (P5).

use std::io::{self, BufRead, Read};

use super::image::{Image, ImageError, check_size};

/// Reads an image.
///
/// # Errors
/// As [`Image::read`].
pub fn read(mut input: impl BufRead) -> Result<Image, ImageError> {
    let mut magic = [0; 2];
    let got = read_up_to(&mut input, &mut magic)?;
    let plain = match &magic[..got] {
        b"P2" => true,
        b"P5" => false,
        other => {
            let format = match other {
                b"\xff\xd8" => " of a JPEG image",
                b"BM" => " of a BMP image",
                b"GI" => " of a GIF image",
                b"II" | b"MM" => " of a TIFF image",
                b"P3" | b"P6" => " of a PPM image",
                _ => "",
            };
            let found = format!("\"{}\"{format}", other.escape_ascii());
            return Err(ImageError::BadMagic { found });
        }
    };
    let width = header_number(&mut input, "width", "a number of pixels > 0")?;
    let height = header_number(&mut input, "height", "a number of pixels > 0")?;
    check_size(width, height)?;
    let maxval = header_number(&mut input, "maxval", "a number in [1, 65535]")?;
    let maxval = u16::try_from(maxval).map_err(|_| ImageError::BadHeader {
        field: "maxval",
        value: maxval.to_string(),
        expected: "a number in [1, 65535]",
    })?;
    let (width, height) = (width as usize, height as usize);
    let samples = if plain {
        plain_pixels(&mut input, width, height, maxval)?
    } else {
        raw_pixels(&mut input, width, height, maxval)?
    };
    Ok(Image {
        width,
        height,
        channels: 1,
        maxval,
        samples,
    })
}

fn read_up_to(input: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match input.read(&mut buffer[filled..])? {
            0 => break,
            n => filled += n,
        }
    }
    Ok(filled)
}

fn next_byte(input: &mut impl BufRead) -> io::Result<Option<u8>> {
    let byte = input.fill_buf()?.first().copied();
    if byte.is_some() {
        input.consume(1);
    }
    Ok(byte)
}

/// The next word, after white space and comments (from `#` to the end of the line); the single
/// character that ends it is consumed. `None` at the end of the file. Words are cut after 20
/// characters: no number is longer.
fn next_word(input: &mut impl BufRead) -> io::Result<Option<String>> {
    let mut word = String::new();
    let mut comment = false;
    while let Some(byte) = next_byte(input)? {
        if comment {
            comment = byte != b'\n' && byte != b'\r';
        } else if byte == b'#' {
            // A comment ends a word just as white space does, except for the header's last number,
            // where exactly one white-space character separates it from raw pixels.
            comment = true;
        } else if byte.is_ascii_whitespace() {
            if !word.is_empty() {
                break;
            }
        } else {
            word.extend(char::from(byte).escape_default());
            if word.len() > 20 {
                break;
            }
        }
    }
    Ok((!word.is_empty()).then_some(word))
}

fn header_number(
    input: &mut impl BufRead,
    field: &'static str,
    expected: &'static str,
) -> Result<u64, ImageError> {
    let word = next_word(input)?;
    match word.as_deref().and_then(|w| w.parse().ok()) {
        Some(number) if number > 0 => Ok(number),
        _ => {
            let value = word.unwrap_or_else(|| "the end of the file".to_owned());
            Err(ImageError::BadHeader {
                field,
                value,
                expected,
            })
        }
    }
}

fn plain_pixels(
    input: &mut impl BufRead,
    width: usize,
    height: usize,
    maxval: u16,
) -> Result<Vec<u16>, ImageError> {
    let expected = width * height;
    let mut pixels = Vec::new();
    while pixels.len() < expected {
        let Some(word) = next_word(input)? else {
            return Err(ImageError::Truncated {
                found: pixels.len(),
                width,
                height,
                expected,
            });
        };
        match word.parse::<u16>() {
            Ok(value) if value <= maxval => pixels.push(value),
            _ => {
                return Err(ImageError::BadPixel {
                    index: pixels.len(),
                    value: word,
                    maxval,
                });
            }
        }
    }
    Ok(pixels)
}

fn raw_pixels(
    input: &mut impl BufRead,
    width: usize,
    height: usize,
    maxval: u16,
) -> Result<Vec<u16>, ImageError> {
    let expected = width * height;
    let bytes_per_pixel = if maxval < 256 { 1 } else { 2 };
    let mut bytes = Vec::new();
    input
        .take((expected * bytes_per_pixel) as u64)
        .read_to_end(&mut bytes)?;
    let found = bytes.len() / bytes_per_pixel;
    if found < expected {
        return Err(ImageError::Truncated {
            found,
            width,
            height,
            expected,
        });
    }
    let pixels: Vec<u16> = if bytes_per_pixel == 1 {
        bytes.iter().map(|&b| u16::from(b)).collect()
    } else {
        bytes
            .chunks_exact(2)
            .map(|b| u16::from_be_bytes([b[0], b[1]]))
            .collect()
    };
    match pixels.iter().position(|&value| value > maxval) {
        None => Ok(pixels),
        Some(index) => Err(ImageError::BadPixel {
            index,
            value: pixels[index].to_string(),
            maxval,
        }),
    }
}

#[cfg(test)]
mod tests {
    use expect_test::expect;

    use super::{Image, ImageError};

    fn read(bytes: &[u8]) -> Result<Image, ImageError> {
        super::read(bytes)
    }

    #[test]
    fn plain_and_raw_images_read_the_same() {
        let plain = read(b"P2 # plain\n# a comment\n3 2\n# another\n255\n0 1 2\n253 254 255\n");
        let mut raw = b"P5\n# made by hand\n3 2\n255\n".to_vec();
        raw.extend([0, 1, 2, 253, 254, 255]);
        let (plain, raw) = (plain.unwrap(), read(&raw).unwrap());
        assert_eq!(plain, raw);
        assert_eq!((plain.width, plain.height, plain.maxval), (3, 2, 255));
        assert_eq!(plain.samples, [0, 1, 2, 253, 254, 255]);
    }

    #[test]
    fn sixteen_bit_pixels_are_big_endian() {
        let mut raw = b"P5 2 1 65535\n".to_vec();
        raw.extend([0x01, 0x02, 0xff, 0xff]);
        assert_eq!(read(&raw).unwrap().samples, [0x0102, 0xffff]);
    }

    #[test]
    fn the_first_pixel_may_look_like_white_space_or_a_comment() {
        let mut raw = b"P5 2 1 255\n".to_vec();
        raw.extend(*b"\n#");
        assert_eq!(read(&raw).unwrap().samples, [10, 35]);
    }

    #[test]
    fn errors_of_broken_images_name_the_fault() {
        let files: [&[u8]; 15] = [
            b"P6\n1 1\n255\n\0",
            b"\xff\xd8\xff\xe0",
            b"BM6\0",
            b"GIF89a",
            b"II*\0",
            b"",
            b"P5\n",
            b"P5\n0 3 255\n",
            b"P5\n3 -3 255\n",
            b"P5\n1 1 65536\n",
            b"P5\n2 2 255\nabc",
            b"P2\n2 1 9\n1 x",
            b"P2\n2 1 9\n1 10",
            b"P5\n2 1 9\n\x01\x0a",
            b"P5\n100000 10000\n255\n",
        ];
        let errors = files.map(|file| read(file).unwrap_err().to_string());
        expect![[r#"
            magic number is "P6" of a PPM image: expected P2 or P5 of a PGM image, or a PNG image; ImageMagick makes one of others: `convert FILE map.png`
            magic number is "\xff\xd8" of a JPEG image: expected P2 or P5 of a PGM image, or a PNG image; ImageMagick makes one of others: `convert FILE map.png`
            magic number is "BM" of a BMP image: expected P2 or P5 of a PGM image, or a PNG image; ImageMagick makes one of others: `convert FILE map.png`
            magic number is "GI" of a GIF image: expected P2 or P5 of a PGM image, or a PNG image; ImageMagick makes one of others: `convert FILE map.png`
            magic number is "II" of a TIFF image: expected P2 or P5 of a PGM image, or a PNG image; ImageMagick makes one of others: `convert FILE map.png`
            magic number is "": expected P2 or P5 of a PGM image, or a PNG image; ImageMagick makes one of others: `convert FILE map.png`
            header: width = the end of the file: expected a number of pixels > 0
            header: width = 0: expected a number of pixels > 0
            header: height = -3: expected a number of pixels > 0
            header: maxval = 65536: expected a number in [1, 65535]
            truncated: 3 pixels of 2 × 2 = 4 declared in the header
            pixel 1: x: expected a number in [0, 9]
            pixel 1: 10: expected a number in [0, 9]
            pixel 1: 10: expected a number in [0, 9]
            header: 100000 × 10000 pixels: expected at most 25000000 pixels"#]].assert_eq(&errors.join("\n"));
    }

    #[test]
    fn a_gigantic_header_is_refused_before_anything_is_allocated() {
        let error = read(b"P5\n18446744073709551615 18446744073709551615 255\n").unwrap_err();
        assert!(matches!(error, ImageError::TooLarge { .. }));
        let error = read(b"P5\n99999999999999999999999 1 255\n").unwrap_err();
        assert!(matches!(error, ImageError::BadHeader { .. }));
    }
}
