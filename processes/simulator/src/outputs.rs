//! The world as messages.

use core::time::Duration;

use geometry::blur::{BlurError, BlurredMap};
use geometry::map::WorldMap;
use ipc_types::messages::world::{CoverageState, MapCell, MapHeader, RobotState, WorldEvent};
use ipc_types::stamp::Stamp;
use sim_backend::robot::{Robot, RobotStatus};
use sim_backend::world::{ContactWith, Coverage, EventKind};

/// Codes of [`WorldEvent::NAMES`].
mod code {
    pub const CAPTURED: u32 = 0;
    pub const ESCAPED: u32 = 1;
    pub const TIMED_OUT: u32 = 2;
    pub const GOAL_REACHED: u32 = 3;
    pub const CONTACT_BEGIN: u32 = 4;
    pub const CONTACT_END: u32 = 5;
    pub const INVALID_COMMAND: u32 = 6;
    pub const MISSING_COMMAND: u32 = 7;
    pub const OBSTACLE: u32 = 8;
    pub const GAME_OVER: u32 = 9;
    pub const PUSHED_OUT: u32 = 10;
    pub const TRAPPED: u32 = 11;
    pub const RELEASED: u32 = 12;
    pub const STANDS: u32 = 13;
}

/// Status code of [`RobotState`].
fn status_code(status: RobotStatus) -> u8 {
    match status {
        RobotStatus::Active => 0,
        RobotStatus::Caught => 1,
        RobotStatus::Escaped => 2,
        RobotStatus::TimedOut => 3,
        RobotStatus::Arrived => 4,
    }
}

/// Flags of a robot in a state message beyond those of the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Flags {
    /// It was in contact in the last step.
    pub in_contact: bool,
    /// Stopped because there is no valid command.
    pub fail_safe: bool,
    /// Its body is in the world.
    pub present: bool,
}

/// Returns the message of `world/coverage` at the time `now` of the world.
pub fn coverage_state(coverage: &Coverage, now: Duration) -> CoverageState {
    let figures = coverage.figures(now);
    let resolution = coverage.frame().resolution;
    // Grids have far fewer than 2^32 cells.
    CoverageState {
        fraction: figures.fraction(),
        coverable_fraction: figures.coverable_fraction(),
        cell_area: resolution * resolution,
        mean_idleness: figures.mean_idleness,
        max_idleness: figures.max_idleness,
        worst_idleness: figures.worst_idleness,
        unevenness: figures.unevenness,
        way: figures.way,
        visits: figures.visits,
        free: figures.free as u32,
        visited: figures.visited as u32,
        coverable: figures.coverable as u32,
        covered: figures.covered as u32,
    }
}

/// Returns one robot of `world/state`.
pub fn robot_state(index: usize, robot: &Robot, flags: Flags) -> RobotState {
    RobotState {
        x: robot.pose.x,
        y: robot.pose.y,
        theta: robot.pose.theta,
        v: robot.twist.v,
        omega: robot.twist.omega,
        distance: robot.distance_travelled,
        robot: index as u32,
        contacts: robot.contacts.episodes(),
        team: robot.team.role.code(),
        status: status_code(robot.status),
        in_contact: u8::from(flags.in_contact),
        fail_safe: u8::from(flags.fail_safe),
        present: u8::from(flags.present),
        reserved: [0; 3],
    }
}

