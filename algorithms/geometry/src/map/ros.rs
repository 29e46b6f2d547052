//! ROS `map_server` maps: a YAML file and an image.
//!
//! Only the YAML subset that `map_server` writes is supported: lines of `key: value`.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use nalgebra::Point2;

use super::{CellMap, Image, ImageError, Occupancy, Pixel, UnknownCells};
use parameters::ParamsError;

use crate::extent::MAX_COORDINATE;
use crate::grid::{Grid, GridFrame};

/// Maximum size of a YAML file (bytes).
const MAX_YAML: u64 = 1 << 20;
/// Maximum size of an image (bytes): plain pixels of the largest map, with comments.
const MAX_IMAGE: u64 = 512 << 20;
const KEYS: &str = "image, resolution, origin, negate, occupied_thresh, free_thresh or mode";

/// The YAML part of a ROS map.
#[derive(Debug, Clone, PartialEq)]
pub struct RosMap {
    /// The YAML file.
    pub path: PathBuf,
    /// The image, a PGM or PNG file; relative to the YAML file's directory.
    pub image: PathBuf,
    /// Side of a pixel (m).
    pub resolution: f64,
    /// World position of the outer corner of the bottom left pixel (m).
    pub origin: [f64; 2],
    /// `true` if white is occupied instead of black.
    pub negate: bool,
    /// Pixels with a higher probability of occupation are obstacles, in [0, 1].
    pub occupied_thresh: f64,
    /// Pixels with a lower probability of occupation are free, in [0, 1]; in between they are
    /// unknown.
    pub free_thresh: f64,
    /// Meaning of a pixel.
    pub mode: RosMode,
}

/// Meaning of a pixel of a ROS map. All modes know free, occupied and unknown cells here: a probability between the
/// thresholds is unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RosMode {
    /// The mean of all its samples, the alpha of a transparent image included, is the probability.
    #[default]
    Trinary,
    /// The mean of its colours is the probability; a pixel that is not opaque is unknown.
    Scale,
    /// The mean of its colours, from 0 to 255, is the probability in percent; more than 100 is unknown.
    Raw,
}

/// Reason why a ROS map is invalid.
#[derive(Debug, thiserror::Error)]
pub enum RosMapError {
    /// A file is missing or unreadable.
    #[error("map {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A line of the YAML file is invalid.
    #[error("map {}, line {line}: {found}: expected {expected}", path.display())]
    Line {
        /// The YAML file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// Actual text.
        found: String,
        /// Expected text.
        expected: String,
    },
    /// A required key is missing.
    #[error("map {}: {key} is missing: expected a line `{key}: …`", path.display())]
    Missing {
        /// The YAML file.
        path: PathBuf,
        /// The key.
        key: &'static str,
    },
    /// The image is invalid.
    #[error("map image {}: {source}", path.display())]
    Image {
        /// The image's file.
        path: PathBuf,
        /// Error of the image.
        source: ImageError,
    },
    /// The map as a whole is invalid (its size, its position).
    #[error("map {}: {source}", path.display())]
    Field {
        /// The YAML file.
        path: PathBuf,
        /// Error of the field.
        source: ParamsError,
    },
}

impl RosMap {
    /// Reads the YAML file.
    ///
    /// # Errors
    /// The error names the file, the line, the actual and the expected text.
    pub fn read(path: &Path) -> Result<Self, RosMapError> {
        let io = |source| RosMapError::Io {
            path: path.to_owned(),
            source,
        };
        let mut text = String::new();
        let size = open(path)
            .and_then(|file| file.take(MAX_YAML + 1).read_to_string(&mut text))
            .map_err(io)?;
        if size as u64 > MAX_YAML {
            let source = io::Error::other(format!("expected at most {MAX_YAML} bytes of YAML"));
            return Err(RosMapError::Io {
                path: path.to_owned(),
                source,
            });
        }
        Self::parse(path, &text)
    }

