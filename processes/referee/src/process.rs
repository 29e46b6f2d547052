//! Connects [`Referee`] to its topics: state and map in, verdicts and pictures out.

use std::sync::Arc;

use ipc_types::bus::{Bus, Publisher, PublisherOptions};
use ipc_types::messages::referee::{DominanceCell, DominanceHeader, Verdict};
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::{Dominance, Verdicts};
use navigation::dominance::{Cell, Owner};
use planner::{planner_map, robot_views, teams};
use planner_view::map::PlannerMap;
use planner_view::view::RobotView;
use robot::team::{Role, Team};
use runtime::declaration::{Declaration, Input, Output};
use runtime::inputs::{MapInput, StateInput, reply_stamp};
use runtime::maps::Maps;
use runtime::{Clock, Process, ProcessConfig, ProcessError, ProcessKind};

use crate::params::RefereeParams;
use crate::referee::{Game, Judgement, Referee};

/// Resolution of the margins in pictures (steps per second): finer ones are invisible and do not
/// compress.
const STEPS: f32 = 64.0;

/// Process of the referee.
pub struct RefereeProcess {
    config: ProcessConfig,
    referee: Referee,
    verdicts_due: TaskSchedule,
    /// Absent without pictures.
    cells_due: Option<TaskSchedule>,
    map: Option<Arc<PlannerMap>>,
    state: StateInput,
    map_input: MapInput,
    verdicts: Publisher<Verdicts>,
    cells: Publisher<Dominance>,
    teams: Vec<Team>,
    views: Vec<RobotView>,
}

/// Schedule of a task with a period in ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct TaskSchedule {
    every: u64,
    last: Option<u64>,
}

impl TaskSchedule {
    /// Returns a schedule with the period `period_s` (s), at least one tick.
    fn new(period_s: f64, tick_s: f64) -> Self {
        // A cast of a float saturates; NaN becomes 0.
        let every = ((period_s / tick_s).round() as u64).max(1);
        Self { every, last: None }
    }

    /// Returns `true` if it is due at this tick. In real time ticks may be missed.
    fn now(&mut self, tick: u64) -> bool {
        let turn = tick / self.every;
        let due = self.last != Some(turn);
        self.last = Some(turn);
        due
    }
}

impl ProcessKind for RefereeProcess {
    const NAME: &'static str = "referee";
    const SUMMARY: &'static str =
        "computes dominance regions, and the evaders that escape whatever the pursuers do";

    type Params = RefereeParams;

    fn declare(_: &RefereeParams) -> Declaration {
        Declaration::default()
            .reads(Input::STATE)
            .reads(Input::MAP)
            .writes(Output::new::<Verdicts>(0))
            .writes(Output::new::<Dominance>(0))
    }

    fn open(
        config: &ProcessConfig,
        params: &RefereeParams,
        bus: &Bus,
    ) -> Result<Self, ProcessError> {
        let run = &config.run;
        let evaders = run.robots.iter().filter(|robot| robot.role == Role::Evader);
        let tick_s = run.tick_period();
        Ok(Self {
            referee: Referee::new(
                *params,
                Game {
                    exits: run.exits.clone(),
                    capture: run.capture_radius,
                    models: run.robots.iter().map(|robot| robot.model).collect(),
                    dt: tick_s,
                },
            ),
            verdicts_due: TaskSchedule::new(params.period_s, tick_s),
            cells_due: (params.cells_period_s > 0.0)
                .then(|| TaskSchedule::new(params.cells_period_s, tick_s)),
            map: None,
            state: StateInput::open(bus, run.robots.len())?,
            map_input: MapInput::open(bus)?,
            verdicts: bus.publisher(PublisherOptions::new(config.index, evaders.count()))?,
            cells: bus.publisher(PublisherOptions::new(
                config.index,
                run.capacity(Input::MAP.flow).unwrap_or(0),
            ))?,
            views: Vec::with_capacity(run.robots.len()),
            teams: teams(&run.robots),
            config: config.clone(),
        })
    }
}

impl Process for RefereeProcess {
    fn share_maps(&mut self, maps: &Arc<Maps>) {
        self.map_input.share(maps);
    }

    fn connect(&mut self) -> Result<(), ProcessError> {
        self.state.connect()?;
        self.map_input.connect()?;
        self.verdicts.update_connections()?;
        self.cells.update_connections()?;
        Ok(())
    }