/// Returns one event of `world/event`.
pub fn world_event(kind: &EventKind, robots: &[Robot]) -> WorldEvent {
    let none = WorldEvent::NONE;
    let partner = |with: &ContactWith| match with {
        ContactWith::Wall => none,
        ContactWith::Robot(other) => *other as u32,
    };
    let (code, robot, other, value) = match kind {
        EventKind::Captured {
            evader,
            by,
            distance,
        } => (code::CAPTURED, *evader as u32, *by as u32, *distance),
        EventKind::Escaped { robot, exit } => (code::ESCAPED, *robot as u32, *exit as u32, 0.0),
        EventKind::Arrived { robot } => (code::GOAL_REACHED, *robot as u32, none, 0.0),
        EventKind::TimedOut { robot } => (code::TIMED_OUT, *robot as u32, none, 0.0),
        EventKind::ContactBegan { robot, with } => {
            (code::CONTACT_BEGIN, *robot as u32, partner(with), 0.0)
        }
        EventKind::ContactEnded { robot, with } => {
            (code::CONTACT_END, *robot as u32, partner(with), 0.0)
        }
        EventKind::InvalidCommand { robot } => (code::INVALID_COMMAND, *robot as u32, none, 0.0),
        EventKind::ObstacleApplied { id, action, .. } => {
            (code::OBSTACLE, none, id.0, f64::from(*action as u8))
        }
        EventKind::PushedOut { robot, distance } => {
            (code::PUSHED_OUT, *robot as u32, none, *distance)
        }
        EventKind::Trapped { robot } => (code::TRAPPED, *robot as u32, none, 0.0),
        EventKind::Released { robot } => (code::RELEASED, *robot as u32, none, 0.0),
        EventKind::Stands { robot, seconds } => (code::STANDS, *robot as u32, none, *seconds),
        EventKind::GameOver { reason } => (code::GAME_OVER, none, none, f64::from(*reason as u8)),
    };
    at_robot(
        WorldEvent {
            value,
            kind: code,
            robot,
            other,
            ..WorldEvent::default()
        },
        robots,
    )
}

/// Returns the event of a robot with a driver but without a command.
pub fn missing_command(robot: usize, robots: &[Robot]) -> WorldEvent {
    let event = WorldEvent {
        kind: code::MISSING_COMMAND,
        robot: robot as u32,
        other: WorldEvent::NONE,
        ..WorldEvent::default()
    };
    at_robot(event, robots)
}

fn at_robot(mut event: WorldEvent, robots: &[Robot]) -> WorldEvent {
    if let Some(robot) = robots.get(event.robot as usize) {
        event.x = robot.pose.x;
        event.y = robot.pose.y;
    }
    event
}

/// Returns the revision of the map in messages: from 1, so that 0 can mean "no map yet".
pub fn revision(map: &WorldMap) -> u32 {
    map.revision() as u32 + 1
}

/// Returns `world/map` for the current map.
///
/// # Errors
/// [`BlurError`] if the map cannot be blurred with this deviation (m).
pub fn map_message(
    map: &WorldMap,
    blur_sigma: f64,
    stamp: Stamp,
) -> Result<(MapHeader, Vec<MapCell>), BlurError> {
    let frame = map.frame();
    let occupied = map.occupancy();
    let blurred = BlurredMap::of_occupied(occupied, blur_sigma)?;
    let header = MapHeader {
        stamp,
        resolution: frame.resolution,
        origin_x: frame.origin.x,
        origin_y: frame.origin.y,
        blur_sigma,
        width: frame.width as u32,
        height: frame.height as u32,
        revision: revision(map),
        reserved: 0,
    };
    let cells = map
        .clearance()
        .cells
        .iter()
        .zip(&blurred.grid().cells)
        .zip(&occupied.cells)
        .map(|((&clearance, &blurred), &occupied)| MapCell {
            clearance,
            blurred,
            occupied: u8::from(occupied),
            ..MapCell::default()
        })
        .collect();
    Ok((header, cells))
}

/// Returns the largest number of events of one tick, with this number of robots and of obstacle changes.
pub(crate) fn max_events(robots: usize, changes: usize) -> usize {
    // Its command is missing or invalid; it touches or leaves a wall; it stands; it leaves the game.
    let of_robots = 5 * robots;
    let contacts = robots * robots.saturating_sub(1) / 2;
    // The change, and a robot that is pushed aside, trapped or released.
    let of_changes = changes * (1 + robots);
    let game_over = 1;
    of_robots + contacts + of_changes + game_over
}
