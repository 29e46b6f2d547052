//! The map and the frame in its middle.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::{MapCell, MapHeader};
use ipc_types::topics::{TopicId, WorldMap};

use super::channel::ViewerChannel;
use super::grid;
use super::picture::Picture;
use super::primitives::{header, pose, time, transform};
use super::repetition::Repetition;
use ros_messages::messages::{MapMetaData, OccupancyGrid, TFMessage};

/// Frame in the middle of the map, as target of cameras; robot names cannot contain `/`.
const CENTRE_FRAME: &str = "map/centre";

/// Value of an occupied cell.
const OCCUPIED: i8 = 100;

/// `/map` and `/tf_static`, at every revision, and repeated.
pub(super) struct MapTopic {
    map: ViewerChannel<OccupancyGrid>,
    frames: ViewerChannel<TFMessage>,
    /// Map and its middle (m).
    drawn: Option<(OccupancyGrid, [f64; 2])>,
    repetition: Repetition,
}

impl MapTopic {
    pub(super) fn new(picture: &mut Picture) -> Self {
        Self {
            map: picture.add_latched_channel("/map"),
            frames: picture.add_latched_channel("/tf_static"),
            drawn: None,
            repetition: Repetition::default(),
        }
    }

    fn draw(&mut self, time_ns: u64, picture: &mut Picture) {
        if let Some((grid, centre)) = &mut self.drawn {
            grid.header.stamp = time(time_ns);
            let bytes = self.map.write(&mut picture.ready, time_ns, grid);
            let frames = TFMessage {
                transforms: vec![transform(CENTRE_FRAME, *centre, 0.0, time_ns)],
            };
            self.frames.write(&mut picture.ready, time_ns, &frames);
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
            self.drawn = Some((grid, centre(&header)));
            self.draw(message.time_ns, picture);
        }
    }

    fn end_of_tick(&mut self, picture: &mut Picture) {
        if self.repetition.is_due(picture.now_ns()) {
            self.draw(picture.now_ns(), picture);
        }
    }
}

/// Returns the middle of a map (m).
fn centre(of: &MapHeader) -> [f64; 2] {
    let middle = |origin: f64, cells: u32| origin + 0.5 * f64::from(cells) * of.resolution;
    [
        middle(of.origin_x, of.width),
        middle(of.origin_y, of.height),
    ]
}

/// Converts a map; returns `None` if the number of cells differs from the header.
fn draw(
    of: &MapHeader,
    time_ns: u64,
    cells: impl ExactSizeIterator<Item = MapCell>,
) -> Option<OccupancyGrid> {
    if !grid::fits(of.width, of.height, cells.len()) {
        return None;
    }
    Some(OccupancyGrid {
        header: header(time_ns),
        info: MapMetaData {
            map_load_time: time(0),
            resolution: of.resolution as f32,
            width: of.width,
            height: of.height,
            origin: pose(of.origin_x, of.origin_y, 0.0, 0.0),
        },
        data: cells
            .map(|cell| if cell.occupied != 0 { OCCUPIED } else { 0 })
            .collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_free_or_occupied_and_a_wrong_header_draws_nothing() {
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
        assert_eq!(grid.data, [100, 0]);
        assert_eq!(centre(&header), [0.5, 0.25]);
        let lie = MapHeader {
            width: u32::MAX,
            height: u32::MAX,
            ..header
        };
        assert!(draw(&lie, 0, cells.into_iter()).is_none());
        assert!(draw(&MapHeader::default(), 0, [].into_iter()).is_none());
    }
}
