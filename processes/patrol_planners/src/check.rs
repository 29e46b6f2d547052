//! Check that a robot can patrol a contour on a map.

use nalgebra::Point2;
use patrol::mission::{Drive, MissionParams};
use runtime::kind::{Task, TaskFault};
use steering::waypoint_driver::DriverParams;

/// Checks the contour against the map, and the order against the robot; `seed` is the planner's.
pub(crate) fn check_task(
    mission: &MissionParams,
    driver: &DriverParams,
    obstacles_known: bool,
    task: &Task<'_>,
    seed: u64,
) -> Result<(), TaskFault> {
    let model = task.robot.model();
    let bounds = task.world_map.bounds();
    for (index, &[x, y]) in mission.contour.iter().enumerate() {
        let at = Point2::new(x, y);
        let (low, high) = (at - bounds.min, bounds.max - at);
        let room = low.x.min(low.y).min(high.x).min(high.y);
        let field = format!("mission.contour[{index}]");
        if room + driver.go_to.arrived < model.radius {
            let message = format!(
                "`contour[{index}]` is ({x}, {y}), where the robot of radius {} m does not fit into \
                 the map from ({}, {}) to ({}, {}): move it inside or enlarge the map",
                model.radius, bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y
            );
            return Err(TaskFault::Param { field, message });
        }
        if obstacles_known && !task.world_map.is_clear(at, model.radius) {
            let message = format!(
                "`contour[{index}]` is ({x}, {y}), where an obstacle leaves no room for the robot of \
                 radius {} m, which knows the obstacles: move one of the two",
                model.radius
            );
            return Err(TaskFault::Param { field, message });
        }
    }
    let drive = Drive::of(&model).map_err(|e| TaskFault::param("mission", &e))?;
    mission.check(&drive, &driver.go_to, seed).map_err(|e| {
        let message = e.to_string();
        let named = message.split('`').nth(1).unwrap_or("t_max");
        TaskFault::param(&format!("mission.{named}"), &message)
    })
}
