//! Check that a robot can cover a map.

use coverage::sub_goals::site::Site;
use coverage::workplace::{Workplace, WorkplaceError};
use geometry::map::MapSpec;
use geometry::shape::Shape;
use runtime::kind::{Task, TaskFault};

use crate::design::Design;
use crate::error::DesignError;

/// Makes the first sub-goals on the map; `seed` is the planner's.
pub(crate) fn check_task<D: Design>(
    params: &D::Params,
    task: &Task<'_>,
    seed: u64,
) -> Result<(), TaskFault> {
    let follow = D::follow(params);
    let bounds = *task.world_map.bounds();
    let radius = task.robot.model().radius;
    if let MapSpec::Vector(map) = task.map {
        let shapes: Vec<Shape> = map.obstacles.iter().map(|o| o.shape.clone()).collect();
        let made = Workplace::new(bounds, radius, &shapes, follow.tolerance);
        if let Err(error) = made
            && let WorkplaceError::Outside { index, .. } | WorkplaceError::Covering { index } =
                error
        {
            let name = map.obstacles.get(index).map_or("", |o| o.name.as_str());
            let message = error.to_string();
            let message = message.replacen(&format!("obstacles[{index}]"), &format!("`{name}`"), 1);
            return Err(TaskFault::Obstacle { index, message });
        }
    }
    let here = task.robot.start.position();
    Site::new(bounds, task.world_map.parts(), radius, &follow, here)
        .map_err(DesignError::from)
        .and_then(|site| D::goals(params, &site, seed, None).map(drop))
        .map_err(|error| TaskFault::param(error.field(), &error))
}
