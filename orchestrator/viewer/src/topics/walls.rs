//! Outlines of obstacles as points, for viewers that draw neither maps nor markers.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::{MapCell, MapHeader};
use ipc_types::topics::{TopicId, WorldMap};

use super::channel::ViewerChannel;
use super::grid;
use super::picture::Picture;
use super::primitives::cloud;
use ros_messages::messages::PointCloud2;

/// `/walls`, at every revision of the map.
pub(super) struct WallsTopic(ViewerChannel<PointCloud2>);

impl WallsTopic {
    pub(super) fn new(picture: &mut Picture) -> Self {
        Self(picture.add_latched_channel("/walls"))
    }
}

impl Consumer<Picture> for WallsTopic {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::WorldMap]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, picture: &mut Picture) {
        if let Some((header, cells)) = message.view::<WorldMap>()
            && grid::fits(header.width, header.height, cells.len())
        {
            let walls = draw(&header, message.time_ns, cells);
            self.0.write(&mut picture.ready, message.time_ns, &walls);
        }
    }
}

/// Returns the centres of the occupied cells that have a free neighbour. The number of cells must be that of
/// the header.
fn draw(
    header: &MapHeader,
    time_ns: u64,
    cells: impl ExactSizeIterator<Item = MapCell>,
) -> PointCloud2 {
    let width = header.width.max(1) as usize;
    let solid: Vec<bool> = cells.map(|cell| cell.occupied != 0).collect();
    let is_free = |index: Option<usize>| index.is_some_and(|i| solid.get(i) == Some(&false));
    let mut data = Vec::new();
    for (index, _) in solid.iter().enumerate().filter(|(_, solid)| **solid) {
        let (column, row) = (index % width, index / width);
        let left = (column > 0).then(|| index - 1);
        let right = (column + 1 < width).then_some(index + 1);
        let beside = [left, right, index.checked_sub(width), Some(index + width)];
        if beside.into_iter().any(is_free) {
            let centre = |origin: f64, cell: usize| {
                (origin + (cell as f64 + 0.5) * header.resolution) as f32
            };
            let point = [
                centre(header.origin_x, column),
                centre(header.origin_y, row),
                0.0,
            ];
            data.extend(point.iter().flat_map(|value| value.to_le_bytes()));
        }
    }
    cloud(time_ns, &[("x", 0), ("y", 4), ("z", 8)], 12, data)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_outline_of_obstacles_is_drawn() {
        let header = MapHeader {
            width: 5,
            height: 5,
            resolution: 2.0,
            origin_x: -1.0,
            ..MapHeader::default()
        };
        // A block of 3 × 3 cells in the middle: eight at the edge, one inside.
        let cells = (0..25).map(|i| MapCell {
            occupied: u8::from((1..4).contains(&(i % 5)) && (1..4).contains(&(i / 5))),
            ..MapCell::default()
        });
        let cells: Vec<MapCell> = cells.collect();
        let cloud = draw(&header, 0, cells.into_iter());
        assert_eq!(
            (cloud.width, cloud.point_step, cloud.data.len()),
            (8, 12, 96)
        );
        let first: Vec<f32> = cloud.data[..12]
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect();
        assert_eq!(first, [2.0, 3.0, 0.0]);
        let walls = vec![
            MapCell {
                occupied: 1,
                ..MapCell::default()
            };
            25
        ];
        assert!(draw(&header, 0, walls.into_iter()).data.is_empty());
    }
}
