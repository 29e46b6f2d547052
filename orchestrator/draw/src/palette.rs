//! Colours that are distinguishable with any colour vision (Okabe and Ito's palette), as `#rrggbb`.

use sim_backend::team::Team;

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
/// The Police: blue.
pub const POLICE: &str = "#0072b2";
/// Evaders: vermilion.
pub const EVADER: &str = "#d55e00";
/// Neutral robots: bluish green.
pub const NEUTRAL: &str = "#009e73";
/// Particles of a belief: reddish purple.
pub const BELIEF: &str = "#cc79a7";
/// Names of beliefs: the same hue, dark enough for text.
pub const BELIEF_INK: &str = "#8f3d6c";

/// Returns the paler colour of a robot that is out of the game.
pub fn out_of_play(team: &str) -> &'static str {
    match team {
        POLICE => "#80b8d8",
        EVADER => "#eaaf80",
        _ => "#80cfb9",
    }
}

/// Returns the colour of a team: police blue, evaders vermilion, others bluish green.
pub fn team(team: Team) -> &'static str {
    match team {
        Team::Police => POLICE,
        Team::Evader => EVADER,
        Team::Neutral => NEUTRAL,
    }
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
    }
}
