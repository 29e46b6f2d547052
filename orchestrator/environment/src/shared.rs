//! Data that all instances share.

use core::time::Duration;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use geometry::map::WorldMap;
use geometry::region::Region;
use mission::in_process::Cache;
use nalgebra::Point2;
use observation::action::ActionKind;
use observation::facts::RobotFacts;
use observation::field_evader::FieldEvader;
use observation::layout::Layout;
use planner_view::map::PlannerMap;
use runtime::declaration::Input;
use scenario::kind::ConfiguredKind;
use scenario::{ProcessSpec, ResolvedScenario, Template};
use sim_backend::world::World;

use crate::agents::Agents;
use crate::arrays::Shape;
use crate::episode_seed::episode_seed;
use crate::error::EnvironmentError;
use crate::options::Options;
use crate::remaining_path::RemainingPath;

/// Maximum number of numbers in the observations of all instances.
const MAX_OBSERVATIONS: usize = 1 << 26;

/// Scenario of episodes, with the values of the environments or with others.
#[derive(Debug, Clone)]
pub struct Variant(pub(crate) Arc<SharedData>);

impl Variant {
    /// Returns the scenario with other values; `programs` are as in [`Options`].
    ///
    /// # Errors
    /// [`EnvironmentError`] as [`Environments::new`](crate::Environments::new); also if the values change the arrays of
    /// agents.
    pub fn with(
        &self,
        template: Template,
        programs: BTreeMap<String, ConfiguredKind>,
    ) -> Result<Self, EnvironmentError> {
        self.0.variant(template, programs)
    }
}

/// Data that all instances of a scenario share; it never changes.
#[derive(Debug)]
pub struct SharedData {
    pub template: Template,
    pub options: Options,
    pub agents: Agents,
    /// `true` if the world can be stepped alone.
    pub are_alone: bool,
    pub facts: Vec<RobotFacts>,
    /// Controllers of the agents, if actions change them.
    pub evaders: Vec<FieldEvader>,
    /// The ways of the agents, if progress is rewarded.
    pub ways_left: Vec<RemainingPath>,
    /// Observations of the agents.
    pub layouts: Vec<Layout>,
    /// Centres of the exits (m).
    pub exits: Vec<Point2<f64>>,
    pub map: WorldMap,
    /// The map of planners, if observations, actions or rewards need it.
    pub planner_map: Option<Arc<PlannerMap>>,
    pub blur_sigma: f64,
    pub dt: Duration,
    pub cache: Arc<Cache>,
    pub shape: Shape,
    /// Ends a reset or a step.
    pub interrupted: Arc<AtomicBool>,
}

impl SharedData {
    pub fn new(
        template: Template,
        options: Options,
        cache: Arc<Cache>,
    ) -> Result<Self, EnvironmentError> {
        options.check()?;
        let agents = Agents::new(template.scenario(), &options.agents)?;
        agents.check_links(template.scenario())?;
        let scenario = template.with_seed(episode_seed(options.seed, 0, 0))?;
        let beliefs = options.observation.belief;
        let is_source = |process: &ProcessSpec| process.writes(Input::BELIEFS.flow);
        if beliefs && !scenario.processes.iter().any(is_source) {
            return Err(EnvironmentError::NoBeliefs);
        }
        let dt = Duration::from_nanos((scenario.run.dt * 1e9).round() as u64);
        let blur_sigma = scenario.blur_sigma;
        let facts = RobotFacts::of_specs(&scenario.world.robots);
        let world = World::new(scenario.world)?;
        let exits: Vec<Point2<f64>> = world.exits().iter().map(Region::center).collect();
        let layout = |&robot| Layout::new(options.observation, &facts, robot, exits.len());
        let layouts: Vec<Layout> = agents.robots.iter().map(layout).collect::<Result<_, _>>()?;
        let shape = Shape {
            instances: options.instances,
            agents: agents.robots.len(),
            observation: layouts.iter().map(Layout::length).max().unwrap_or(0),
        };
        if shape.instances * shape.agents * shape.observation > MAX_OBSERVATIONS {
            return Err(EnvironmentError::Option {
                option: "instances",
                given: shape.instances.to_string(),
                expected: "fewer, with at most 2^26 numbers in all observations",
            });
        }
        let evader = |&robot| FieldEvader::new(options.action, &facts[robot], robot);
        let evaders = match options.action {
            ActionKind::Twist => Vec::new(),
            ActionKind::Tune | ActionKind::Residual => {
                agents.robots.iter().map(evader).collect::<Result<_, _>>()?
            }
        };
        let ways_left = if options.rewards.progress == 0.0 {
            Vec::new()
        } else {
            RemainingPath::of_agents(&agents.robots, &facts, exits.len())?
        };
        let has_ways = layouts.iter().any(|layout| layout.ways().is_some());
        let planner_map = if has_ways || !evaders.is_empty() || !ways_left.is_empty() {
            Some(planner_map(world.map(), blur_sigma)?)
        } else {
            None
        };
        let are_alone = agents.are_alone(template.scenario()) && !beliefs;
        Ok(Self {
            are_alone,
            map: world.map().clone(),
            planner_map,
            blur_sigma,
            template,
            options,
            agents,
            facts,
            evaders,
            ways_left,
            layouts,
            exits,
            dt,
            cache,
            shape,
            interrupted: Arc::default(),
        })
    }

    /// Returns the error of a reset or a step that is interrupted.
    pub fn check_interrupted(&self) -> Result<(), EnvironmentError> {
        if self.interrupted.load(Ordering::Relaxed) {
            Err(EnvironmentError::Interrupted)
        } else {
            Ok(())
        }
    }

    /// Returns the data of a scenario that differs from this one in values.
    fn variant(
        &self,
        template: Template,
        programs: BTreeMap<String, ConfiguredKind>,
    ) -> Result<Variant, EnvironmentError> {
        let options = Options {
            programs,
            ..self.options.clone()
        };
        let mut other = Self::new(template, options, Arc::clone(&self.cache))?;
        other.interrupted = Arc::clone(&self.interrupted);
        let names = |shared: &Self| -> Vec<String> {
            let robots = shared.agents.robots.iter();
            robots
                .map(|&robot| shared.facts[robot].name.clone())
                .collect()
        };
        let entries = |shared: &Self| -> Vec<Vec<String>> {
            let layouts = shared.layouts.iter();
            layouts.map(|layout| layout.names().to_vec()).collect()
        };
        let changed = [
            (names(self) != names(&other), "the agents"),
            (
                entries(self) != entries(&other),
                "the entries of observations",
            ),
            (self.dt != other.dt, "the time step"),
            (
                self.are_alone && !other.are_alone,
                "what steps beside the agents",
            ),
        ];
        match changed.iter().find(|(is_changed, _)| *is_changed) {
            Some((_, what)) => Err(EnvironmentError::Fixed(what)),
            None => Ok(Variant(Arc::new(other))),
        }
    }

    /// Returns the scenario of an episode.
    pub fn scenario(&self, seed: u64) -> Result<ResolvedScenario, EnvironmentError> {
        Ok(self.template.with_seed(seed)?)
    }
}

/// Returns the map as planners get it, for all instances.
pub fn planner_map(world: &WorldMap, blur_sigma: f64) -> Result<Arc<PlannerMap>, EnvironmentError> {
    let map = PlannerMap::of_world(world, blur_sigma, world.revision())?;
    Ok(Arc::new(map.shared()))
}
