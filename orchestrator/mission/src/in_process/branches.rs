//! Branches of a run in one thread: changes that count from a tick on.
//!
//! A process that a branch changes exists twice until its tick. The changed one receives the messages of the run from the
//! first tick on, and its own reach no process. At the tick it takes the place of the other one, with the memory (beliefs, laps,
//! plans) that it would have of this past. World and simulator are changed at the tick: poses, contacts and times stay.

use std::cell::Cell;
use std::collections::{BTreeMap, VecDeque};
use std::rc::Rc;
use std::sync::Arc;

use geometry::pose::{Pose2, Twist2};
use ipc_types::bus::Bus;
use runtime::declaration::Flow;
use runtime::maps::Maps;
use scenario::ResolvedScenario;
use scenario::kind::ConfiguredKind;
use simulator::SimulatorParams;
use simulator::process::Simulator;

use super::super::error::{InProcessError, MissionError};
use super::super::plan::{Launch, Plan, Role};
use super::hosted::Host;
use super::processes::{LocalProcess, LocalProcesses, failed, open_process, order};

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
    /// Places to which robots are moved at the tick.
    pub places: Vec<GivenPlace>,
}

/// Place to which a robot is moved; its velocity stays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenPlace {
    /// Index of the robot.
    pub robot: usize,
    /// Position (m).
    pub position: [f64; 2],
    /// Heading (rad); `None`: its own.
    pub heading: Option<f64>,
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
    pub(super) tick: u64,
    params: SimulatorParams,
    commands: Vec<GivenCommand>,
    places: Vec<GivenPlace>,
    /// Names of the processes from the tick on, in their order.
    order: Vec<String>,
    /// Set before the tick.
    mute: Rc<Cell<bool>>,
    pub(super) changed: LocalProcesses,
}

/// Opens the changed processes of branches, whose ticks ascend.
///
/// # Errors
/// [`MissionError`]: a changed process cannot be opened, or answers requests.
pub(super) fn prepared(
    plan: &Plan,
    branches: &[Branch],
    programs: &BTreeMap<String, ConfiguredKind>,
    bus: &Bus,
    maps: &Arc<Maps>,
    host: Option<&Host>,
) -> Result<VecDeque<PreparedBranch>, MissionError> {
    let mut all = VecDeque::new();
    let (mut last, mut seeds) = (plan.clone(), BTreeMap::new());
    for branch in branches {
        let mut next = Plan::new(&branch.scenario, "warn")?;
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
            let mut process = bus.muted(&mute, || {
                open_process(launch, followers, program, bus, host)
            })?;
            process.process.share_maps(maps);
            changed.push(process);
        }
        all.push_back(PreparedBranch {
            tick: branch.tick,
            params: params.clone(),
            commands: branch.commands.clone(),
            places: branch.places.clone(),
            order: order.iter().map(|l| l.config.name.clone()).collect(),
            mute,
            changed: LocalProcesses::from_list(changed),
        });
        last = next;
    }
    Ok(all)
}

impl PreparedBranch {
    /// Begins it at the current tick.
    ///
    /// # Errors
    /// [`InProcessError`]: the simulator `leader` refuses its parameters, or a robot cannot be at its place.
    pub(super) fn begin(
        self,
        leader: &str,
        simulator: &mut Simulator,
        followers: &mut LocalProcesses,
    ) -> Result<(), InProcessError> {
        let continued = simulator.continue_by(&self.params);
        continued.map_err(|source| failed(leader, Some(self.tick), source))?;
        let robots = simulator.world().robots();
        let pose = |place: &GivenPlace| {
            let robot = robots.get(place.robot)?;
            let [x, y] = place.position;
            let theta = place.heading.unwrap_or(robot.pose.theta);
            Some((place.robot, Pose2::new(x, y, theta)))
        };
        let places: Vec<_> = self.places.iter().filter_map(pose).collect();
        simulator.shift(&places).map_err(|source| {
            let (tick, source) = (self.tick, Box::new(source));
            InProcessError::Place { tick, source }
        })?;
        for given in &self.commands {
            simulator.give(given.robot, given.twist, given.ticks);
        }
        self.mute.set(false);
        // A changed process replaces the one with its name, whose ports close.
        let present = std::mem::take(&mut followers.processes);
        let all = present.into_iter().chain(self.changed.processes);
        let mut by_name: BTreeMap<String, LocalProcess> =
            all.map(|process| (process.name.clone(), process)).collect();
        let ordered = self.order.iter().filter_map(|name| by_name.remove(name));
        *followers = LocalProcesses::from_list(ordered.collect());
        Ok(())
    }
}

/// Returns `true` if two configurations of a process differ.
fn is_changed(before: &Launch, after: &Launch) -> bool {
    before.config != after.config || before.program() != after.program()
}
