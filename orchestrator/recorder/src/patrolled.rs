//! Idleness of patrolled contours and graphs.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::topics::{TopicId, WorldState};
use metrics::idleness::{Idleness, NodeIdleness, Ring};
use nalgebra::Point2;

use super::run_info::{PatrolInfo, RobotInfo};
use super::summary::{NodeOutcome, OutcomePart, PatrolOutcome, Summary};

/// Idleness of a contour or of a graph.
#[derive(Debug)]
enum Measured {
    Contour(Idleness),
    Graph(NodeIdleness),
}

impl Measured {
    fn new(info: &PatrolInfo) -> Option<Self> {
        let points = |points: &[[f64; 2]]| points.iter().map(|&p| p.into()).collect::<Vec<_>>();
        if let Some(graph) = &info.graph {
            let idleness = NodeIdleness::new(points(&graph.nodes), graph.visit_m);
            return Some(Self::Graph(idleness));
        }
        let ring = Ring::new(&points(&info.contour))?;
        Some(Self::Contour(Idleness::new(ring, info.robots.len())))
    }
}

/// A contour or a graph with its robots.
#[derive(Debug)]
struct Patrol {
    /// Indices of the robots.
    robots: Vec<u32>,
    names: Vec<String>,
    idleness: Measured,
    /// Positions of the robots in the current tick (m); `None` out of play.
    positions: Vec<Option<Point2<f64>>>,
}

/// All patrols.
#[derive(Debug)]
pub(super) struct Patrolled(Vec<Patrol>);

impl Patrolled {
    /// Creates the measurement of these patrols.
    pub(super) fn new(patrols: &[PatrolInfo], robots: &[RobotInfo]) -> Self {
        let name = |&robot: &u32| Some(robots.get(robot as usize)?.name.clone());
        let patrol = |info: &PatrolInfo| {
            Some(Patrol {
                names: info.robots.iter().filter_map(name).collect(),
                idleness: Measured::new(info)?,
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
            let (time_s, positions) = (message.time_s(), patrol.positions.iter().copied());
            match &mut patrol.idleness {
                Measured::Contour(idleness) => idleness.add(time_s, positions),
                Measured::Graph(idleness) => idleness.add(time_s, positions.flatten()),
            }
        }
    }
}

impl OutcomePart for Patrolled {
    fn finish(self: Box<Self>, summary: &mut Summary) {
        let outcome = |patrol: Patrol| {
            let (figures, nodes) = match &patrol.idleness {
                Measured::Contour(idleness) => (idleness.figures(), Vec::new()),
                Measured::Graph(idleness) => {
                    let nodes = idleness.nodes().map(|(at, figures)| NodeOutcome {
                        x: at.x,
                        y: at.y,
                        visits: figures.visits,
                        mean_interval_s: figures.interval_s,
                        worst_idleness_s: figures.worst_s,
                        idleness_s: figures.idle_s,
                    });
                    (idleness.figures(), nodes.collect())
                }
            };
            PatrolOutcome {
                robots: patrol.names,
                mean_idleness_s: figures.map(|f| f.mean_s),
                worst_idleness_s: figures.map(|f| f.worst_s),
                std_idleness_s: figures.map(|f| f.std_s),
                mean_interval_s: figures.and_then(|f| f.interval_s),
                nearest_m: figures.and_then(|f| f.nearest_m),
                nodes,
            }
        };
        summary.patrols = self.0.into_iter().map(outcome).collect();
    }
}
