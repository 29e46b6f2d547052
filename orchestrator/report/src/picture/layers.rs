//! Plans, trees, verdicts and dominance regions in a picture of a moment.

use std::collections::BTreeMap;

use ipc_types::messages::referee::{DominanceCell, DominanceHeader, Verdict};
use ipc_types::messages::robot::{PlanPoint, TreeEdge};

use crate::run_model::{Cells, is_grid};

/// Maximum number of points of a plan, and of edges of a tree, that are stored.
const MAX_PARTS: usize = 4000;
/// Maximum number of dominance cells that are stored: that of the largest map of a scenario.
const MAX_CELLS: usize = 64 << 20;
/// Maximum coordinate of a world (m).
const MAX_COORDINATE: f32 = 1e6;

/// The planned path of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanTrace {
    /// Index of the robot.
    pub robot: usize,
    /// Its points, x and y (m); the first is the robot's position.
    pub points: Vec<[f32; 2]>,
    /// The point that the robot heads for in the end, if the path does not go there, x and y (m).
    pub aim: Option<[f32; 2]>,
}

/// The verdict of a referee on an evader.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VerdictTrace {
    /// Index of the evader.
    pub robot: usize,
    /// `true` if it can escape whatever the pursuers do.
    pub is_possible: bool,
    /// Time by which it is at the exit before any pursuer (s).
    pub margin_s: f64,
}

impl VerdictTrace {
    /// Returns the verdict in words.
    pub(super) fn words(&self) -> String {
        match self.margin_s {
            _ if !self.is_possible => "can be stopped".to_owned(),
            margin if margin.is_finite() => format!("escape possible by {margin:.1} s"),
            _ => "escape possible".to_owned(),
        }
    }
}

/// The search tree of a robot's plan.
#[derive(Debug, Clone, PartialEq)]
pub struct TreeTrace {
    /// Index of the robot.
    pub robot: usize,
    /// Both ends of every edge, x and y (m).
    pub edges: Vec<[[f32; 2]; 2]>,
}

/// Dominance regions of the teams, as cells.
#[derive(Debug, Clone, PartialEq)]
pub struct DominanceTrace {
    /// Cells that a pursuer reaches first.
    pub police: Cells,
    /// Cells that an evader reaches safely.
    pub evader: Cells,
    /// Cells that an evader reaches first, but not safely.
    pub cut_off: Cells,
}

/// The last plan, tree and verdict of every robot and the last dominance regions, updated by messages.
#[derive(Debug, Default)]
pub(super) struct Layers {
    pub(super) verdicts: BTreeMap<usize, VerdictTrace>,
    pub(super) plans: BTreeMap<usize, PlanTrace>,
    pub(super) trees: BTreeMap<usize, TreeTrace>,
    pub(super) dominance: Option<DominanceTrace>,
}

impl Layers {
    /// Replaces the plan of a robot at a position (m); a plan without points removes it.
    pub(super) fn plan(&mut self, robot: usize, at: Option<[f64; 2]>, points: &[PlanPoint]) {
        let is_aimed = is_aimed(points);
        let planned = points.iter().map(|p| [p.x, p.y]).take(MAX_PARTS);
        // Without a plan, no line from the robot.
        let start = at.filter(|_| !points.is_empty());
        let all = start.into_iter().chain(planned);
        // A value that does not fit an f32 becomes infinite, and is rejected.
        let all = all.map(|p| p.map(|c| c as f32)).filter(|&p| near(p));
        let mut points: Vec<[f32; 2]> = all.collect();
        let aim = if is_aimed { points.pop() } else { None };
        self.plans.insert(robot, PlanTrace { robot, points, aim });
    }

    /// Replaces the verdict on a robot.
    pub(super) fn verdict(&mut self, verdict: &Verdict) {
        let robot = verdict.robot as usize;
        let verdict = VerdictTrace {
            robot,
            is_possible: verdict.escape_possible != 0,
            margin_s: verdict.margin,
        };
        self.verdicts.insert(robot, verdict);
    }

    /// Replaces the tree of a robot.
    pub(super) fn tree(&mut self, robot: usize, edges: &[TreeEdge]) {
        let edges = edges
            .iter()
            .map(|e| [[e.from_x, e.from_y], [e.to_x, e.to_y]])
            .filter(|&[from, to]| near(from) && near(to))
            .take(MAX_PARTS)
            .collect();
        self.trees.insert(robot, TreeTrace { robot, edges });
    }

