//! Colours of the viewer topics.

use draw::palette;

use ros_messages::messages::ColorRGBA;

/// Colour of obstacles that appear and disappear: orange.
pub(super) const OBSTACLE: ColorRGBA = color(palette::rgb(palette::OBSTACLE), 0.85);
/// Colour of obstacles that exist from the beginning: grey, as on the map.
pub(super) const BUILDING: ColorRGBA = color([105, 112, 122], 1.0);
/// Colour of lines of sight: reddish purple.
pub(super) const SIGHT: ColorRGBA = color(palette::rgb(palette::BELIEF), 1.0);
/// Opacity of visible areas; lower layers stay visible.
pub(super) const SEEN: f32 = 0.12;
/// Colour of names and headings: black.
pub(super) const INK: ColorRGBA = color([0, 0, 0], 1.0);

/// The Police: blue.
pub(super) const PURSUER: [u8; 3] = palette::rgb(palette::PURSUER);
/// Evaders: vermilion.
pub(super) const EVADER: [u8; 3] = palette::rgb(palette::EVADER);
/// Cells that evaders reach first, but not safely: orange.
pub(super) const CUT_OFF: [u8; 3] = palette::rgb(palette::OBSTACLE);

/// Returns a colour with an opacity, 0 to 1.
pub(super) const fn color([r, g, b]: [u8; 3], a: f32) -> ColorRGBA {
    ColorRGBA {
        r: r as f32 / 255.0,
        g: g as f32 / 255.0,
        b: b as f32 / 255.0,
        a,
    }
}

/// Returns the colour of a role by its code in `RobotState`: pursuers blue, evaders vermilion, others bluish
/// green.
pub(super) fn role(role: u8, alpha: f32) -> ColorRGBA {
    match role {
        1 => color(PURSUER, alpha),
        2 => color(EVADER, alpha),
        _ => color(palette::rgb(palette::NEUTRAL), alpha),
    }
}

/// Returns a colour mixed with white: its share is 0 to 1.
pub(super) const fn pale(rgb: [u8; 3], share: f32) -> ColorRGBA {
    let strong = color(rgb, 1.0);
    ColorRGBA {
        r: 1.0 - share * (1.0 - strong.r),
        g: 1.0 - share * (1.0 - strong.g),
        b: 1.0 - share * (1.0 - strong.b),
        a: 1.0,
    }
}
