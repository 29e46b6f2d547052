//! Execution of the world of an instance: alone, or with the processes of the scenario.

use std::sync::Arc;

use geometry::pose::{Pose2, Twist2};
use mission::in_process::{DirectRun, SteppedRun};
use planner::PlannerProcess;
use planner_view::view::{BeliefView, RobotView, View};
use scenario::kind::ConfiguredKind;
use sim_backend::world::World;

use crate::commanded::{CommandedParams, CommandedPlanner, Current};
use crate::error::EnvironmentError;
use crate::shared::SharedData;

/// Execution of the episodes of one instance.
pub trait Backend: Sized {
    /// Begins an episode.
    fn new(shared: &SharedData, seed: u64) -> Result<Self, EnvironmentError>;

    /// Does a step. `commands` are those of all robots; only those of agents are read. `views` is memory.
    fn step(
        &mut self,
        shared: &SharedData,
        commands: &mut [Option<Twist2>],
        views: &mut Vec<RobotView>,
    ) -> Result<(), EnvironmentError>;

    /// Lets the other processes sense the state, for the observation that follows and the next step.
    fn sense(&mut self) -> Result<(), EnvironmentError>;

    /// Returns the world.
    fn world(&self) -> &World;

    /// Replaces `beliefs` by the newest ones.
    fn beliefs(&self, beliefs: &mut Vec<BeliefView<'static>>);
}

/// Replaces `views` by the robots of a world, as the planners of a run see them.
pub fn view_robots(world: &World, views: &mut Vec<RobotView>) {
    views.clear();
    let robots = world.robots().iter().enumerate();
    views.extend(robots.map(|(index, robot)| RobotView {
        index,
        team: robot.team,
        active: robot.is_active(),
        present: world.is_present(index),
        pose: robot.pose,
        twist: robot.twist,
        radius: robot.radius(),
        v_max: robot.model.v_max,
    }));
}

/// Returns the time (s), to the last bit as processes compute it from the stamp of a state.
pub fn time_s(world: &World) -> f64 {
    // 2⁶⁴ ns are 584 years.
    world.time().as_nanos() as u64 as f64 * 1e-9
}

/// The world alone.
#[derive(Debug)]
pub struct WorldBackend(World);

impl Backend for WorldBackend {
    fn new(shared: &SharedData, seed: u64) -> Result<Self, EnvironmentError> {
        let spec = shared.scenario(seed)?.world;
        Ok(Self(World::on_map(shared.map.clone(), spec)?))
    }

    fn step(
        &mut self,
        shared: &SharedData,
        commands: &mut [Option<Twist2>],
        _: &mut Vec<RobotView>,
    ) -> Result<(), EnvironmentError> {
        self.0.step(commands, shared.dt);
        Ok(())
    }

    fn sense(&mut self) -> Result<(), EnvironmentError> {
        Ok(())
    }

    fn world(&self) -> &World {
        &self.0
    }

    fn beliefs(&self, beliefs: &mut Vec<BeliefView<'static>>) {
        beliefs.clear();
    }
}

/// The world with the processes of the scenario.
pub enum WithProcesses {
    /// Their planners need only state and map: they step on one view, without messages.
    Direct(Box<DirectRun>),
    /// Over a bus, with the commands of the agents.
    Messages(Box<SteppedRun>, Arc<Current>),
}

impl Backend for WithProcesses {
    fn new(shared: &SharedData, seed: u64) -> Result<Self, EnvironmentError> {
        let scenario = shared.scenario(seed)?;
        let commands = Arc::new(Current::default());
        let mut own = shared.options.programs.clone();
        for &index in &shared.agents.processes {
            if let Some(process) = scenario.processes.get(index) {
                let params = CommandedParams::new(Arc::clone(&commands) as _);
                let kind = ConfiguredKind::new::<PlannerProcess<CommandedPlanner>>(params);
                own.insert(process.name.clone(), kind);
            }
        }
        let beliefs = shared.options.observation.belief;
        let run = SteppedRun::open(&scenario, &own, beliefs, &shared.cache)?;
        let is_quiet = scenario.events.is_empty()
            && scenario.links_by_receiver().iter().all(Vec::is_empty)
            && shared.options.programs.is_empty();
        let mut run = if is_quiet && !beliefs {
            match run.into_direct() {
                Ok(direct) => return Ok(Self::Direct(Box::new(direct))),
                Err(run) => run,
            }
        } else {
            Box::new(run)
        };
        run.sense()?;
        Ok(Self::Messages(run, commands))
    }

    fn step(
        &mut self,
        shared: &SharedData,
        commands: &mut [Option<Twist2>],
        views: &mut Vec<RobotView>,
    ) -> Result<(), EnvironmentError> {
        let (run, current) = match self {
            Self::Messages(run, current) => (run, current),
            Self::Direct(run) => {
                let world = run.world();
                view_robots(world, views);
                let view = View {
                    time_s: time_s(world),
                    dt: shared.dt.as_secs_f64(),
                    me: 0,
                    robots: views,
                    beliefs: &[],
                    exits: &shared.exits,
                    scan: None,
                };
                return Ok(run.step(&view, commands, shared.dt)?);
            }
        };
        for &robot in &shared.agents.robots {
            let command = commands.get(robot).copied().flatten();
            if let (Some(facts), Some(command)) = (shared.facts.get(robot), command) {
                current.set(&facts.name, command);
            }
        }
        Ok(run.act()?)
    }

    fn sense(&mut self) -> Result<(), EnvironmentError> {
        if let Self::Messages(run, _) = self {
            run.sense()?;
        }
        Ok(())
    }

    fn world(&self) -> &World {
        match self {
            Self::Direct(run) => run.world(),
            Self::Messages(run, _) => run.world(),
        }
    }

    fn beliefs(&self, beliefs: &mut Vec<BeliefView<'static>>) {
        beliefs.clear();
        let Self::Messages(run, _) = self else {
            return;
        };
        beliefs.extend(run.beliefs().iter().map(|belief| {
            let h = &belief.header;
            BeliefView {
                robot: h.robot as usize,
                // Observations summarise.
                particles: &[],
                mean: Pose2::new(h.mean_x, h.mean_y, h.mean_theta),
                position_std: (h.covariance_xx + h.covariance_yy).max(0.0).sqrt(),
                seen: h.seen != 0,
            }
        }));
    }
}