    /// Parses the text of the YAML file that `path` names.
    ///
    /// # Errors
    /// The error names the file, the line, the actual and the expected text.
    ///
    /// ```
    /// use std::path::Path;
    /// use geometry::map::{Image, Occupancy, RosMap};
    ///
    /// let text = "image: room.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\n\
    ///             occupied_thresh: 0.65\nfree_thresh: 0.25\n";
    /// let map = RosMap::parse(Path::new("room.yaml"), text)?;
    /// let image = Image::read("P2 3 1 255 0 254 205".as_bytes())?;
    /// let cells = [Occupancy::Occupied, Occupancy::Free, Occupancy::Free];
    /// assert_eq!(map.classify(&image).cells, cells);
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    pub fn parse(path: &Path, text: &str) -> Result<Self, RosMapError> {
        let (mut image, mut resolution, mut origin) = (None, None, None);
        let (mut negate, mut occupied, mut free) = (None, None, None);
        let mut mode = None;
        for (i, raw) in text.lines().enumerate() {
            let bad = |found: &str, expected: &str| RosMapError::Line {
                path: path.to_owned(),
                line: i + 1,
                found: found.to_owned(),
                expected: expected.to_owned(),
            };
            let line = strip_comment(raw).trim();
            if line.is_empty() || line == "---" || line == "..." {
                continue;
            }
            let Some((key, value)) = line.split_once(':') else {
                return Err(bad(line, &format!("`key: value` with {KEYS}")));
            };
            let (key, value) = (key.trim(), value.trim());
            if raw.starts_with([' ', '\t']) {
                return Err(bad(line, "`key: value` at the start of the line"));
            }
            let number = |low: f64, high: f64, expected: &str| match value.parse::<f64>() {
                Ok(x) if x >= low && x <= high => Ok(x),
                _ => Err(bad(&format!("{key} = {value}"), expected)),
            };
            let seen = match key {
                "image" => {
                    let name = unquote(value);
                    if name.is_empty() {
                        return Err(bad("image is empty", "the path of a PGM or PNG file"));
                    }
                    image.replace(PathBuf::from(name)).is_some()
                }
                "resolution" => {
                    let value = number(
                        f64::MIN_POSITIVE,
                        MAX_COORDINATE,
                        "a number > 0 and ≤ 1e5 (m)",
                    )?;
                    resolution.replace(value).is_some()
                }
                "origin" => {
                    let pose = parse_origin(value).ok_or_else(|| {
                        bad(
                            &format!("origin = {value}"),
                            "[x, y, yaw] with x and y within ±1e5 (m) and yaw = 0 (rad) (turned \
                             maps are not read)",
                        )
                    })?;
                    origin.replace(pose).is_some()
                }
                "negate" => {
                    let flag = match value {
                        "0" | "false" => false,
                        "1" | "true" => true,
                        _ => return Err(bad(&format!("negate = {value}"), "0 or 1")),
                    };
                    negate.replace(flag).is_some()
                }
                "occupied_thresh" => occupied
                    .replace(number(0.0, 1.0, "a number in [0, 1]")?)
                    .is_some(),
                "free_thresh" => free
                    .replace(number(0.0, 1.0, "a number in [0, 1]")?)
                    .is_some(),
                "mode" => {
                    let named = match unquote(value) {
                        "trinary" => RosMode::Trinary,
                        "scale" => RosMode::Scale,
                        "raw" => RosMode::Raw,
                        _ => return Err(bad(&format!("mode = {value}"), "trinary, scale or raw")),
                    };
                    mode.replace(named).is_some()
                }
                _ => return Err(bad(&format!("key {key}"), KEYS)),
            };
            if seen {
                return Err(bad(&format!("{key} a second time"), "every key once"));
            }
        }
        let missing = |key| RosMapError::Missing {
            path: path.to_owned(),
            key,
        };
        let map = Self {
            path: path.to_owned(),
            image: image.ok_or(missing("image"))?,
            resolution: resolution.ok_or(missing("resolution"))?,
            origin: origin.ok_or(missing("origin"))?,
            negate: negate.unwrap_or(false),
            occupied_thresh: occupied.ok_or(missing("occupied_thresh"))?,
            free_thresh: free.ok_or(missing("free_thresh"))?,
            mode: mode.unwrap_or_default(),
        };
        map.checked()
    }

    /// Checks the relations between the fields.
    fn checked(self) -> Result<Self, RosMapError> {
        let field = |source| RosMapError::Field {
            path: self.path.clone(),
            source,
        };
        if self.negate && self.mode == RosMode::Raw {
            let expected = "0 with mode = raw".to_owned();
            return Err(field(ParamsError::new("negate", &1, expected)));
        }
        if self.free_thresh > self.occupied_thresh {
            let expected = format!("at most occupied_thresh = {}", self.occupied_thresh);
            let source = ParamsError::new("free_thresh", &self.free_thresh, expected);
            return Err(field(source));
        }
        Ok(self)
    }

