//! Colours of the viewer topics.

use draw::palette;
use foxglove::messages::Color;

/// Colour of obstacles that appear and disappear: orange.
pub(super) const OBSTACLE: Color = color(palette::rgb(palette::OBSTACLE), 0.85);
/// Colour of obstacles that exist from the beginning: grey, as on the map.
pub(super) const BUILDING: Color = color([105, 112, 122], 1.0);
/// Colour of lines of sight: reddish purple.
pub(super) const SIGHT: Color = color(palette::rgb(palette::BELIEF), 1.0);
/// Opacity of visible areas and of their borders; lower layers stay visible.
pub(super) const SEEN: (f64, f64) = (0.1, 0.4);
/// Colour of names and headings: black.
pub(super) const INK: Color = color([0, 0, 0], 1.0);
/// Grey level of a cell in an obstacle.
pub(super) const WALL_GREY: u8 = 60;
/// Grey level of a free cell beside an obstacle; far from obstacles a cell is white.
pub(super) const EDGE_GREY: u8 = 200;

/// The Police: blue.
pub(super) const POLICE: [u8; 3] = palette::rgb(palette::POLICE);
/// Evaders: vermilion.
pub(super) const EVADER: [u8; 3] = palette::rgb(palette::EVADER);
/// Cells that evaders reach first, but not safely: orange.
pub(super) const CUT_OFF: [u8; 3] = palette::rgb(palette::OBSTACLE);

const fn color([r, g, b]: [u8; 3], a: f64) -> Color {
    Color {
        r: r as f64 / 255.0,
        g: g as f64 / 255.0,
        b: b as f64 / 255.0,
        a,
    }
}

/// Returns the colour of a team by its code in `RobotState`: police blue, evaders vermilion, others bluish
/// green; paler for a robot that is out of the game.
pub(super) fn team(team: u8, active: bool) -> Color {
    let alpha = if active { 1.0 } else { 0.35 };
    match team {
        1 => color(POLICE, alpha),
        2 => color(EVADER, alpha),
        _ => color(palette::rgb(palette::NEUTRAL), alpha),
    }
}
