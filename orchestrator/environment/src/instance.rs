//! One instance: its episodes and their statistics.

use std::sync::Arc;

use geometry::map::WorldMap;
use geometry::pose::Twist2;
use observation::action::{ACTION_LENGTH, command};
use observation::field_evader::FieldEvader;
use observation::layout::Layout;
use observation::route_entries::RouteEntries;
use observation::scene::{OcclusionCache, Scene};
use planner_view::map::PlannerMap;
use planner_view::view::{BeliefView, RobotView, ScanView, View};
use sim_backend::robot::Robot;
use sim_backend::world::GameOver;

use crate::arrays::ArraysMut;
use crate::backend::{Backend, time_s, view_robots};
use crate::episode::Episode;
use crate::episode_seed::episode_seed;
use crate::error::EnvironmentError;
use crate::options::Autoreset;
use crate::remaining_path::RemainingPath;
use crate::rewards::{self, EVENTS};
use crate::running::{Look, RunningEpisode};
use crate::shared::{SharedData, planner_map};

/// Memory of a step that instances of one thread share.
#[derive(Debug)]
pub struct Scratch {
    /// Data of the instances that may use it.
    shared: Arc<SharedData>,
    scene: Scene,
    robots: Vec<RobotView>,
    beliefs: Vec<BeliefView<'static>>,
    ranges: Vec<f32>,
    /// Commands of the actions, by robot.
    given: Vec<Twist2>,
    commands: Vec<Option<Twist2>>,
    was_active: Vec<bool>,
    /// Progress of each agent (m) since the last observation, if it is rewarded.
    progress: Vec<f64>,
}

impl Scratch {
    pub fn new(shared: &Arc<SharedData>) -> Self {
        let robots = shared.facts.len();
        Self {
            shared: Arc::clone(shared),
            scene: Scene::new(&shared.facts, &shared.agents.robots),
            robots: Vec::with_capacity(robots),
            beliefs: Vec::with_capacity(robots),
            ranges: Vec::new(),
            given: vec![Twist2::STOP; robots],
            commands: vec![None; robots],
            was_active: vec![false; shared.agents.robots.len()],
            progress: vec![0.0; shared.ways_left.len()],
        }
    }

    /// Makes it that of other instances.
    fn fit(&mut self, shared: &Arc<SharedData>) {
        if !Arc::ptr_eq(&self.shared, shared) {
            *self = Self::new(shared);
        }
    }
}

/// One instance.
#[derive(Debug)]
pub struct Instance<B> {
    backend: B,
    index: usize,
    seed: u64,
    /// Number of the running episode since the last reset with a seed.
    episode: u64,
    running: Episode,
    /// `true` from the end of the running episode to the beginning of the next one.
    is_over: bool,
    last: Option<Episode>,
    returns: Vec<f64>,
    hiding: OcclusionCache,
    /// The ways of each agent.
    ways: Vec<Option<RouteEntries>>,
    /// The controllers of the agents, if actions change them.
    evaders: Vec<FieldEvader>,
    /// The ways of the agents, if progress is rewarded.
    ways_left: Vec<RemainingPath>,
    /// The map of planners.
    map: Option<Arc<PlannerMap>>,
}

impl<B: Backend> Instance<B> {
    /// Begins the first episode of an instance, with the seed of all.
    pub fn new(
        shared: &Arc<SharedData>,
        index: usize,
        seed: u64,
    ) -> Result<Self, EnvironmentError> {
        let first = episode_seed(seed, index, 0);
        Ok(Self {
            backend: B::new(shared, first)?,
            index,
            seed,
            episode: 0,
            running: Episode::new(shared, first),
            is_over: false,
            last: None,
            returns: vec![0.0; shared.shape.agents],
            hiding: OcclusionCache::default(),
            ways: shared.layouts.iter().map(Layout::ways).collect(),
            evaders: shared.evaders.clone(),
            ways_left: shared.ways_left.clone(),
            map: shared.planner_map.clone(),
        })
    }

    /// Returns `true` if its episode has ended and the next one has not begun.
    pub fn is_over(&self) -> bool {
        self.is_over
    }

    /// Returns the data of the running episode.
    pub fn shared(&self) -> &Arc<SharedData> {
        &self.running.shared
    }

    /// Begins the next episode.
    pub fn begin_next(&mut self, shared: &Arc<SharedData>) -> Result<(), EnvironmentError> {
        if core::mem::take(&mut self.is_over) {
            let freed = self.last.take();
            let freed = freed.unwrap_or_else(|| Episode::new(shared, 0));
            self.last = Some(core::mem::replace(&mut self.running, freed));
        }
        self.episode += 1;
        let seed = episode_seed(self.seed, self.index, self.episode);
        self.backend = B::new(shared, seed)?;
        self.map.clone_from(&shared.planner_map);
        // Maps of two episodes may have the same revision.
        self.ways = shared.layouts.iter().map(Layout::ways).collect();
        self.evaders.clone_from(&shared.evaders);
        self.ways_left.clone_from(&shared.ways_left);
        self.returns.fill(0.0);
        self.hiding = OcclusionCache::default();
        self.running.begin(shared, seed);
        Ok(())
    }

