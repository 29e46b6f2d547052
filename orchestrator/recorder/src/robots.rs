//! Outcomes of the robots over a run.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::RobotState;
use ipc_types::topics::{TopicId, WorldState};

use super::run_info::RobotInfo;
use super::summary::{OutcomePart, RobotOutcome, Summary, role_name, seconds, status_name};

/// Outcomes of the robots so far.
#[derive(Debug)]
pub(super) struct Robots {
    tick: u64,
    tick_period_ns: u64,
    list: Vec<Robot>,
}

#[derive(Debug, Clone)]
struct Robot {
    name: String,
    team: String,
    /// Last state.
    state: RobotState,
    /// Time of the last change of status (s).
    decided_s: f64,
    /// Number of fail-safe stops.
    stops: u32,
    /// Number of ticks in fail-safe stops.
    stopped: u64,
}

impl Robots {
    /// Creates the outcomes before the first tick; `tick_period_ns` is the simulated time between two ticks
    /// (ns).
    pub(super) fn new(robots: &[RobotInfo], tick_period_ns: u64) -> Self {
        let robots = robots.iter().map(|robot| Robot {
            name: robot.name.clone(),
            team: robot.team.clone(),
            state: RobotState::default(),
            decided_s: 0.0,
            stops: 0,
            stopped: 0,
        });
        Self {
            tick: 0,
            tick_period_ns,
            list: robots.collect(),
        }
    }

    fn time_s(&self) -> f64 {
        seconds(self.tick.saturating_mul(self.tick_period_ns))
    }
}

impl Consumer for Robots {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::WorldState]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        let Some((header, states)) = message.view::<WorldState>() else {
            return;
        };
        self.tick = header.stamp.tick;
        let now = self.time_s();
        for state in states {
            if let Some(robot) = self.list.get_mut(state.robot as usize) {
                robot.take(now, state);
            }
        }
    }
}

impl Robot {
    fn take(&mut self, time_s: f64, state: RobotState) {
        let is_stopped = state.fail_safe != 0;
        self.stops += u32::from(is_stopped && self.state.fail_safe == 0);
        self.stopped += u64::from(is_stopped);
        if state.status == 0 || self.state.status != state.status {
            self.decided_s = time_s;
        }
        self.state = state;
    }
}

impl OutcomePart for Robots {
    fn finish(self: Box<Self>, summary: &mut Summary) {
        summary.ticks = self.tick;
        summary.sim_time_s = self.time_s();
        let robots = self.list.into_iter().map(|robot| RobotOutcome {
            name: robot.name,
            team: robot.team,
            role: role_name(robot.state.team).to_owned(),
            outcome: status_name(robot.state.status).to_owned(),
            time_s: robot.decided_s,
            distance_m: robot.state.distance,
            contacts: robot.state.contacts,
            fail_safe_stops: robot.stops,
            fail_safe_ticks: robot.stopped,
            ..RobotOutcome::default()
        });
        summary.robots = robots.collect();
    }
}
