//! Scenarios from published files: maps of ROS `map_server` (`.yaml`), the grid maps and problems of MovingAI (`.map`,
//! `.scen`), and street graphs (GraphML, OpenStreetMap XML).
//!
//! [`import`] turns a file into a vector map and the text of a scenario that uses it and passes the check. Only the
//! largest connected part of the free space remains free, so that every robot can reach every other one.

mod chase;
mod check;
mod connected;
mod error;
mod graphml;
mod movingai;
mod osm;
mod problems;
mod project;
mod read;
mod ros;
mod streets;
mod vectors;
mod wkt;
mod xml;

#[cfg(test)]
mod tests;

use std::path::Path;

use scenario::Loader;

use streets::Streets;
use vectors::World;

pub use error::ImportError;

/// Sizes that the files leave open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// Side of a cell of a MovingAI map (m), > 0.
    pub cell: f64,
    /// Width of a street (m), > 0.
    pub street: f64,
}

impl Default for Sizes {
    fn default() -> Self {
        Self {
            cell: 1.0,
            street: 8.0,
        }
    }
}

/// A file as scenario and map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Imported {
    /// Text of the scenario; it names the map.
    pub scenario: String,
    /// Path of the map, relative to the scenario.
    pub map_path: String,
    /// Text of the vector map.
    pub map: String,
}

/// Extensions of the files that can be imported.
pub const EXTENSIONS: &str = ".yaml, .yml, .map, .scen, .graphml, .osm or .xml";

/// Reads a file: `.yaml` (ROS) and `.map` become a chase, `.scen` robots with goals on its map, which lies beside it;
/// `.graphml`, `.osm` and `.xml` (OpenStreetMap) become a chase in the streets. A file may refer to files outside its
/// folder if `allow_outside` is set. The scenario passes the check of the loader; a chase has fewer robots at smaller
/// distances where space is short.
///
/// # Errors
/// [`ImportError`] names the file, the line, the value and the expected one.
pub fn import(
    path: &Path,
    sizes: Sizes,
    allow_outside: bool,
    loader: &Loader<'_>,
) -> Result<Imported, ImportError> {
    if read::extension(path) == "scen" {
        let base = read::base(path, allow_outside);
        return problems::scenario(path, &base, sizes.cell, loader);
    }
    let (world, length) = world(path, sizes, allow_outside)?;
    chase::scenario(path, &world, length, loader)
}

/// Reads the world of a file without problems, and the length from which the sizes of robots follow (m).
fn world(path: &Path, sizes: Sizes, allow_outside: bool) -> Result<(World, f64), ImportError> {
    let streets = |streets: Streets| Ok((streets.world(path, sizes.street)?, 0.5 * sizes.street));
    match read::extension(path).as_str() {
        "yaml" | "yml" => ros::world(path, &read::base(path, allow_outside)),
        "map" => {
            let grid = movingai::map(path, &read::text(path)?)?;
            Ok((World::of_cells(path, grid, sizes.cell)?, sizes.cell))
        }
        "graphml" => streets(graphml::streets(path, &read::text(path)?)?),
        "osm" | "xml" => streets(osm::streets(path, &read::text(path)?)?),
        _ => Err(ImportError::Kind {
            path: path.to_owned(),
        }),
    }
}
