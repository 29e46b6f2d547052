//! Idleness of patrolled contours.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::topics::{TopicId, WorldState};
use metrics::idleness::{Idleness, Ring};
use nalgebra::Point2;

use super::run_info::{PatrolInfo, RobotInfo};
use super::summary::{OutcomePart, PatrolOutcome, Summary};

/// A contour with its robots.
#[derive(Debug)]
struct Patrol {
    /// Indices of the robots.
    robots: Vec<u32>,
    names: Vec<String>,
    idleness: Idleness,
    /// Positions of the robots in the current tick (m); `None` out of play.
    positions: Vec<Option<Point2<f64>>>,
}

/// All contours.
#[derive(Debug)]
pub(super) struct Patrolled(Vec<Patrol>);

impl Patrolled {
    /// Creates the measurement of these patrols.
    pub(super) fn new(patrols: &[PatrolInfo], robots: &[RobotInfo]) -> Self {
        let name = |&robot: &u32| Some(robots.get(robot as usize)?.name.clone());
        let patrol = |info: &PatrolInfo| {
            let contour: Vec<Point2<f64>> = info.contour.iter().map(|&p| p.into()).collect();
            Some(Patrol {
                names: info.robots.iter().filter_map(name).collect(),
                idleness: Idleness::new(Ring::new(&contour)?, info.robots.len()),
                positions: vec![None; info.robots.len()],
                robots: info.robots.clone(),
            })
        };
        Self(patrols.iter().filter_map(patrol).collect())
    }
}

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
        for state in states {
            for patrol in &mut self.0 {
                let at = patrol.robots.iter().position(|&robot| robot == state.robot);
                let at = at.and_then(|at| patrol.positions.get_mut(at));
                if let Some(position) = at {
                    *position = (state.status == 0).then(|| Point2::new(state.x, state.y));
                }
            }
        }
        for patrol in &mut self.0 {
            let positions = patrol.positions.iter().copied();
            patrol.idleness.add(message.time_s(), positions);
        }
    }
}

impl OutcomePart for Patrolled {
    fn finish(self: Box<Self>, summary: &mut Summary) {
        let outcome = |patrol: Patrol| {
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