    /// Replaces the dominance regions; ignores cells that do not match the header.
    pub(super) fn dominance(&mut self, header: &DominanceHeader, cells: &[DominanceCell]) {
        let (side, width) = (header.resolution, header.width as usize);
        let origin = [header.origin_x, header.origin_y];
        let is_sound = is_grid(cells.len(), width, header.height, side, origin);
        if !is_sound || cells.len() > MAX_CELLS {
            return;
        }
        let of = |owner: u8| Cells {
            origin,
            side,
            width,
            occupied: cells.iter().map(|cell| cell.owner == owner).collect(),
        };
        self.dominance = Some(DominanceTrace {
            police: of(1),
            evader: of(2),
            cut_off: of(3),
        });
    }

    /// Keeps those of the robots that are still in the game.
    pub(super) fn keep(&mut self, plays: impl Fn(usize) -> bool) {
        self.plans
            .retain(|&robot, plan| plays(robot) && plan.points.len() > 1);
        self.trees
            .retain(|&robot, tree| plays(robot) && !tree.edges.is_empty());
        self.verdicts.retain(|&robot, _| plays(robot));
    }
}

/// Returns `true` if the last point of a plan is what the robot heads for in the end, not a part of its path: planners
/// without a path publish the next point and the last one, without times.
pub(crate) fn is_aimed(points: &[PlanPoint]) -> bool {
    points.len() == 2 && points.iter().all(|p| p.time_s == 0.0)
}

fn near(p: [f32; 2]) -> bool {
    p.iter().all(|c| c.abs() <= MAX_COORDINATE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_plan_and_tree_of_active_robots_are_kept() {
        let mut layers = Layers::default();
        let at = |x: f64| PlanPoint {
            x,
            ..PlanPoint::default()
        };
        let start = Some([0.5, 0.0]);
        layers.plan(0, start, &[at(1.0), at(2.0)]);
        layers.plan(0, start, &[at(3.0), at(f64::NAN), at(1e9), at(4.0)]);
        layers.plan(1, start, &[at(1.0), at(2.0)]);
        layers.plan(2, start, &[]);
        layers.plan(4, start, &[at(1.0), at(2.0)]);
        for (robot, escape_possible) in [(1, 1), (4, 0), (4, 1)] {
            layers.verdict(&Verdict {
                robot,
                escape_possible,
                margin: 2.34,
                ..Verdict::default()
            });
        }
        layers.tree(0, &[TreeEdge::default()]);
        layers.tree(
            3,
            &[TreeEdge {
                from_x: f32::INFINITY,
                ..TreeEdge::default()
            }],
        );
        layers.keep(|robot| robot != 1);
        let done = layers;
        assert_eq!(done.plans.len(), 2);
        assert_eq!(done.plans[&0].points, [[0.5, 0.0], [3.0, 0.0], [4.0, 0.0]]);
        // Two points without times: the next one, and the one that the robot heads for.
        assert_eq!(done.plans[&4].points, [[0.5, 0.0], [1.0, 0.0]]);
        assert_eq!(
            (done.plans[&0].aim, done.plans[&4].aim),
            (None, Some([2.0, 0.0]))
        );
        assert_eq!(done.trees.len(), 1);
        let words: Vec<String> = done.verdicts.values().map(VerdictTrace::words).collect();
        assert_eq!(words, ["escape possible by 2.3 s"]);
        assert!(done.dominance.is_none());
    }

    #[test]
    fn dominance_cells_are_split_by_team_if_they_match_the_grid() {
        let header = DominanceHeader {
            width: 2,
            height: 2,
            resolution: 0.5,
            ..DominanceHeader::default()
        };
        let cells = [0, 1, 2, 3].map(|owner| DominanceCell {
            owner,
            ..DominanceCell::default()
        });
        let mut layers = Layers::default();
        layers.dominance(&header, &cells[1..]);
        layers.dominance(
            &DominanceHeader {
                resolution: f64::NAN,
                ..header
            },
            &cells,
        );
        assert!(layers.dominance.is_none());
        layers.dominance(&header, &cells);
        let dominance = layers.dominance.unwrap();
        assert_eq!(dominance.police.occupied, [false, true, false, false]);
        assert_eq!(dominance.evader.occupied, [false, false, true, false]);
        assert_eq!(dominance.cut_off.occupied, [false, false, false, true]);
    }
}
