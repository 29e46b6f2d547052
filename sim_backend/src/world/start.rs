//! Checks of a specification against its map, before the run starts.

use geometry::map::WorldMap;
use geometry::region::Region;
use parameters::check;

use super::{MAX_ROBOTS, WorldError};
use crate::robot::Robot;
use crate::spec::RulesSpec;
use robot::spec::RobotSpec;
use robot::team::Role;

/// Checks robots and rules separately.
pub fn check_specs(robots: &[RobotSpec], rules: &RulesSpec) -> Result<(), WorldError> {
    check(rules).map_err(WorldError::Rules)?;
    if robots.is_empty() {
        return Err(WorldError::NoRobots);
    }
    if robots.len() > MAX_ROBOTS {
        return Err(WorldError::TooManyRobots(robots.len()));
    }
    for (index, robot) in robots.iter().enumerate() {
        check(robot).map_err(|source| {
            let name = robot.name.clone();
            WorldError::Robot {
                index,
                name,
                source,
            }
        })?;
        if let Some(first) = robots[..index]
            .iter()
            .position(|other| other.name == robot.name)
        {
            return Err(WorldError::DuplicateName {
                name: robot.name.clone(),
                first,
                second: index,
            });
        }
    }
    Ok(())
}

/// Checks that a robot is in free space, and apart from the others that have a body.
pub fn check_place(
    map: &WorldMap,
    robots: &[Robot],
    index: usize,
    is_other: impl Fn(usize) -> bool,
) -> Result<(), WorldError> {
    let robot = &robots[index];
    let (x, y, radius) = (robot.pose.x, robot.pose.y, robot.radius());
    let name = || robot.name.clone();
    let bounds = map.bounds();
    if !bounds.contains(robot.pose.position()) {
        let (min, max) = ([bounds.min.x, bounds.min.y], [bounds.max.x, bounds.max.y]);
        return Err(WorldError::OutsideMap {
            index,
            name: name(),
            x,
            y,
            min,
            max,
        });
    }
    let clearance = map.distance(robot.pose.position());
    if clearance < radius {
        return Err(WorldError::InWall {
            index,
            name: name(),
            x,
            y,
            clearance,
            radius,
        });
    }
    for (first, other) in robots.iter().enumerate().filter(|(i, _)| is_other(*i)) {
        let distance = (other.pose.position() - robot.pose.position()).norm();
        let needed = other.radius() + radius;
        if distance < needed {
            return Err(WorldError::Overlap {
                first,
                first_name: other.name.clone(),
                second: index,
                second_name: name(),
                distance,
                needed,
            });
        }
    }
    Ok(())
}

/// Checks that every robot is in free space and can reach its goal.
pub fn check_places(map: &WorldMap, robots: &[Robot], exits: &[Region]) -> Result<(), WorldError> {
    for index in 0..robots.len() {
        check_place(map, robots, index, |other| other < index)?;
    }
    for (index, robot) in robots.iter().enumerate() {
        let (x, y, radius) = (robot.pose.x, robot.pose.y, robot.radius());
        let name = || robot.name.clone();
        if robot.team.role == Role::Evader && !exits.is_empty() && !reaches_any(map, robot, exits) {
            return Err(WorldError::ExitUnreachable {
                index,
                name: name(),
                x,
                y,
                radius,
            });
        }
        if let Some(goal) = robot.goal
            && !reaches_any(map, robot, &[goal])
        {
            return Err(WorldError::GoalUnreachable {
                index,
                name: name(),
                x,
                y,
                radius,
            });
        }
    }
    Ok(())
}

/// Returns `true` if a robot can reach any of the regions from its position, over cells that may contain a
/// point with enough clearance.
///
/// It may return `true` in error, by less than a cell: `false` is certain.
fn reaches_any(map: &WorldMap, robot: &Robot, regions: &[Region]) -> bool {
    let position = robot.pose.position();
    if regions.iter().any(|region| region.contains(position)) {
        return true;
    }
    let half_diagonal = map.frame().resolution * core::f64::consts::FRAC_1_SQRT_2;
    let passages = map.shapes().passages(robot.radius() - half_diagonal - 1e-6);
    // The start is free (checked before), whatever its cell's centre.
    let reach = passages.reach([position]);
    regions.iter().any(|region| reach.meets(region))
}
