//! Colours that people with any colour vision tell apart (Okabe and Ito's palette, the one that
//! the log's viewer topics use), as SVG writes them.

use sim_backend::team::Team;

/// The paper.
pub(crate) const PAPER: &str = "#ffffff";
/// Walls and blocks: light enough to write on.
pub(crate) const WALL: &str = "#cfd4db";
/// Outlines of walls, the frame.
pub(crate) const EDGE: &str = "#9aa3ae";
/// Text.
pub(crate) const INK: &str = "#1f2430";
/// Text that matters less.
pub(crate) const FAINT_INK: &str = "#5b6472";
/// Obstacles that came during the run: orange.
pub(crate) const OBSTACLE: &str = "#e69f00";
/// Exits: bluish green.
pub(crate) const EXIT: &str = "#009e73";
/// The Police: blue.
pub(crate) const POLICE: &str = "#0072b2";
/// Evaders: vermilion.
pub(crate) const EVADER: &str = "#d55e00";
const NEUTRAL: &str = "#009e73";
/// Particles of a belief: reddish purple.
pub(crate) const BELIEF: &str = "#cc79a7";
/// Names of beliefs: the same, dark enough to read.
pub(crate) const BELIEF_INK: &str = "#8f3d6c";

/// The colour of a team's robot that is out of the game: paler.
pub(crate) fn out_of_play(team: &str) -> &'static str {
    match team {
        POLICE => "#80b8d8",
        EVADER => "#eaaf80",
        _ => "#80cfb9",
    }
}

/// Colour of a team: police blue, evaders vermilion, others bluish green.
pub(crate) fn team(team: Team) -> &'static str {
    match team {
        Team::Police => POLICE,
        Team::Evader => EVADER,
        Team::Neutral => NEUTRAL,
    }
}
