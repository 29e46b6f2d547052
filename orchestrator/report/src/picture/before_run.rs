//! The content of a picture of a scenario before it runs.

use geometry::map::{MapError, ObstacleChange, WorldMap};
use scenario::ResolvedScenario;

use super::trace::{RobotTrace, RunTrace};
use super::trail::Trail;
use crate::run_model::TaskTrace;
use crate::run_model::{Cells, StaticScene};

impl RunTrace {
    /// Takes the content of a picture from a scenario: walls, exits, robots at their starts, goals, the
    /// geometry of their tasks, and the obstacles that appear during the run.
    ///
    /// # Errors
    /// [`MapError`] for an invalid map; never for that of a loaded scenario.
    pub fn before_run(scenario: &ResolvedScenario) -> Result<Self, MapError> {
        let world = &scenario.world;
        let mut static_scene = StaticScene::from_map(&world.map, &world.rules.exits);
        if !static_scene.has_vectors() {
            let map = WorldMap::recent(&world.map)?;
            let occupancy = map.occupancy();
            static_scene.set_cells(Cells {
                origin: [occupancy.frame.origin.x, occupancy.frame.origin.y],
                side: occupancy.frame.resolution,
                width: occupancy.frame.width,
                occupied: occupancy.cells.clone(),
            });
        }
        // In the order of time: the first appearance of each obstacle that the map lacks.
        for change in scenario
            .events
            .iter()
            .filter_map(scenario::EventSpec::change)
        {
            if let ObstacleChange::Appear { id, .. } = &change
                && !static_scene.obstacles.contains_key(&id.0)
            {
                static_scene.apply(change);
            }
        }
        let mut task = TaskTrace::of_goals(&world.robots);
        for process in &scenario.processes {
            let Some(kind) = process.program.kind() else {
                continue;
            };
            let robots = process.robots.iter();
            for robot in robots.filter_map(|&robot| world.robots.get(robot)) {
                task.add(&kind.sketch(robot, &world.map));
            }
        }
        let robots = world.robots.iter().map(|spec| RobotTrace {
            name: spec.name.clone(),
            team: spec.team.clone(),
            role: spec.role(),
            radius: spec.model().radius,
            pose: spec.start,
            active: true,
            trail: Trail::default(),
            sweeps: None,
        });
        Ok(Self {
            title: scenario.title.clone(),
            description: scenario.description.clone(),
            scenario: scenario.name.clone(),
            seed: scenario.run.seed.to_string(),
            static_scene,
            robots: robots.collect(),
            task,
            ..Self::default()
        })
    }
}
