//! ROS `map_server` maps: a YAML file and an image.

use std::collections::BTreeMap;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use nalgebra::Point2;

use self::yaml::{Entry, Value};
use super::{CellMap, Image, ImageError, MAX_PIXELS, Occupancy, Pixel, UnknownCells};
use parameters::ParamsError;

use crate::extent::MAX_COORDINATE;
use crate::grid::{Grid, GridFrame};
use crate::text_file;

mod yaml;

/// Maximum size of a YAML file (bytes).
const MAX_YAML: u64 = 1 << 20;
/// Maximum size of an image (bytes): plain pixels of the largest map, with comments.
const MAX_IMAGE: u64 = 512 << 20;
/// Maximum yaw that counts as 0 (rad): it moves no pixel of an image by half its side.
const MAX_YAW: f64 = 0.5 / MAX_PIXELS as f64;

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
    /// Other keys of the file, which have no effect, with their lines, from 1.
    pub ignored: Vec<(String, usize)>,
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
    #[error("map {}: cannot be read: {source}", path.display())]
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
        let read = text_file::open(path).and_then(|file| text_file::read(file, MAX_YAML));
        let text = read.map_err(|source| RosMapError::Io {
            path: path.to_owned(),
            source,
        })?;
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
        let entries = yaml::entries(text).map_err(|(line, found, expected)| RosMapError::Line {
            path: path.to_owned(),
            line,
            found,
            expected: expected.to_owned(),
        })?;
        let mut keys = Keys { path, entries };
        let length = "a number > 0 and ≤ 1e5 (m)";
        let share = "a number in [0, 1]";
        let map = Self {
            image: keys.required("image", "the path of a PGM or PNG file", |value| {
                text_of(value).map(PathBuf::from)
            })?,
            resolution: keys.required("resolution", length, |value| {
                number(value, f64::MIN_POSITIVE, MAX_COORDINATE)
            })?,
            origin: keys.required(
                "origin",
                "[x, y, yaw] with x and y within ±1e5 (m) and yaw = 0 (rad) (turned maps are not read)",
                origin,
            )?,
            negate: keys
                .optional("negate", "0 or 1, or false or true", truth)?
                .unwrap_or(false),
            occupied_thresh: keys.required("occupied_thresh", share, |v| number(v, 0.0, 1.0))?,
            free_thresh: keys.required("free_thresh", share, |v| number(v, 0.0, 1.0))?,
            mode: keys
                .optional("mode", "trinary, scale or raw", mode)?
                .unwrap_or_default(),
            ignored: keys.ignored(),
            path: path.to_owned(),
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
        let image = text_file::open(path)
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

/// The keys of a file that have not been read.
struct Keys<'a> {
    path: &'a Path,
    entries: BTreeMap<String, Entry>,
}

impl Keys<'_> {
    fn required<T>(
        &mut self,
        key: &'static str,
        expected: &str,
        read: impl FnOnce(&Value) -> Option<T>,
    ) -> Result<T, RosMapError> {
        self.optional(key, expected, read)?
            .ok_or_else(|| RosMapError::Missing {
                path: self.path.to_owned(),
                key,
            })
    }

    fn optional<T>(
        &mut self,
        key: &str,
        expected: &str,
        read: impl FnOnce(&Value) -> Option<T>,
    ) -> Result<Option<T>, RosMapError> {
        let Some(Entry { line, value }) = self.entries.remove(key) else {
            return Ok(None);
        };
        let value_read = read(&value).ok_or_else(|| RosMapError::Line {
            path: self.path.to_owned(),
            line,
            found: match value {
                Value::Text(text) if text.is_empty() => format!("{key} is empty"),
                value => format!("{key} = {value}"),
            },
            expected: expected.to_owned(),
        })?;
        Ok(Some(value_read))
    }

    /// Returns the keys that are left, in the order of the file.
    fn ignored(self) -> Vec<(String, usize)> {
        let left = self.entries.into_iter();
        let mut left: Vec<_> = left.map(|(key, entry)| (key, entry.line)).collect();
        left.sort_by_key(|(_, line)| *line);
        left
    }
}

fn text_of(value: &Value) -> Option<&str> {
    match value {
        Value::Text(text) if !text.is_empty() => Some(text),
        _ => None,
    }
}

fn number(value: &Value, low: f64, high: f64) -> Option<f64> {
    let number = text_of(value)?.trim().parse().ok()?;
    (low..=high).contains(&number).then_some(number)
}

/// Returns a truth value, of YAML 1.1 or a number.
fn truth(value: &Value) -> Option<bool> {
    match text_of(value)?.trim().to_ascii_lowercase().as_str() {
        "0" | "false" | "no" | "n" | "off" => Some(false),
        "1" | "true" | "yes" | "y" | "on" => Some(true),
        _ => None,
    }
}

fn mode(value: &Value) -> Option<RosMode> {
    match text_of(value)? {
        "trinary" => Some(RosMode::Trinary),
        "scale" => Some(RosMode::Scale),
        "raw" => Some(RosMode::Raw),
        _ => None,
    }
}

fn origin(value: &Value) -> Option<[f64; 2]> {
    let Value::List(values) = value else {
        return None;
    };
    let numbers: Result<Vec<f64>, _> = values.iter().map(|n| n.trim().parse()).collect();
    let [x, y, yaw] = numbers.ok()?.try_into().ok()?;
    let inside = x.abs() <= MAX_COORDINATE && y.abs() <= MAX_COORDINATE;
    (inside && yaw.abs() <= MAX_YAW).then_some([x, y])
}

#[cfg(test)]
mod tests;
