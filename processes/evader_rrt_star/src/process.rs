//! Connects [`RrtStarEvader`] to its topics: state, map and exact shapes in; command, plan and tree
//! out.

use ipc_types::messages::robot::TreeEdge;
use planner::{
    Declaration, Input, Output, PlannedPoint, Planner, PlannerError, headed_for, limits,
};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use runtime::config::RobotInfo;

use crate::evader::SHOWN_EDGES;
use crate::{RrtStarEvader, RrtStarParams};

/// Process of one evader.
#[derive(Debug)]
pub struct RrtStarPlanner {
    evader: RrtStarEvader,
    /// Its highest speed (m/s).
    v_max: f64,
    tree: Vec<TreeEdge>,
}

impl Planner for RrtStarPlanner {
    const NAME: &'static str = "evader_rrt_star";
    const SUMMARY: &'static str = "plans its path to an exit past the Police with RRT*";

    type Params = RrtStarParams;

    fn presets() -> Vec<(&'static str, RrtStarParams)> {
        vec![
            ("paper", RrtStarParams::paper()),
            ("paper_arc", RrtStarParams::paper_arc()),
        ]
    }

    fn declare(_: &RrtStarParams) -> Declaration {
        Declaration::default()
            .reads(Input::SHAPES.optional())
            .writes(Output::tree(SHOWN_EDGES))
    }

    fn new(params: &RrtStarParams, robot: &RobotInfo, seed: u64) -> Result<Self, PlannerError> {
        let limits = limits(robot)?;
        let evader = RrtStarEvader::new(*params, limits, seed)?;
        Ok(Self {
            evader,
            v_max: limits.v_max(),
            tree: Vec::new(),
        })
    }

    fn prepare(&mut self, map: &PlannerMap, robot: &RobotInfo) {
        self.evader.prepare(map, robot.model.radius);
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.evader.command(map, view)
    }

    fn plan(&self, steering: &Steering, out: &mut Vec<PlannedPoint>) {
        let Some(route) = self.evader.route() else {
            return headed_for(steering, out);
        };
        let progress = self.evader.progress();
        let points = route.path.points().iter().zip(route.path.along());
        let ahead = points.filter(|&(_, &along)| along > progress);
        out.extend(ahead.map(|(&at, &along)| PlannedPoint {
            at,
            theta: route.path.direction(along).unwrap_or(0.0),
            time_s: (along - progress) / self.v_max,
            v: self.v_max,
        }));
    }

    fn tree(&mut self) -> Option<&[TreeEdge]> {
        let edges = self.evader.take_tree()?;
        self.tree.clear();
        self.tree.extend(edges.iter().map(|edge| TreeEdge {
            from_x: edge.from.x as f32,
            from_y: edge.from.y as f32,
            to_x: edge.to.x as f32,
            to_y: edge.to.y as f32,
            cost: edge.cost as f32,
            on_path: u32::from(edge.on_path),
        }));
        Some(&self.tree)
    }
}
