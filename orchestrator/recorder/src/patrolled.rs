//! Idleness of patrolled contours and graphs.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::RobotState;
use ipc_types::topics::{TopicId, WorldState};
use metrics::idleness::{Idleness, NodeIdleness, Places, Ring};
use nalgebra::Point2;

use super::run_info::{PatrolInfo, RobotInfo};
use super::summary::{NodeOutcome, OutcomePart, PatrolOutcome, Summary};

/// Idleness of a contour or of a graph.
#[derive(Debug, Clone)]
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

/// Idleness of a patrol, from the states of its robots.
#[derive(Debug, Clone)]
pub struct PatrolMeasurement {
    /// Indices of the robots.
    robots: Vec<u32>,
    names: Vec<String>,
    idleness: Measured,
    /// Positions of the robots in the current tick (m); `None` out of play.
    positions: Vec<Option<Point2<f64>>>,
}

impl PatrolMeasurement {
    /// Begins the measurement of each of these patrols that has places; `robots` are those of the run.
    pub fn of_all(patrols: &[PatrolInfo], robots: &[RobotInfo]) -> Vec<Self> {
        let name = |&robot: &u32| Some(robots.get(robot as usize)?.name.clone());
        let patrol = |info: &PatrolInfo| {
            Some(Self {
                names: info.robots.iter().filter_map(name).collect(),
                idleness: Measured::new(info)?,
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
        let positions = self.positions.iter().copied();
        match &mut self.idleness {
            Measured::Contour(idleness) => idleness.add(time_s, positions),
            Measured::Graph(idleness) => idleness.add(time_s, positions.flatten()),
        }
    }

    /// Names of the robots.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The places.
    pub fn places(&self) -> &Places {
        match &self.idleness {
            Measured::Contour(idleness) => idleness.places(),
            Measured::Graph(idleness) => idleness.places(),
        }
    }

    /// Both ends of each place, x and y (m); twice the same of a node.
    pub fn ends(&self) -> Vec<[[f64; 2]; 2]> {
        let plain = |ends: [Point2<f64>; 2]| ends.map(Into::into);
        match &self.idleness {
            Measured::Contour(idleness) => idleness.ends().map(plain).collect(),
            Measured::Graph(idleness) => idleness.nodes().map(|(at, _)| plain([at; 2])).collect(),
        }
    }
}

/// All patrols.
#[derive(Debug, Clone)]
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
