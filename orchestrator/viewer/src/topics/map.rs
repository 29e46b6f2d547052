//! The map as coloured cells.

use foxglove::messages::Grid;
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::{MapCell, MapHeader};
use ipc_types::topics::{TopicId, WorldMap};

use super::channel::ViewerChannel;
use super::grid::{self, GridPlace};
use super::palette;
use super::picture::Picture;
use super::primitives::timestamp;
use super::repetition::Repetition;

/// `/viewer/map`, at every revision, and repeated.
pub(super) struct MapTopic {
    channel: ViewerChannel<Grid>,
    grid: Option<Grid>,
    repetition: Repetition,
}

impl MapTopic {
    pub(super) fn new(picture: &mut Picture) -> Self {
        Self {
            channel: picture.add_channel("/viewer/map"),
            grid: None,
            repetition: Repetition::default(),
        }
    }

    fn draw(&mut self, time_ns: u64, picture: &mut Picture) {
        if let Some(grid) = &mut self.grid {
            grid.timestamp = Some(timestamp(time_ns));
            let bytes = self.channel.write(&mut picture.ready, time_ns, grid);
            self.repetition.drawn(time_ns, bytes);
        }
    }
}

impl Consumer<Picture> for MapTopic {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::WorldMap]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, picture: &mut Picture) {
        if let Some((header, cells)) = message.view::<WorldMap>()
            && let Some(grid) = draw(&header, message.time_ns, cells)
        {
            self.grid = Some(grid);
            self.draw(message.time_ns, picture);
        }
    }

    fn end_of_tick(&mut self, picture: &mut Picture) {
        if self.repetition.is_due(picture.now_ns()) {
            self.draw(picture.now_ns(), picture);
        }
    }
}

/// Draws a map: obstacles are dark; free cells are lighter with distance from obstacles (by the blurred map).
/// Returns `None` if the number of cells differs from the header.
fn draw(
    header: &MapHeader,
    time_ns: u64,
    cells: impl ExactSizeIterator<Item = MapCell>,
) -> Option<Grid> {
    if !grid::fits(header.width, header.height, cells.len()) {
        return None;
    }
    let mut data = Vec::with_capacity(cells.len() * grid::CELL_BYTES);
    for cell in cells {
        let grey = if cell.occupied != 0 {
            palette::WALL_GREY
        } else {
            let edge = f32::from(palette::EDGE_GREY);
            // A cast of a float saturates, also for NaN.
            (edge + (255.0 - edge) * cell.blurred.clamp(0.0, 1.0)) as u8
        };
        data.extend_from_slice(&[grey, grey, grey, u8::MAX]);
    }
    let place = GridPlace {
        origin: [header.origin_x, header.origin_y],
        resolution: header.resolution,
        width: header.width,
    };
    grid::coloured(&place, time_ns, data)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_coloured_by_row_and_a_wrong_header_draws_nothing() {
        let header = MapHeader {
            width: 2,
            height: 1,
            resolution: 0.5,
            ..MapHeader::default()
        };
        let cells = [
            MapCell {
                occupied: 1,
                ..MapCell::default()
            },
            MapCell {
                blurred: 1.0,
                ..MapCell::default()
            },
        ];
        let grid = draw(&header, 1_500_000_000, cells.into_iter()).unwrap();
        assert_eq!(grid.data.as_ref(), [60, 60, 60, 255, 255, 255, 255, 255]);
        assert_eq!((grid.row_stride, grid.column_count), (8, 2));
        let lie = MapHeader {
            width: u32::MAX,
            height: u32::MAX,
            ..header
        };
        assert!(draw(&lie, 0, cells.into_iter()).is_none());
        assert!(draw(&MapHeader::default(), 0, [].into_iter()).is_none());
    }
}
