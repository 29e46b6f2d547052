//! Errors of a specification of a world.

use geometry::map::MapError;
use parameters::ParamsError;

/// Reason why a world cannot be created from its specification.
#[derive(Debug, thiserror::Error)]
pub enum WorldError {
    /// The map is invalid.
    #[error(transparent)]
    Map(#[from] MapError),
    /// A rule has a value out of its range.
    #[error("{}", .0.clone().within("rules"))]
    Rules(ParamsError),
    /// A robot has a value out of its range.
    #[error("robots[{index}]{}: {source}", quoted(name))]
    Robot {
        /// Index of the robot.
        index: usize,
        /// Its name.
        name: String,
        /// Error of the value.
        source: ParamsError,
    },
    /// The world has no robots.
    #[error("robots: the world has no robots: expected at least one")]
    NoRobots,
    /// More robots than the maximum.
    #[error("robots: {0} robots: expected at most {max}", max = super::MAX_ROBOTS)]
    TooManyRobots(usize),
    /// Two robots with the same name.
    #[error("robots[{second}] is called \"{name}\" like robots[{first}]: expected unique names")]
    DuplicateName {
        /// The name.
        name: String,
        /// Index of the first robot with this name.
        first: usize,
        /// Index of the second robot with this name.
        second: usize,
    },
    /// A robot is beyond the edge of the map.
    #[error(
        "robots[{index}] \"{name}\" is outside the map: at ({x}, {y}): expected x in \
         [{}, {}] and y in [{}, {}] [m]", min[0], max[0], min[1], max[1]
    )]
    OutsideMap {
        /// Index of the robot.
        index: usize,
        /// Its name.
        name: String,
        /// Place, x (m).
        x: f64,
        /// Place, y (m).
        y: f64,
        /// Smallest coordinates of the map (m).
        min: [f64; 2],
        /// Largest coordinates of the map (m).
        max: [f64; 2],
    },
    /// A robot is in an obstacle or too near to one.
    #[error(
        "robots[{index}] \"{name}\" is in a wall: at ({x}, {y}) the nearest obstacle is \
         {clearance:.4} m away: expected at least its radius of {radius} m"
    )]
    InWall {
        /// Index of the robot.
        index: usize,
        /// Its name.
        name: String,
        /// Place, x (m).
        x: f64,
        /// Place, y (m).
        y: f64,
        /// Distance from its centre to the nearest obstacle (m).
        clearance: f64,
        /// Required clearance (m).
        radius: f64,
    },
    /// A robot that is to be moved has left the game.
    #[error("robots[{index}] \"{name}\" has left the game: expected a robot in the game")]
    LeftTheGame {
        /// Index of the robot.
        index: usize,
        /// Its name.
        name: String,
    },
    /// Two robots overlap.
    #[error(
        "robots[{first}] \"{first_name}\" and robots[{second}] \"{second_name}\" overlap: \
         their centres are {distance:.4} m apart: expected at least {needed:.4} m"
    )]
    Overlap {
        /// Index of the first.
        first: usize,
        /// Its name.
        first_name: String,
        /// Index of the second.
        second: usize,
        /// Its name.
        second_name: String,
        /// Distance of their centres (m).
        distance: f64,
        /// Sum of their radii (m).
        needed: f64,
    },
    /// No path leads an evader to any exit.
    #[error(
        "robots[{index}] \"{name}\" cannot reach any exit: no path from ({x}, {y}) is wide enough \
         for its radius of {radius} m"
    )]
    ExitUnreachable {
        /// Index of the evader.
        index: usize,
        /// Its name.
        name: String,
        /// Start, x (m).
        x: f64,
        /// Start, y (m).
        y: f64,
        /// Radius (m).
        radius: f64,
    },
    /// No path leads a robot to its goal.
    #[error(
        "robots[{index}] \"{name}\" cannot reach its goal: no path from ({x}, {y}) is wide enough \
         for its radius of {radius} m"
    )]
    GoalUnreachable {
        /// Index of the robot.
        index: usize,
        /// Its name.
        name: String,
        /// Start, x (m).
        x: f64,
        /// Start, y (m).
        y: f64,
        /// Radius (m).
        radius: f64,
    },
}

fn quoted(name: &str) -> String {
    if name.is_empty() {
        String::new()
    } else {
        format!(" \"{name}\"")
    }
}
