//! ROS `map_server` maps: a YAML file and a gray image.
//!
//! Only the YAML subset that `map_server` writes is supported: lines of `key: value`.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use nalgebra::Point2;

use super::{CellMap, Pgm, PgmError, UnknownCells};
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
    /// The image, a PGM file; relative to the YAML file's directory.
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
        source: PgmError,
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
    /// use geometry::map::{RosMap, UnknownCells, Pgm};
    ///
    /// let text = "image: room.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\n\
    ///             occupied_thresh: 0.65\nfree_thresh: 0.25\n";
    /// let map = RosMap::parse(Path::new("room.yaml"), text)?;
    /// let image = Pgm::read("P2 3 1 255 0 254 254".as_bytes())?;
    /// assert_eq!(map.classify(&image, UnknownCells::Occupied).runs, [0, 1, 2]);
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
                        return Err(bad("image is empty", "the path of a PGM file"));
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
                    if unquote(value) != "trinary" {
                        return Err(bad(&format!("mode = {value}"), "trinary"));
                    }
                    mode.replace(()).is_some()
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
        };
        if map.free_thresh > map.occupied_thresh {
            let expected = format!("at most occupied_thresh = {}", map.occupied_thresh);
            let source = ParamsError::new("free_thresh", &map.free_thresh, expected);
            return Err(RosMapError::Field {
                path: path.to_owned(),
                source,
            });
        }
        Ok(map)
    }

    /// Reads the image and classifies its pixels.
    ///
    /// # Errors
    /// The error names the image's file and its fault.
    pub fn load(&self, unknown: UnknownCells) -> Result<CellMap, RosMapError> {
        match self.path.parent() {
            Some(directory) => self.load_image(&directory.join(&self.image), unknown),
            None => self.load_image(&self.image, unknown),
        }
    }

    /// As [`Self::load`], of the image at this path.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn load_image(&self, path: &Path, unknown: UnknownCells) -> Result<CellMap, RosMapError> {
        let image = open(path)
            .map_err(PgmError::Io)
            .and_then(|file| Pgm::read(BufReader::new(file.take(MAX_IMAGE))))
            .map_err(|source| RosMapError::Image {
                path: path.to_owned(),
                source,
            })?;
        let map = self.classify(&image, unknown);
        map.validate().map_err(|source| RosMapError::Field {
            path: self.path.clone(),
            source,
        })?;
        Ok(map)
    }

    /// Classifies gray values as free or occupied: probability = 1 − gray/white, or gray/white if
    /// negated. The image's top row has the largest y.
    pub fn classify(&self, image: &Pgm, unknown: UnknownCells) -> CellMap {
        let white = f64::from(image.maxval);
        let occupied = |gray: u16| {
            let brightness = f64::from(gray) / white;
            let probability = if self.negate {
                brightness
            } else {
                1.0 - brightness
            };
            if probability > self.occupied_thresh {
                true
            } else if probability < self.free_thresh {
                false
            } else {
                unknown == UnknownCells::Occupied
            }
        };
        let frame = GridFrame {
            width: image.width,
            height: image.height,
            resolution: self.resolution,
            origin: Point2::new(self.origin[0], self.origin[1]),
        };
        let rows = image.pixels.chunks_exact(image.width).rev();
        let cells = rows.flatten().map(|&gray| occupied(gray)).collect();
        CellMap::from_grid(&Grid { frame, cells })
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