    fn prepare(&mut self) -> Result<(), ProcessError> {
        self.take_map()
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        let clock = self.config.run.clock;
        self.state.take_turn(tick, clock)?;
        let newest = self.state.header.stamp.tick;
        self.take_map()?;
        let Some(map) = &self.map else {
            if clock == Clock::LockStep {
                let text = "it is the turn of a tick, but no sound world/map has come";
                return Err(ProcessError::Protocol(text.into()));
            }
            return Ok(());
        };
        let with_verdicts = self.verdicts_due.now(newest);
        let with_cells = self.cells_due.as_mut().is_some_and(|due| due.now(newest));
        if !with_verdicts && !with_cells {
            return Ok(());
        }
        robot_views(
            &self.state,
            &self.config.run.robots,
            &self.teams,
            &mut self.views,
        );
        let stamp = reply_stamp(&self.state.header, self.state.received_ns);
        let judgements = self.referee.judge(map, &self.views);
        if with_verdicts && !judgements.is_empty() {
            self.verdicts
                .send_with(PlainHeader { stamp }, judgements.len(), |i| {
                    judgements.get(i).map(verdict).unwrap_or_default()
                })?;
        }
        if with_cells && let Some((arena, cells)) = self.referee.cells(map) {
            let frame = arena.lattice().frame();
            let header = DominanceHeader {
                resolution: frame.resolution,
                origin_x: frame.origin.x,
                origin_y: frame.origin.y,
                width: frame.width as u32,
                height: frame.height as u32,
                revision: map.revision() as u32,
                ..counted(stamp, cells)
            };
            self.cells.send_with(header, cells.len(), |i| {
                cells.get(i).map(cell).unwrap_or_default()
            })?;
        }
        Ok(())
    }

    fn rejected(&self) -> u64 {
        self.state.rejected + self.map_input.rejected
    }
}

impl RefereeProcess {
    fn take_map(&mut self) -> Result<(), ProcessError> {
        if self.map_input.update()? {
            let map = planner_map(&self.map_input, None, false)?;
            let robots = &self.config.run.robots;
            let radii = robots
                .iter()
                .filter(|robot| robot.role != Role::Neutral)
                .map(|robot| robot.model.radius);
            let radius = radii.fold(f64::INFINITY, f64::min);
            if radius.is_finite() {
                self.referee.prepare(&map, radius);
            }
            self.map = Some(map);
        }
        Ok(())
    }
}

fn verdict(judgement: &Judgement) -> Verdict {
    let verdict = &judgement.verdict;
    Verdict {
        margin: verdict.margin,
        time: verdict.time,
        area_share: verdict.area_share,
        robot: judgement.robot as u32,
        exit: verdict.exit.map_or(Verdict::NONE, |exit| exit as u32),
        escape_possible: u8::from(verdict.escape_possible),
        ..Verdict::default()
    }
}

fn cell(cell: &Cell) -> DominanceCell {
    DominanceCell {
        margin: (cell.margin * STEPS).round() / STEPS,
        robot: match cell.owner {
            Owner::Neither => DominanceCell::NO_ROBOT,
            _ => u16::try_from(cell.first).unwrap_or(DominanceCell::NO_ROBOT),
        },
        owner: cell.owner.code(),
        reserved: 0,
    }
}

/// Returns a header with the stamp and the numbers of cells.
fn counted(stamp: Stamp, cells: &[Cell]) -> DominanceHeader {
    let mut header = DominanceHeader {
        stamp,
        ..DominanceHeader::default()
    };
    for cell in cells {
        match cell.owner {
            Owner::Neither => {}
            Owner::Police => header.police_cells += 1,
            Owner::Evader => header.evader_cells += 1,
            Owner::CutOff => header.cut_off_cells += 1,
        }
    }
    header
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_periodic_task_runs_once_per_period_even_if_ticks_are_missed() {
        let mut due = TaskSchedule::new(0.25, 0.05);
        let done: Vec<u64> = [0, 1, 2, 4, 5, 6, 11, 12, 14, 15]
            .into_iter()
            .filter(|&tick| due.now(tick))
            .collect();
        assert_eq!(done, [0, 5, 11, 15]);
        let mut always = TaskSchedule::new(0.0, 0.05);
        assert!((0..5).all(|tick| always.now(tick)));
    }

    #[test]
    fn cells_are_counted_by_owner_and_their_margins_rounded() {
        let of = |owner| Cell {
            owner,
            first: 3,
            margin: 1.23,
        };
        let cells = [Owner::Police, Owner::Evader, Owner::Evader, Owner::Neither].map(of);
        let header = counted(Stamp::default(), &cells);
        assert_eq!(
            (
                header.police_cells,
                header.evader_cells,
                header.cut_off_cells
            ),
            (1, 2, 0)
        );
        assert_eq!(cell(&cells[0]).margin, 79.0 / 64.0);
        assert_eq!(cell(&cells[0]).robot, 3);
        assert_eq!(cell(&cells[3]).robot, DominanceCell::NO_ROBOT);
        assert_eq!(
            cell(&Cell {
                margin: f32::INFINITY,
                ..cells[0]
            })
            .margin,
            f32::INFINITY
        );
    }
}
