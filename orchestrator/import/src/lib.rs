//! Scenarios from published files: the grid maps and problems of MovingAI (`.map`, `.scen`), and street graphs (GraphML,
//! OpenStreetMap XML).
//!
//! [`import`] turns a file into a vector map and the text of a scenario that uses it. Only the largest connected part of
//! the free space remains free, so that every robot can reach every other one.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod connected;
mod error;
mod graphml;
mod movingai;
mod osm;
mod project;
mod read;
mod scenario;
mod streets;
mod vectors;

#[cfg(test)]
mod tests;

use std::path::Path;

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
pub const EXTENSIONS: [&str; 5] = ["map", "scen", "graphml", "osm", "xml"];

/// Returns `true` if the extension of a path is one of [`EXTENSIONS`].
pub fn is_importable(path: &Path) -> bool {
    EXTENSIONS.contains(&read::extension(path).as_str())
}

/// Reads a file: `.map` becomes a chase, `.scen` robots with goals on its map, which lies beside it; `.graphml`, `.osm`
/// and `.xml` (OpenStreetMap) become a chase in the streets.
///
/// # Errors
/// [`ImportError`] names the file, the line, the value and the expected one.
pub fn import(path: &Path, sizes: Sizes) -> Result<Imported, ImportError> {
    let text = read::text(path)?;
    let stem = read::stem(path);
    match read::extension(path).as_str() {
        "map" => {
            let grid = movingai::map(path, &text)?;
            let world = vectors::World::of_cells(path, grid, sizes.cell)?;
            Ok(scenario::chase(&stem, &world, sizes.cell))
        }
        "scen" => {
            let problems = movingai::problems(path, &text)?;
            let map = movingai::map_beside(path, &problems.map)?;
            let grid = movingai::map(&map, &read::text(&map)?)?;
            let world = vectors::World::of_cells(&map, grid, sizes.cell)?;
            scenario::problems(path, &stem, &world, sizes.cell, &problems)
        }
        "graphml" => {
            let world = graphml::streets(path, &text)?.world(path, sizes.street)?;
            Ok(scenario::chase(&stem, &world, 0.5 * sizes.street))
        }
        "osm" | "xml" => {
            let world = osm::streets(path, &text)?.world(path, sizes.street)?;
            Ok(scenario::chase(&stem, &world, 0.5 * sizes.street))
        }
        _ => Err(ImportError::Kind {
            path: path.to_owned(),
        }),
    }
}
