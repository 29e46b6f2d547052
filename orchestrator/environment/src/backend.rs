//! Execution of the world of an instance: alone, or with the processes of the scenario.

use std::sync::Arc;

use geometry::pose::{Pose2, Twist2};
use mission::in_process::SteppedRun;
use planner::PlannerProcess;
use planner_view::view::{BeliefView, RobotView};
use scenario::kind::ConfiguredKind;
use sim_backend::world::World;

use crate::commanded::{CommandedParams, CommandedPlanner, Current};
use crate::error::EnvironmentError;
use crate::shared::SharedData;

/// Execution of the episodes of one instance.
pub trait Backend: Sized {
    /// Begins an episode.
    fn new(shared: &SharedData, seed: u64) -> Result<Self, EnvironmentError>;

    /// Does a step. `commands` are those of all robots; only those of agents are used.
    fn step(
        &mut self,
        shared: &SharedData,
        commands: &[Option<Twist2>],
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
        commands: &[Option<Twist2>],
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
pub struct WithProcesses {
    run: SteppedRun,
    commands: Arc<Current>,
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
        let mut run = SteppedRun::open(&scenario, &own, beliefs, &shared.cache)?;
        run.sense()?;
        Ok(Self { run, commands })
    }

    fn step(
        &mut self,
        shared: &SharedData,
        commands: &[Option<Twist2>],
    ) -> Result<(), EnvironmentError> {
        for &robot in &shared.agents.robots {
            let command = commands.get(robot).copied().flatten();
            if let (Some(facts), Some(command)) = (shared.facts.get(robot), command) {
                self.commands.set(&facts.name, command);
            }
        }
        Ok(self.run.act()?)
    }

    fn sense(&mut self) -> Result<(), EnvironmentError> {
        self.run.sense()?;
        Ok(())
    }

    fn world(&self) -> &World {
        self.run.world()
    }

    fn beliefs(&self, beliefs: &mut Vec<BeliefView<'static>>) {
        beliefs.clear();
        beliefs.extend(self.run.beliefs().iter().map(|belief| {
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