    /// Lets `look` see the running episode.
    pub fn look(&self, look: Look) {
        look(&RunningEpisode {
            seed: self.running.seed,
            world: self.backend.world(),
            episode: &self.running,
            last: if self.is_over {
                Some(&self.running)
            } else {
                self.last.as_ref()
            },
        });
    }

    /// Writes the state after a reset.
    pub fn write_reset(
        &mut self,
        scratch: &mut Scratch,
        row: &mut ArraysMut<'_>,
    ) -> Result<(), EnvironmentError> {
        row.rewards.fill(0.0);
        row.reward_sums.fill(0.0);
        row.events.fill(0.0);
        row.statuses.fill(0);
        row.terminated.fill(false);
        row.truncated.fill(false);
        row.returns.fill(0.0);
        row.lengths.fill(0);
        row.seeds.fill(self.running.seed);
        let shared = Arc::clone(self.shared());
        scratch.fit(&shared);
        self.observe(&shared, scratch, row.observations)
    }

    /// Does a step with the actions of all agents, or begins the next episode if the last step has ended one.
    pub fn step(
        &mut self,
        scratch: &mut Scratch,
        actions: &[f32],
        row: &mut ArraysMut<'_>,
    ) -> Result<(), EnvironmentError> {
        let shared = &Arc::clone(self.shared());
        if self.is_over {
            self.begin_next(shared)?;
            return self.write_reset(scratch, row);
        }
        scratch.fit(shared);
        let (agents, _) = actions.as_chunks::<ACTION_LENGTH>();
        for (&robot, &action) in shared.agents.robots.iter().zip(agents) {
            scratch.given[robot] = command(action, &shared.facts[robot].model);
        }
        for (evader, &action) in self.evaders.iter_mut().zip(agents) {
            evader.act(action);
        }
        row.rewards.fill(0.0);
        row.events.fill(0.0);
        for _ in 0..shared.options.ticks_per_action {
            self.tick(shared, scratch, actions, row)?;
            if row.terminated[0] || row.truncated[0] {
                return self.end(shared, scratch, row);
            }
            self.backend.sense()?;
        }
        self.observe(shared, scratch, row.observations)?;
        self.reward_progress(shared, scratch, row);
        Ok(())
    }

    /// Does one tick with the commands of the action.
    fn tick(
        &mut self,
        shared: &SharedData,
        scratch: &mut Scratch,
        actions: &[f32],
        row: &mut ArraysMut<'_>,
    ) -> Result<(), EnvironmentError> {
        shared.check_interrupted()?;
        self.steer(shared, scratch)?;
        let robots = shared.agents.robots.iter();
        for (&robot, was_active) in robots.zip(&mut scratch.was_active) {
            let world = self.backend.world();
            *was_active = world.robots().get(robot).is_some_and(Robot::is_active);
            // An agent out of the game stops, as the planners of its kind do.
            let given = if *was_active {
                scratch.given[robot]
            } else {
                Twist2::STOP
            };
            scratch.commands[robot] = Some(given);
        }
        self.running.record(actions, &scratch.was_active);
        if shared.options.record && !self.evaders.is_empty() {
            let commands = shared
                .agents
                .robots
                .iter()
                .filter_map(|&robot| scratch.commands[robot]);
            self.running.commands.extend(commands);
        }
        let Scratch {
            commands, robots, ..
        } = scratch;
        self.backend.step(shared, commands, robots)?;
        self.judge(shared, scratch, row);
        row.lengths.fill(self.running.steps);
        Ok(())
    }

    /// Computes the commands of the controllers that actions change.
    fn steer(
        &mut self,
        shared: &SharedData,
        scratch: &mut Scratch,
    ) -> Result<(), EnvironmentError> {
        if self.evaders.is_empty() {
            return Ok(());
        }
        let world = self.backend.world();
        update_map(&mut self.map, world.map(), shared.blur_sigma)?;
        let Some(map) = &self.map else {
            return Ok(());
        };
        view_robots(world, &mut scratch.robots);
        for (evader, &robot) in self.evaders.iter_mut().zip(&shared.agents.robots) {
            let view = View {
                time_s: time_s(world),
                dt: shared.dt.as_secs_f64(),
                me: robot,
                robots: &scratch.robots,
                beliefs: &[],
                exits: &shared.exits,
                scan: None,
            };
            scratch.given[robot] = evader.steering(map, &view).command;
        }
        Ok(())
    }

