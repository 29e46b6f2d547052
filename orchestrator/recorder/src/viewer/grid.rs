//! The map as coloured cells.

use foxglove::messages::{Grid, PackedElementField, Vector2, packed_element_field::NumericType};
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::{MapCell, MapHeader};
use ipc_types::topics::{TopicId, WorldMap};

use super::again::Again;
use super::channel::ViewerChannel;
use super::scene::pose;
use super::{MAP_FRAME, Picture, palette, timestamp};

/// Bytes of a cell: red, green, blue, alpha.
const STRIDE: u32 = 4;

/// `/viewer/map`, at every revision, and again now and then.
pub(super) struct MapTopic {
    channel: ViewerChannel<Grid>,
    grid: Option<Grid>,
    again: Again,
}

impl MapTopic {
    pub(super) fn new(picture: &mut Picture) -> Self {
        Self {
            channel: picture.add_channel("/viewer/map"),
            grid: None,
            again: Again::default(),
        }
    }

    fn draw(&mut self, time_ns: u64, picture: &mut Picture) {
        if let Some(grid) = &mut self.grid {
            grid.timestamp = Some(timestamp(time_ns));
            let bytes = self.channel.write(&mut picture.ready, time_ns, grid);
            self.again.drawn(time_ns, bytes);
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
        if self.again.is_due(picture.now_ns()) {
            self.draw(picture.now_ns(), picture);
        }
    }
}

/// Whether that many cells are those of a grid of this size, which has some.
pub(super) fn fits(width: u32, height: u32, cells: usize) -> bool {
    cells > 0 && u64::from(width) * u64::from(height) == cells as u64
}

/// Draws a map: obstacles dark, free cells the whiter the farther obstacles are (by the blurred
/// map). `None` if the header and the number of cells do not belong together.
fn draw(
    header: &MapHeader,
    time_ns: u64,
    cells: impl ExactSizeIterator<Item = MapCell>,
) -> Option<Grid> {
    if !fits(header.width, header.height, cells.len()) {
        return None;
    }
    let mut data = Vec::with_capacity(cells.len() * STRIDE as usize);
    for cell in cells {
        let grey = if cell.occupied != 0 {
            palette::WALL_GREY
        } else {
            let edge = f32::from(palette::EDGE_GREY);
            // A cast of a float saturates, also for what is not a number.
            (edge + (255.0 - edge) * cell.blurred.clamp(0.0, 1.0)) as u8
        };
        data.extend_from_slice(&[grey, grey, grey, u8::MAX]);
    }
    let frame = Frame {
        origin: [header.origin_x, header.origin_y],
        resolution: header.resolution,
        width: header.width,
    };
    colours(&frame, time_ns, data)
}

/// Where coloured cells lie.
pub(super) struct Frame {
    /// Outer corner of the first cell (m).
    pub(super) origin: [f64; 2],
    /// Side of a cell (m).
    pub(super) resolution: f64,
    /// Columns.
    pub(super) width: u32,
}

/// Cells of red, green, blue and alpha bytes; `None` if a row has more bytes than can be said.
pub(super) fn colours(frame: &Frame, time_ns: u64, data: Vec<u8>) -> Option<Grid> {
    let row_stride = frame.width.checked_mul(STRIDE)?;
    let field = |(offset, name): (u32, &str)| PackedElementField {
        name: name.to_owned(),
        offset,
        r#type: NumericType::Uint8 as i32,
    };
    Some(Grid {
        timestamp: Some(timestamp(time_ns)),
        frame_id: MAP_FRAME.to_owned(),
        pose: Some(pose(frame.origin[0], frame.origin[1], 0.0, 0.0)),
        column_count: frame.width,
        cell_size: Some(Vector2 {
            x: frame.resolution,
            y: frame.resolution,
        }),
        row_stride,
        cell_stride: STRIDE,
        fields: [(0, "red"), (1, "green"), (2, "blue"), (3, "alpha")]
            .map(field)
            .to_vec(),
        data: data.into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_coloured_by_row_and_a_lying_header_draws_nothing() {
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
