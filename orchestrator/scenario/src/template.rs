//! A scenario without a seed.

use std::sync::Arc;

use config::{Code, Diagnostic, Diagnostics};
use geometry::map::{MapSpec, WorldMap};

use super::resolved::ResolvedScenario;
use super::starts::{self, Placement};

/// The common part of the runs of a scenario with different seeds. Setting a seed is far cheaper than
/// resolving the scenario again, and has the same result.
#[derive(Debug, Clone)]
pub struct Template {
    scenario: ResolvedScenario,
    placements: Vec<Placement>,
    /// The map, if starts are drawn on it.
    world_map: Option<Arc<WorldMap>>,
}

/// Cache of maps that templates share.
#[derive(Debug, Default)]
pub struct MapCache(Vec<(MapSpec, Arc<WorldMap>)>);

impl MapCache {
    /// Returns the map, built once.
    fn map(&mut self, spec: &MapSpec) -> Result<Arc<WorldMap>, geometry::map::MapError> {
        if let Some((_, world_map)) = self.0.iter().find(|(known, _)| known == spec) {
            return Ok(Arc::clone(world_map));
        }
        let world_map = Arc::new(WorldMap::new(spec)?);
        self.0.push((spec.clone(), Arc::clone(&world_map)));
        Ok(world_map)
    }
}

impl Template {
    pub(super) fn new(
        scenario: ResolvedScenario,
        placements: Vec<Placement>,
        map_cache: &mut MapCache,
    ) -> Result<Self, Diagnostics> {
        let drawn = placements.iter().any(|p| p.draw.is_some());
        let world_map = drawn
            .then(|| map_cache.map(&scenario.world.map))
            .transpose();
        Ok(Self {
            world_map: world_map.map_err(|e| Diagnostic::new(Code::Geometry, e.to_string()))?,
            scenario,
            placements,
        })
    }

    /// Returns the scenario with seed 0.
    pub fn scenario(&self) -> &ResolvedScenario {
        &self.scenario
    }

    /// Changes everything but starts and map, for all seeds.
    ///
    /// # Errors
    /// Those of `change`.
    pub fn change<E>(
        &mut self,
        change: impl FnOnce(&mut ResolvedScenario) -> Result<(), E>,
    ) -> Result<(), E> {
        change(&mut self.scenario)
    }

    /// Returns the scenario with a seed below 2^63.
    ///
    /// # Errors
    /// A robot has no allowed start among the draws.
    pub fn with_seed(&self, seed: u64) -> Result<ResolvedScenario, Diagnostics> {
        let mut scenario = self.scenario.clone();
        scenario.run.seed = seed;
        scenario.world.seed = seed;
        let Some(world_map) = &self.world_map else {
            return Ok(scenario);
        };
        let starts = starts::place(&self.placements, seed, world_map, scenario.rules());
        let starts = starts.map_err(|refused| {
            let robot = scenario.world.robots.get(refused.index);
            let name = robot.map_or("", |r| r.name.as_str());
            let problem = Diagnostic::new(Code::Geometry, refused.message(name))
                .field(format!("robots.{name}.{}", refused.key()));
            refused
                .explain(problem)
                .help(format!("this happens with seed {seed}"))
        })?;
        for (robot, start) in scenario.world.robots.iter_mut().zip(starts) {
            robot.start = start;
        }
        Ok(scenario)
    }
}
