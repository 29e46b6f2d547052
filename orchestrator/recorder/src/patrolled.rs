//! Idleness of patrols.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::RobotState;
use ipc_types::topics::{TopicId, WorldState};
use metrics::idleness::{Idleness, IdlenessNow, Ring};
use nalgebra::Point2;

use super::run_info::{PatrolInfo, RobotInfo};
use super::summary::{OutcomePart, PatrolOutcome, Summary};

/// Idleness of a patrol, from the states of its robots.
#[derive(Debug)]
pub struct PatrolMeasurement {
    /// Indices of the robots.
    robots: Vec<u32>,
    names: Vec<String>,
    idleness: Idleness,
    /// Positions of the robots in the current tick (m); `None` out of play.
    positions: Vec<Option<Point2<f64>>>,
}

impl PatrolMeasurement {
    /// Begins the measurement of each of these patrols that has a length; `robots` are those of the run.
    pub fn of_all(patrols: &[PatrolInfo], robots: &[RobotInfo]) -> Vec<Self> {
        let name = |&robot: &u32| Some(robots.get(robot as usize)?.name.clone());
        let patrol = |info: &PatrolInfo| {
            let contour: Vec<Point2<f64>> = info.contour.iter().map(|&p| p.into()).collect();
            Some(Self {
                names: info.robots.iter().filter_map(name).collect(),
                idleness: Idleness::new(Ring::new(&contour)?, info.robots.len()),
                positions: vec![None; info.robots.len()],
                robots: info.robots.clone(),
            })
        };
        patrols.iter().filter_map(patrol).collect()
    }

    /// Adds the states of the robots at a time (s), not before the last one.
    pub fn add(&mut self, time_s: f64, states: impl IntoIterator<Item = RobotState>) {
        for state in states {
            let at = self.robots.iter().position(|&robot| robot == state.robot);
            if let Some(position) = at.and_then(|at| self.positions.get_mut(at)) {
                *position = (state.status == 0).then(|| Point2::new(state.x, state.y));
            }
        }
        self.idleness.add(time_s, self.positions.iter().copied());
    }

    /// Names of the robots.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Idleness at the last time.
    pub fn now(&self) -> IdlenessNow {
        self.idleness.now()
    }

    /// Time since the last visit of each place, or since time 0 without one (s).
    pub fn idle_s(&self) -> impl Iterator<Item = f64> {
        self.idleness.idle_s()
    }

    /// Time of the last visit of each place (s); `None` without one.
    pub fn last_visits(&self) -> &[Option<f64>] {
        self.idleness.last_visits()
    }

    /// Both ends of each place (m).
    pub fn ends(&self) -> impl Iterator<Item = [Point2<f64>; 2]> {
        self.idleness.ends()
    }
}

/// All patrols.
#[derive(Debug)]
pub(super) struct Patrolled(pub(super) Vec<PatrolMeasurement>);

impl Consumer for Patrolled {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::WorldState]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        if self.0.is_empty() {
            return;
        }
        let Some((_, states)) = message.view::<WorldState>() else {
            return;
        };
        for patrol in &mut self.0 {
            patrol.add(message.time_s(), states.clone());
        }
    }
}

impl OutcomePart for Patrolled {
    fn finish(self: Box<Self>, summary: &mut Summary) {
        let outcome = |patrol: PatrolMeasurement| {
            let figures = patrol.idleness.figures();
            PatrolOutcome {
                robots: patrol.names,
                mean_idleness_s: figures.map(|f| f.mean_s),
                worst_idleness_s: figures.map(|f| f.worst_s),
                std_idleness_s: figures.map(|f| f.std_s),
                nearest_m: figures.and_then(|f| f.nearest_m),
            }
        };
        summary.patrols = self.0.into_iter().map(outcome).collect();
    }
}
