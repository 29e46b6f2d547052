//! Colours that are distinguishable with any colour vision (Okabe and Ito's palette), as `#rrggbb`.

use robot::team::Role;

/// Background.
pub const PAPER: &str = "#ffffff";
/// Walls and blocks: light enough for text on top.
pub const WALL: &str = "#cfd4db";
/// Outlines of walls and of the frame.
pub const EDGE: &str = "#9aa3ae";
/// Text.
pub const INK: &str = "#1f2430";
/// Secondary text.
pub const FAINT_INK: &str = "#5b6472";
/// Obstacles that appeared during the run: orange.
pub const OBSTACLE: &str = "#e69f00";
/// Exits: bluish green.
pub const EXIT: &str = "#009e73";
/// Pursuers: blue.
pub const PURSUER: &str = "#0072b2";
/// Evaders: vermilion.
pub const EVADER: &str = "#d55e00";
/// Neutral robots: bluish green.
pub const NEUTRAL: &str = "#009e73";
/// Particles of a belief: reddish purple.
pub const BELIEF: &str = "#cc79a7";
/// Names of beliefs: the same hue, dark enough for text.
pub const BELIEF_INK: &str = "#8f3d6c";

/// Shades of the colour of pursuers, the first the colour itself.
const PURSUER_SHADES: [&str; 4] = [PURSUER, "#56b4e9", "#003a63", "#6a5acd"];
/// Shades of the colour of the evaders.
const EVADER_SHADES: [&str; 4] = [EVADER, "#f5945c", "#8c2d04", "#a6761d"];
/// Shades of the colour of neutral robots.
const NEUTRAL_SHADES: [&str; 4] = [NEUTRAL, "#66c2a5", "#00573f", "#8a9a00"];
/// Times since the last visit of ground, the latest visits first: blue to vermilion.
pub const IDLENESS: [&str; 4] = [PURSUER, "#56b4e9", "#f0e442", EVADER];

/// Returns the paler colour of a robot that is out of the game: halfway to the background.
pub fn out_of_play(color: &str) -> String {
    let [r, g, b] = rgb(color).map(|part| u16::from(part).midpoint(256));
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Returns the colour of a role: pursuers blue, evaders vermilion, others bluish green.
pub fn role(role: Role) -> &'static str {
    shades(role)[0]
}

/// Returns the shades of a role's colour, which tell its robots apart; the first is that of the role.
pub fn shades(role: Role) -> [&'static str; 4] {
    match role {
        Role::Pursuer => PURSUER_SHADES,
        Role::Evader => EVADER_SHADES,
        Role::Neutral => NEUTRAL_SHADES,
    }
}

/// Returns the bounds of the times since the last visit (s) that [`IDLENESS`] distinguishes: the first colour is for
/// times below the first bound, the last for all from the last bound. `end_s` is the end of the run or picture.
///
/// ```
/// assert_eq!(draw::palette::idleness_bounds(900.0), [50.0, 100.0, 200.0]);
/// ```
pub fn idleness_bounds(end_s: f64) -> [f64; IDLENESS.len() - 1] {
    // The largest of 1, 2 or 5 times a power of ten that is at most half the run; powers of ten are exact here.
    let half = (end_s / 2.0).clamp(1e-3, 1e9);
    let steps = (-3..=9).flat_map(|power| [1.0, 2.0, 5.0].map(|step| step * 10.0_f64.powi(power)));
    let last = steps
        .take_while(|step| *step <= half)
        .last()
        .unwrap_or(half);
    [last / 4.0, last / 2.0, last]
}

/// Returns red, green and blue of a colour `#rrggbb`.
pub const fn rgb(color: &str) -> [u8; 3] {
    let digits = color.as_bytes();
    [pair(digits, 1), pair(digits, 3), pair(digits, 5)]
}

const fn pair(digits: &[u8], at: usize) -> u8 {
    digit(digits[at]) << 4 | digit(digits[at + 1])
}

const fn digit(letter: u8) -> u8 {
    match letter {
        b'0'..=b'9' => letter - b'0',
        _ => letter - b'a' + 10,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colour_has_the_components_of_its_digits() {
        assert_eq!(rgb("#0072b2"), [0, 114, 178]);
        assert_eq!(rgb("#ffffff"), [255, 255, 255]);
        assert_eq!(out_of_play("#0072b2"), "#80b9d9");
    }
}