    /// Ends the episode, and begins the next one if the same step shall.
    fn end(
        &mut self,
        shared: &Arc<SharedData>,
        scratch: &mut Scratch,
        row: &mut ArraysMut<'_>,
    ) -> Result<(), EnvironmentError> {
        self.is_over = true;
        if shared.options.autoreset == Autoreset::SameStep {
            self.observe(shared, scratch, row.final_observations)?;
            self.reward_progress(shared, scratch, row);
            self.begin_next(shared)?;
            row.seeds.fill(self.running.seed);
            return self.observe(shared, scratch, row.observations);
        }
        self.observe(shared, scratch, row.observations)?;
        self.reward_progress(shared, scratch, row);
        Ok(())
    }

    /// Adds the rewards of the progress since the last observation.
    fn reward_progress(&mut self, shared: &SharedData, scratch: &Scratch, row: &mut ArraysMut<'_>) {
        for (agent, progress) in scratch.progress.iter().enumerate() {
            let reward = shared.options.rewards.progress * progress;
            self.returns[agent] += reward;
            row.rewards[agent] += reward;
            row.returns[agent] = self.returns[agent];
        }
        row.reward_sums[0] = row.rewards.iter().sum();
    }

    /// Adds rewards and events of a tick, and writes the end of the episode.
    fn judge(&mut self, shared: &SharedData, scratch: &Scratch, row: &mut ArraysMut<'_>) {
        let world = self.backend.world();
        let dt = shared.dt.as_secs_f64();
        let (events, _) = row.events.as_chunks_mut::<EVENTS>();
        let mut any_active = false;
        for (agent, (&robot, counts)) in shared.agents.robots.iter().zip(events).enumerate() {
            let team = shared.facts[robot].team;
            let mut of_tick = [0.0; EVENTS];
            if !world.events().is_empty() {
                rewards::count(world, robot, team, &mut of_tick);
                for (count, of_tick) in counts.iter_mut().zip(of_tick) {
                    *count += of_tick;
                }
            }
            let weights = &shared.options.rewards;
            let reward = weights.reward(&of_tick, scratch.was_active[agent], dt);
            self.returns[agent] += reward;
            row.rewards[agent] += reward;
            row.returns[agent] = self.returns[agent];
            let status = world.robots()[robot].status;
            row.statuses[agent] = status.code();
            any_active |= world.robots()[robot].is_active();
        }
        row.reward_sums[0] = row.rewards.iter().sum();
        let is_truncated = world.game_over() == Some(GameOver::TimeLimit);
        row.truncated[0] = is_truncated;
        row.terminated[0] = !is_truncated && (world.is_over() || !any_active);
    }

    /// Writes the observations of all agents.
    fn observe(
        &mut self,
        shared: &SharedData,
        scratch: &mut Scratch,
        out: &mut [f32],
    ) -> Result<(), EnvironmentError> {
        let world = self.backend.world();
        view_robots(world, &mut scratch.robots);
        let (scene, hiding) = (&mut scratch.scene, &mut self.hiding);
        scene.update(&scratch.robots, world.map().shapes(), hiding);
        self.backend.beliefs(&mut scratch.beliefs);
        update_map(&mut self.map, world.map(), shared.blur_sigma)?;
        let (now, dt) = (time_s(world), shared.dt.as_secs_f64());
        let rows = out.chunks_exact_mut(shared.shape.observation.max(1));
        let agents = shared.layouts.iter().zip(&mut self.ways).zip(rows);
        for (agent, ((layout, ways), row)) in agents.enumerate() {
            let me = layout.robot();
            let scan = if layout.parts().scan {
                world.scan(me, &mut scratch.ranges)
            } else {
                None
            };
            let view = View {
                time_s: now,
                dt,
                me,
                robots: &scratch.robots,
                beliefs: &scratch.beliefs,
                exits: &shared.exits,
                scan: scan.map(|scan| ScanView {
                    angle_min: scan.angle_min,
                    angle_increment: scan.angle_increment,
                    range_min: scan.range_min,
                    range_max: scan.range_max,
                    ranges: &scratch.ranges,
                }),
            };
            let (own, padding) = row.split_at_mut(layout.length());
            layout.write(&scratch.scene, &view, own)?;
            if let (Some(ways), Some(map)) = (ways, &self.map) {
                ways.write(map, &view, own);
            }
            if let (Some(way), Some(map)) = (self.ways_left.get_mut(agent), &self.map) {
                scratch.progress[agent] = way.progress(map, &view);
            }
            padding.fill(0.0);
        }
        Ok(())
    }
}

/// Replaces the map of planners if obstacles have changed.
fn update_map(
    map: &mut Option<Arc<PlannerMap>>,
    world: &WorldMap,
    blur_sigma: f64,
) -> Result<(), EnvironmentError> {
    if let Some(map) = map
        && map.revision() != world.revision()
    {
        *map = planner_map(world, blur_sigma)?;
    }
    Ok(())
}
