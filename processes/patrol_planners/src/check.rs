//! Check that a robot can patrol a contour on a map, and remarks about the patrol.

use avoidance::waypoint_driver::DriverParams;
use geometry::map::ShapeMap;
use nalgebra::Point2;
use patrol::mission::{Drive, Mission, MissionParams};
use patrol::remarks;
use patrol::room::Room;
use planner_view::map::PlannerMap;
use runtime::kind::{Remark, Task, TaskFault};

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
    let arrived = driver.go_to.arrived;
    for (index, &[x, y]) in mission.contour.iter().enumerate() {
        let at = Point2::new(x, y);
        let (low, high) = (at - bounds.min, bounds.max - at);
        let room = low.x.min(low.y).min(high.x).min(high.y);
        let field = format!("mission.contour[{index}]");
        if room + arrived < model.radius {
            let message = format!(
                "`contour[{index}]` is ({x}, {y}), where the robot of radius {} m does not fit into \
                 the map from ({}, {}) to ({}, {}): move it inside or enlarge the map",
                model.radius, bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y
            );
            return Err(TaskFault::Param { field, message });
        }
        // A robot that knows the obstacles plans a path to the corner itself; another one comes as near
        // as they let it.
        let (needed, knows) = if obstacles_known {
            (model.radius, ", which knows the obstacles")
        } else {
            (model.radius - arrived, "")
        };
        if !task.world_map.is_clear(at, needed) {
            let message = format!(
                "`contour[{index}]` is ({x}, {y}), where an obstacle leaves no room for the robot of \
                 radius {} m{knows}: move one of the two",
                model.radius
            );
            return Err(TaskFault::Param { field, message });
        }
    }
    let drive = Drive::from_model(&model).map_err(|e| TaskFault::param("mission", &e))?;
    mission.check(&drive, &driver.go_to, seed).map_err(|e| {
        let message = e.to_string();
        let named = message.split('`').nth(1).unwrap_or("t_max");
        TaskFault::param(&format!("mission.{named}"), &message)
    })
}

/// Part of a patrol's protection that waypoints provide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Waypoints {
    /// They make a zig-zag.
    ZigZag,
    /// There are only those of the contour.
    Contour,
}

/// Returns the width of the zig-zag and its origin, and what is wrong with the patrol; `seed` is the
/// planner's. Nothing for a task that [`check_task`] refuses.
pub(crate) fn task_remarks(
    params: &MissionParams,
    driver: &DriverParams,
    obstacles_known: bool,
    waypoints: Waypoints,
    task: &Task<'_>,
    seed: u64,
) -> Vec<Remark> {
    let model = task.robot.model();
    let prepared = Drive::from_model(&model)
        .ok()
        .and_then(|drive| params.prepare(&drive, &driver.go_to, seed).ok());
    let Some(mission) = prepared else {
        return Vec::new();
    };
    let map = task.world_map.shapes();
    let mission =
        mission
            .of_team(task.companions)
            .within(&room_of(map, obstacles_known, model.radius));
    let mut remarks = Vec::new();
    if waypoints == Waypoints::ZigZag {
        let alpha = mission.awg.params().alpha;
        let reason = mission.alpha_choice.reason();
        remarks.push(Remark::Note(format!("α = {alpha:.3} m, {reason}")));
    }
    let warnings = warnings(&mission, waypoints, map, model.radius);
    remarks.extend(warnings.into_iter().map(Remark::Warning));
    remarks
}

/// Returns a mission fitted to the map of its planner; `None` if the planner has no exact map.
pub(crate) fn fitted(
    mission: &Mission,
    map: &PlannerMap,
    obstacles_known: bool,
    radius: f64,
) -> Option<Mission> {
    let map = map.space()?.shapes();
    let room = room_of(map, obstacles_known, radius);
    Some(mission.clone().within(&room))
}

/// Returns the room that a robot of this radius (m) knows in a map.
pub fn room_of(map: &ShapeMap, obstacles_known: bool, radius: f64) -> Room<'_> {
    Room::new(*map.bounds(), obstacles_known.then_some(map), radius)
}

/// Returns what is wrong with a patrol in a map, for a robot of this radius (m).
pub fn warnings(
    mission: &Mission,
    waypoints: Waypoints,
    map: &ShapeMap,
    radius: f64,
) -> Vec<String> {
    let found = match waypoints {
        Waypoints::ZigZag => remarks::of_zig_zag(mission, &room_of(map, true, radius)),
        Waypoints::Contour => remarks::of_contour(mission),
    };
    found.iter().map(ToString::to_string).collect()
}
