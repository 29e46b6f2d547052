//! The simulator and the other processes of a run in one thread, tick by tick.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use ipc_types::bus::Bus;
use runtime::maps::Maps;
use scenario::kind::ConfiguredKind;
use sim_backend::world::World;
use simulator::process::Simulator;

use super::super::error::InProcessError;
use super::super::plan::Plan;
use super::branches::PreparedBranch;
use super::direct::DirectRun;
use super::hosted::Host;
use super::processes::{LocalProcess, LocalProcesses, failed};
use super::tracks::Track;

/// The simulator and the other processes.
pub(super) struct LocalRun {
    leader: String,
    simulator: Simulator,
    followers: LocalProcesses,
    pub(super) branches: VecDeque<PreparedBranch>,
}

impl LocalRun {
    /// Opens the ports of all processes, which share `maps`; `programs` run in the place of those with their names, and
    /// external programs in that of a host.
    pub(super) fn open_with(
        plan: &Plan,
        programs: &BTreeMap<String, ConfiguredKind>,
        bus: &Bus,
        maps: &Arc<Maps>,
        host: Option<&Host>,
    ) -> Result<Self, InProcessError> {
        let Some((leader, params, followers)) = plan.split_simulator() else {
            return Err(InProcessError::NoSimulator);
        };
        let simulator = Simulator::open(&leader.config, params, bus, Some(Arc::clone(maps)))
            .map_err(|source| failed(&leader.config.name, None, source))?;
        let mut followers = LocalProcesses::open_with(followers, programs, bus, host)?;
        for follower in &mut followers.processes {
            follower.process.share_maps(maps);
        }
        Ok(Self {
            leader: leader.config.name.clone(),
            simulator,
            followers,
            branches: VecDeque::new(),
        })
    }

    /// Ends the processes that have failed by the current tick.
    pub(super) fn fail(&mut self, failures: &BTreeMap<String, u64>) {
        let tick = self.tick();
        let is_there = |name: &str| failures.get(name).is_none_or(|first| tick < *first);
        self.followers.retain(is_there);
        for branch in &mut self.branches {
            branch.changed.retain(is_there);
        }
    }

    /// Lets the last branch begin at the current tick.
    pub(super) fn begin_last(&mut self) {
        let tick = self.tick();
        if let Some(last) = self.branches.back_mut() {
            last.tick = tick;
        }
    }

    /// Begins the branches of the current tick.
    fn begin_branches(&mut self) -> Result<(), InProcessError> {
        let tick = self.tick();
        while self.branches.front().is_some_and(|next| next.tick <= tick)
            && let Some(branch) = self.branches.pop_front()
        {
            branch.begin(&self.leader, &mut self.simulator, &mut self.followers)?;
        }
        Ok(())
    }

    /// Connects all processes and sends the map.
    pub(super) fn connect(&mut self) -> Result<(), InProcessError> {
        self.followers.connect()?;
        for branch in &mut self.branches {
            branch.changed.connect()?;
        }
        let connected = self.simulator.connect();
        connected.map_err(|source| failed(&self.leader, None, source))
    }

    /// Lets all processes build their data of the map.
    pub(super) fn prepare(&mut self) -> Result<(), InProcessError> {
        self.followers.prepare()?;
        let mut branches = self.branches.iter_mut();
        branches.try_for_each(|branch| branch.changed.prepare())
    }

    /// Puts the robots of recordings where these have them at a tick whose state is still to be published.
    pub(super) fn follow(&mut self, tracks: &[Track], tick: u64) {
        for track in tracks {
            if let Some((pose, twist)) = track.poses.get(tick as usize) {
                let scan = track.scans.get(tick as usize).cloned();
                self.simulator.follow(track.robot, *pose, *twist, scan);
            }
        }
    }

    /// Returns the current tick.
    pub(super) fn tick(&self) -> u64 {
        self.simulator.tick()
    }

    /// Executes the current tick except the step of the world: publishes the state, steps the processes, and takes
    /// the commands. Returns `true` if the game is over; this last tick has no steps of processes.
    pub(super) fn turn(&mut self) -> Result<bool, InProcessError> {
        if self.sense()? {
            return Ok(true);
        }
        self.act()?;
        Ok(false)
    }

    /// Does the first part of [`Self::turn`]: publishes the state, and steps the processes before the first one with its
    /// own kind.
    pub(super) fn sense(&mut self) -> Result<bool, InProcessError> {
        self.begin_branches()?;
        let tick = self.simulator.tick();
        let published = self.simulator.publish();
        if published.map_err(|source| failed(&self.leader, Some(tick), source))? {
            return Ok(true);
        }
        self.followers.step_early(tick)?;
        Ok(false)
    }

    /// Does the second part: steps the other processes, and takes the commands.
    pub(super) fn act(&mut self) -> Result<(), InProcessError> {
        let tick = self.simulator.tick();
        self.followers.step_late(tick)?;
        let taken = self.simulator.take_commands();
        taken.map_err(|source| failed(&self.leader, Some(tick), source))?;
        let mut branches = self.branches.iter_mut();
        branches.try_for_each(|branch| branch.changed.step(tick))
    }

    /// Returns the world.
    pub(super) fn world(&self) -> &World {
        self.simulator.world()
    }

    /// Returns world and processes without messages, if the processes before the first one with its own kind need none;
    /// those after it are left out.
    pub(super) fn into_direct(self) -> Result<DirectRun, Box<Self>> {
        if !self
            .followers
            .early()
            .all(|follower| follower.process.is_direct())
        {
            return Err(Box::new(self));
        }
        let followers = self.followers.into_early();
        let direct =
            |follower: LocalProcess| Some((follower.name, follower.process.into_direct()?));
        Ok(DirectRun {
            world: self.simulator.into_world(),
            processes: followers.filter_map(direct).collect(),
        })
    }

    /// Steps the world to the next tick.
    pub(super) fn advance(&mut self) {
        self.simulator.advance(0);
    }
}