    /// Reads the image and classifies its pixels.
    ///
    /// # Errors
    /// The error names the image's file and its fault.
    pub fn load(&self) -> Result<Grid<Occupancy>, RosMapError> {
        match self.path.parent() {
            Some(directory) => self.load_image(&directory.join(&self.image)),
            None => self.load_image(&self.image),
        }
    }

    /// As [`Self::load`], of the image at this path.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn load_image(&self, path: &Path) -> Result<Grid<Occupancy>, RosMapError> {
        let image = open(path)
            .map_err(ImageError::Io)
            .and_then(|file| Image::read(BufReader::new(file.take(MAX_IMAGE))))
            .map_err(|source| RosMapError::Image {
                path: path.to_owned(),
                source,
            })?;
        Ok(self.classify(&image))
    }

    /// Returns the map of classified pixels, whose unknown cells have this meaning.
    ///
    /// # Errors
    /// The error names the fault of the map as a whole.
    pub fn cell_map(
        &self,
        cells: &Grid<Occupancy>,
        unknown: UnknownCells,
    ) -> Result<CellMap, RosMapError> {
        let map = CellMap::from_occupancy(cells, unknown);
        map.validate().map_err(|source| RosMapError::Field {
            path: self.path.clone(),
            source,
        })?;
        Ok(map)
    }

    /// Classifies pixels as free, occupied or unknown. The image's top row has the largest y.
    pub fn classify(&self, image: &Image) -> Grid<Occupancy> {
        let frame = GridFrame {
            width: image.width,
            height: image.height,
            resolution: self.resolution,
            origin: Point2::new(self.origin[0], self.origin[1]),
        };
        let mut cells: Vec<Occupancy> = image
            .pixels()
            .rev()
            .map(|pixel| self.occupancy(pixel, image.maxval))
            .collect();
        // Reversed pixels have the right order of rows, and the wrong one of columns.
        cells
            .chunks_exact_mut(image.width.max(1))
            .for_each(<[Occupancy]>::reverse);
        Grid { frame, cells }
    }

    fn occupancy(&self, pixel: Pixel, maxval: u16) -> Occupancy {
        let is_opaque = pixel.alpha.is_none_or(|alpha| alpha == maxval);
        let (sum, samples) = match (self.mode, pixel.alpha) {
            // A gray with alpha counts as three equal colours.
            (RosMode::Trinary, Some(alpha)) => (pixel.color + u32::from(alpha), 4.0),
            _ => (pixel.color, 3.0),
        };
        let brightness = f64::from(sum) / (samples * f64::from(maxval));
        let probability = match self.mode {
            RosMode::Scale if !is_opaque => return Occupancy::Unknown,
            RosMode::Raw => (brightness * 255.0).round() / 100.0,
            _ if self.negate => brightness,
            _ => 1.0 - brightness,
        };
        if probability > 1.0 {
            Occupancy::Unknown
        } else if probability > self.occupied_thresh {
            Occupancy::Occupied
        } else if probability < self.free_thresh {
            Occupancy::Free
        } else {
            Occupancy::Unknown
        }
    }
}

/// Opens a file for reading; opening a FIFO would block, and reading a device may never end.
fn open(path: &Path) -> io::Result<File> {
    if path.metadata()?.is_file() {
        File::open(path)
    } else {
        Err(io::Error::other("not a regular file"))
    }
}

/// The line without its comment: from a `#` at its start or after white space, outside quotes.
fn strip_comment(line: &str) -> &str {
    let mut quote = None;
    let mut previous = ' ';
    for (i, c) in line.char_indices() {
        if quote.is_some() {
            if quote == Some(c) {
                quote = None;
            }
        } else if previous.is_whitespace() {
            match c {
                '#' => return &line[..i],
                '"' | '\'' => quote = Some(c),
                _ => {}
            }
        }
        previous = c;
    }
    line
}

fn unquote(value: &str) -> &str {
    for quote in ['"', '\''] {
        if let Some(inner) = value
            .strip_prefix(quote)
            .and_then(|v| v.strip_suffix(quote))
        {
            return inner;
        }
    }
    value
}

fn parse_origin(value: &str) -> Option<[f64; 2]> {
    let inner = value.strip_prefix('[')?.strip_suffix(']')?;
    let mut numbers = inner.split(',').map(|n| n.trim().parse::<f64>().ok());
    let (x, y, yaw) = (numbers.next()??, numbers.next()??, numbers.next()??);
    let inside = x.abs() <= MAX_COORDINATE && y.abs() <= MAX_COORDINATE;
    (numbers.next().is_none() && inside && yaw == 0.0).then_some([x, y])
}

#[cfg(test)]
mod tests;
