//! Maps of ROS `map_server`.

use std::path::Path;

use geometry::grid::Grid;
use geometry::map::{Occupancy, RosMap};
use scenario::files::{Base, Found};

use super::ImportError;
use super::vectors::World;

/// Length from which the sizes of robots follow (m), unless a pixel is larger or the map is small.
const LENGTH: f64 = 0.5;
/// Minimum ratio of the shorter side of the map to that length, unless a pixel is larger.
const MIN_LENGTHS: f64 = 10.0;

/// Reads a map, whose unknown cells are obstacles. Returns the world, and the length from which the sizes of robots follow
/// (m).
///
/// # Errors
/// The file or its image is invalid, or the image lies outside the base.
pub fn world(path: &Path, base: &Base) -> Result<(World, f64), ImportError> {
    let map = RosMap::read(path)?;
    let image = map.image.to_string_lossy();
    let cells = match base.find(&image) {
        Ok(Found::Disk(image)) => map.load_image(&image)?,
        Ok(Found::Text(_)) => return Err(ImportError::content(path, image, "an image on disk")),
        Err(refused) => return Err(ImportError::other(path, &image, refused)),
    };
    let frame = cells.frame;
    let shorter = frame.width.min(frame.height) as f64 * frame.resolution;
    let length = (shorter / MIN_LENGTHS).min(LENGTH).max(frame.resolution);
    let is_occupied = |cell: Occupancy| cell != Occupancy::Free;
    let occupied = Grid {
        frame,
        cells: cells.cells.into_iter().map(is_occupied).collect(),
    };
    Ok((World::new(path, occupied, frame.resolution)?, length))
}
