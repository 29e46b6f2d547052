//! Who reaches what first, as coloured cells over the map.

use foxglove::messages::Grid;
use ipc_types::messages::referee::{DominanceCell, DominanceHeader};

use super::{grid, palette};

/// Margin beyond which a cell is coloured no stronger [s].
const STRONG: f32 = 10.0;
/// Weakest and strongest opacity.
const ALPHA: (f32, f32) = (30.0, 120.0);

/// Draws dominance: cells that evaders reach safely in their colour, the pursuers' in theirs, the
/// stronger the greater the margin; cells that an evader would reach first, but not safely, in pale
/// orange. `None` if the header and the number of cells do not belong together.
pub(super) fn draw(
    header: &DominanceHeader,
    time_ns: u64,
    cells: impl ExactSizeIterator<Item = DominanceCell>,
) -> Option<Grid> {
    let count = u64::from(header.width) * u64::from(header.height);
    if count != cells.len() as u64 || count == 0 {
        return None;
    }
    let mut data = Vec::with_capacity(cells.len() * 4);
    for cell in cells {
        // `min` takes the other of a NaN; a cast of a float saturates.
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
    let frame = grid::Frame {
        origin: [header.origin_x, header.origin_y],
        resolution: header.resolution,
        width: header.width,
    };
    grid::colours(&frame, time_ns, data)
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
    fn sides_have_their_colours_and_margins_their_strength() {
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
