//! Branches of a run in one thread: changes that count from a tick on.
//!
//! A process that a branch changes exists twice until its tick. The changed one receives the messages of the run from the
//! first tick on, and its own reach nobody. At the tick it takes the place of the other one, with the memory (beliefs, laps,
//! plans) that it would have of this past. World and simulator are changed at the tick: poses, contacts and times stay.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

use geometry::pose::Twist2;
use ipc_types::bus::Bus;
use runtime::declaration::Flow;
use runtime::maps::Maps;
use scenario::ResolvedScenario;
use scenario::kind::ConfiguredKind;
use simulator::SimulatorParams;

use super::super::error::{InProcessError, MissionError};
use super::super::plan::{Launch, Plan, Role};
use super::processes::{LocalProcess, LocalProcesses, LocalRun, failed, open_process, order};

/// Change of a run from a tick on.
#[derive(Debug, Clone)]
pub struct Branch {
    /// First tick with the change.
    pub tick: u64,
    /// The scenario from then on, with the map, robots, starts, processes, events and links of the run.
    pub scenario: ResolvedScenario,
    /// Other seeds of the random streams of processes, by name.
    pub seeds: BTreeMap<String, u64>,
    /// Commands in place of those of the planners.
    pub commands: Vec<GivenCommand>,
}

/// Command that a robot gets in place of its planner's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenCommand {
    /// Index of the robot.
    pub robot: usize,
    /// The command.
    pub twist: Twist2,
    /// Number of ticks, from that of the branch on.
    pub ticks: u64,
}

/// A branch whose tick is still to come.
pub(super) struct PreparedBranch {
    tick: u64,
    params: SimulatorParams,
    commands: Vec<GivenCommand>,
    /// Names of the processes from the tick on, in their order.
    order: Vec<String>,
    /// Set before the tick.
    mute: Rc<Cell<bool>>,
    pub(super) changed: LocalProcesses,
}

impl LocalRun {
    /// Opens the changed processes of branches, whose ticks ascend.
    ///
    /// # Errors
    /// [`MissionError`]: a changed process cannot be opened, or answers requests.
    pub(super) fn add_branches(
        &mut self,
        plan: &Plan,
        branches: &[Branch],
        programs: &BTreeMap<String, ConfiguredKind>,
        bus: &Bus,
        maps: &Arc<Maps>,
    ) -> Result<(), MissionError> {
        let (mut last, mut seeds) = (plan.clone(), BTreeMap::new());
        for branch in branches {
            let mut next = Plan::new(&branch.scenario, Path::new(""), "", "warn")?;
            seeds.extend(&branch.seeds);
            for launch in &mut next.launches {
                let Some(&&seed) = seeds.get(&launch.config.name) else {
                    continue;
                };
                launch.config.run.seed = seed;
                if let Role::Simulator(params) = &mut launch.role {
                    params.world.seed = seed;
                }
            }
            let Some((_, params, followers)) = next.split_simulator() else {
                return Err(InProcessError::NoSimulator.into());
            };
            let order = order(followers, |_| false)?;
            let mute = Rc::new(Cell::new(true));
            let mut changed = Vec::new();
            for launch in &order {
                let name = &launch.config.name;
                let before = last.launches.get(launch.config.index as usize);
                if before.is_some_and(|before| !is_changed(before, launch)) {
                    continue;
                }
                let mut outputs = launch.declaration.iter().flat_map(|d| &d.outputs);
                if outputs.any(|output| matches!(output.flow, Flow::Answers(_))) {
                    let is_own = before.is_some_and(|before| before.program() != launch.program());
                    if is_own {
                        return Err(InProcessError::Answers { name: name.clone() }.into());
                    }
                    continue;
                }
                let program = programs.get(name).filter(|_| launch.kind().is_none());
                let mut process = bus.muted(&mute, || open_process(launch, program, bus))?;
                process.process.share_maps(maps);
                changed.push(process);
            }
            self.branches.push_back(PreparedBranch {
                tick: branch.tick,
                params: params.clone(),
                commands: branch.commands.clone(),
                order: order.iter().map(|l| l.config.name.clone()).collect(),
                mute,
                changed: LocalProcesses::from_list(changed),
            });
            last = next;
        }
        Ok(())
    }

    /// Begins the branches of the current tick.
    pub(super) fn begin_branches(&mut self) -> Result<(), InProcessError> {
        let tick = self.tick();
        while self.branches.front().is_some_and(|next| next.tick <= tick)
            && let Some(branch) = self.branches.pop_front()
        {
            let continued = self.simulator.continue_by(&branch.params);
            continued.map_err(|source| failed(&self.leader, Some(tick), source))?;
            for given in &branch.commands {
                self.simulator.give(given.robot, given.twist, given.ticks);
            }
            branch.mute.set(false);
            let present =
                std::mem::replace(&mut self.followers, LocalProcesses::from_list(Vec::new()));
            // A changed process replaces the one with its name, whose ports close.
            let all = present
                .processes
                .into_iter()
                .chain(branch.changed.processes);
            let mut by_name: BTreeMap<String, LocalProcess> =
                all.map(|process| (process.name.clone(), process)).collect();
            let ordered = branch.order.iter().filter_map(|name| by_name.remove(name));
            self.followers = LocalProcesses::from_list(ordered.collect());
        }
        Ok(())
    }
}

/// Returns `true` if two configurations of a process differ.
fn is_changed(before: &Launch, after: &Launch) -> bool {
    before.config != after.config || before.program() != after.program()
}
