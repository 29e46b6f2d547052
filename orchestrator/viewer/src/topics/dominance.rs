//! Dominance regions of the teams, as coloured cells over the map.

use foxglove::messages::Grid;
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::referee::{DominanceCell, DominanceHeader};
use ipc_types::topics::{Dominance, TopicId};

use super::channel::ViewerChannel;
use super::grid::{self, GridPlace};
use super::palette;
use super::picture::Picture;

/// Margin at which the opacity is maximal (s).
const STRONG: f32 = 10.0;
/// Minimum and maximum opacity (0 to 255).
const ALPHA: (f32, f32) = (30.0, 120.0);

/// `/viewer/dominance`, for every message of a referee.
pub(super) struct DominanceTopic(ViewerChannel<Grid>);

impl DominanceTopic {
    pub(super) fn new(picture: &mut Picture) -> Self {
        Self(picture.add_channel("/viewer/dominance"))
    }
}

impl Consumer<Picture> for DominanceTopic {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::Dominance]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, picture: &mut Picture) {
        if let Some((header, cells)) = message.view::<Dominance>()
            && let Some(grid) = draw(&header, message.time_ns, cells)
        {
            self.0.write(&mut picture.ready, message.time_ns, &grid);
        }
    }
}

/// Draws dominance regions: cells that a team reaches first are in its colour, with opacity increasing with
/// the margin; cells that an evader reaches first, but not safely, are pale orange. Returns `None` if the
/// number of cells differs from the header.
fn draw(
    header: &DominanceHeader,
    time_ns: u64,
    cells: impl ExactSizeIterator<Item = DominanceCell>,
) -> Option<Grid> {
    if !grid::fits(header.width, header.height, cells.len()) {
        return None;
    }
    let mut data = Vec::with_capacity(cells.len() * grid::CELL_BYTES);
    for cell in cells {
        // `min` ignores NaN; a cast of a float saturates.
        let strength = cell.margin.abs().min(STRONG) / STRONG;
        let alpha = (ALPHA.0 + (ALPHA.1 - ALPHA.0) * strength) as u8;
        let ([red, green, blue], alpha) = match cell.owner {
            1 => (palette::POLICE, alpha),
            2 => (palette::EVADER, alpha),
            3 => (palette::CUT_OFF, ALPHA.0 as u8),
            _ => ([0; 3], 0),
        };
        data.extend_from_slice(&[red, green, blue, alpha]);
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

    fn cell(owner: u8, margin: f32) -> DominanceCell {
        DominanceCell {
            margin,
            owner,
            ..DominanceCell::default()
        }
    }

    #[test]
    fn teams_set_the_colour_and_margins_the_opacity() {
        let header = DominanceHeader {
            width: 5,
            height: 1,
            resolution: 0.2,
            ..DominanceHeader::default()
        };
        let cells = [
            cell(0, 0.0),
            cell(1, -1.0),
            cell(2, f32::INFINITY),
            cell(3, 4.0),
            cell(2, f32::NAN),
        ];
        let grid = draw(&header, 0, cells.into_iter()).unwrap();
        let (cells, _) = grid.data.as_chunks::<4>();
        assert_eq!(cells[0], [0; 4]);
        assert_eq!(cells[1][..3], palette::POLICE);
        assert_eq!(cells[2], [213, 94, 0, 120]);
        assert_eq!(cells[3][..3], palette::CUT_OFF);
        assert!(cells[1][3] < cells[2][3]);
        assert!(draw(&header, 0, [cell(1, 0.0)].into_iter()).is_none());
    }
}
