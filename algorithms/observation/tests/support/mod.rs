//! Robots of a world, as observations need them.

use observation::facts::RobotFacts;
use planner_view::view::RobotView;
use sim_backend::world::World;

/// Returns the properties of the robots of a world.
pub fn facts(world: &World) -> Vec<RobotFacts> {
    let robots = world.robots().iter().enumerate();
    let facts = robots.map(|(index, robot)| RobotFacts {
        name: robot.name.clone(),
        team: robot.team,
        model: robot.model,
        goal: robot.goal,
        beams: world.scan_spec(index).map_or(0, |scan| scan.beams),
    });
    facts.collect()
}

/// Returns the states of the robots of a world.
pub fn robots(world: &World) -> Vec<RobotView> {
    let robots = world.robots().iter().enumerate();
    let views = robots.map(|(index, robot)| RobotView {
        index,
        team: robot.team,
        active: robot.is_active(),
        present: world.is_present(index),
        pose: robot.pose,
        twist: robot.twist,
        radius: robot.radius(),
        v_max: robot.model.v_max,
    });
    views.collect()
}
