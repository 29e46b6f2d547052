//! Dominance regions of the teams, as coloured cells over the map.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::referee::{DominanceCell, DominanceHeader};
use ipc_types::topics::{Dominance, TopicId};

use super::channel::ViewerChannel;
use super::picture::Picture;
use super::primitives::{kind, marker, picture};
use super::{grid, palette};
use ros_messages::messages::{ColorRGBA, MarkerArray, Point, Vector3};

/// Margin at which the colour is strongest (s).
const STRONG: f32 = 10.0;
/// Minimum and maximum share of a team's colour in that of a cell; the rest is white. Foxglove Studio ignores the opacity
/// of cubes.
const SHARE: (f32, f32) = (0.25, 0.6);
/// Height of a cell (m): above the map.
const HEIGHT: f64 = 0.005;

/// `/dominance`, for every message of a referee.
pub(super) struct DominanceTopic(ViewerChannel<MarkerArray>);

impl DominanceTopic {
    pub(super) fn new(picture: &mut Picture) -> Self {
        Self(picture.add_latched_channel("/dominance"))
    }
}

impl Consumer<Picture> for DominanceTopic {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::Dominance]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, picture: &mut Picture) {
        if let Some((header, cells)) = message.view::<Dominance>()
            && let Some(regions) = draw(&header, message.time_ns, cells)
        {
            self.0.write(&mut picture.ready, message.time_ns, &regions);
        }
    }
}

/// Draws dominance regions: cells that a team reaches first are in its colour, the stronger the larger the margin; cells that an evader reaches first, but not safely, are pale orange. Returns `None` if the
/// number of cells differs from the header.
fn draw(
    header: &DominanceHeader,
    time_ns: u64,
    cells: impl ExactSizeIterator<Item = DominanceCell>,
) -> Option<MarkerArray> {
    if !grid::fits(header.width, header.height, cells.len()) {
        return None;
    }
    let mut regions = picture(time_ns);
    let mut marker = marker(
        "dominance",
        0,
        kind::CUBE_LIST,
        ColorRGBA::default(),
        time_ns,
    );
    let side = header.resolution;
    marker.scale = Vector3 {
        x: side,
        y: side,
        z: HEIGHT,
    };
    for (index, cell) in (0_u32..).zip(cells) {
        // `min` ignores NaN.
        let strength = cell.margin.abs().min(STRONG) / STRONG;
        let share = SHARE.0 + (SHARE.1 - SHARE.0) * strength;
        let (rgb, share) = match cell.owner {
            1 => (palette::PURSUER, share),
            2 => (palette::EVADER, share),
            3 => (palette::CUT_OFF, SHARE.0),
            _ => continue,
        };
        let centre = |origin: f64, cell: u32| origin + (f64::from(cell) + 0.5) * side;
        marker.points.push(Point {
            x: centre(header.origin_x, index % header.width),
            y: centre(header.origin_y, index / header.width),
            z: HEIGHT / 2.0,
        });
        marker.colors.push(palette::pale(rgb, share));
    }
    // Viewers refuse a list without points.
    if !marker.points.is_empty() {
        regions.markers.push(marker);
    }
    Some(regions)
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
    fn teams_set_the_colour_and_margins_its_strength_without_opacity() {
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
        let regions = draw(&header, 0, cells.into_iter()).unwrap();
        let marker = &regions.markers[1];
        let columns: Vec<f64> = marker.points.iter().map(|p| p.x).collect();
        assert_eq!(columns, [0.2 * 1.5, 0.2 * 2.5, 0.2 * 3.5, 0.2 * 4.5]);
        let colors = &marker.colors;
        assert_eq!(colors[1], palette::pale(palette::EVADER, SHARE.1));
        assert_eq!(colors[2], palette::pale(palette::CUT_OFF, SHARE.0));
        assert!(colors[0].r > palette::pale(palette::PURSUER, SHARE.1).r);
        assert!(colors.iter().all(|color| color.a == 1.0));
        assert!(draw(&header, 0, [cell(1, 0.0)].into_iter()).is_none());
        let none = draw(&header, 0, [cell(0, 0.0); 5].into_iter()).unwrap();
        assert_eq!(none.markers.len(), 1, "removes the earlier regions");
    }
}
