//! Parameters of the evader that plans with RRT*.

use evader_potential::EvaderParams;
use guidance::params::{ParamsError, fraction, not_negative, positive, require, within};
use guidance::path_tracking::TrackingParams;
use serde::{Deserialize, Serialize};

use crate::cost::CostParams;

/// Most iterations that a plan may have.
pub const MAX_ITERATIONS: u32 = 1_000_000;

/// Most edges of a tree that are shown.
pub const MAX_TREE_EDGES: u32 = 8192;

/// Parameters of the tree search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "each switches one part of the algorithm, so that its effect can be measured"
)]
pub struct SearchParams {
    /// Iterations of one plan, 1 … 1 000 000.
    pub iterations: u32,
    /// Share of iterations that try to reach a goal, in [0, 1].
    pub goal_bias: f64,
    /// Longest edge that is tried [m], > 0.
    pub max_edge: f64,
    /// Edges must be longer than this [m], ≥ 0.
    pub min_edge: f64,
    /// Whether the radius in which nodes are joined shrinks as the tree fills the space: γ √(ln n / n)
    /// with γ = `radius_factor` · 2 √(1.5 · area / π) (Karaman and Frazzoli 2011, theorem 38) for n nodes in the
    /// area that is still sampled. Otherwise it stays `max_edge`.
    pub shrinking_radius: bool,
    /// See `shrinking_radius`; > 0. From 1 on the search converges to the optimum.
    pub radius_factor: f64,
    /// Whether new nodes become parents of nodes that they make cheaper (the star in RRT*).
    pub rewire: bool,
    /// Whether the next cheapest parent is tried where the way from the cheapest is blocked;
    /// otherwise the sample is dropped.
    pub next_best_parent: bool,
    /// Generations of ancestors of near nodes that may become parents too (Quick-RRT*, Jeong et
    /// al. 2019), 0 … 8.
    pub ancestors: u32,
    /// Whether a sample far from all nodes is drawn towards the nearest; otherwise it is dropped.
    pub steer: bool,
    /// Whether only places are sampled over which the way can still become cheaper (Informed RRT*,
    /// Gammell et al. 2014).
    pub informed: bool,
    /// Whether the length of the rest of a way is bounded by the shortest way along the streets, as
    /// far as the map allows to know it; otherwise by the straight line.
    pub street_bounds: bool,
    /// Whether nodes that can no longer make the way cheaper are taken out.
    pub prune: bool,
    /// Whether points of the best way that can be left out are left out.
    pub straighten: bool,
    /// Share of iterations that change points of the best way once there is one, in [0, 1].
    pub refine_share: f64,
    /// Whether a plan begins with what can still be used of the last tree.
    pub warm_start: bool,
    /// Most nodes taken over from the last tree.
    pub max_kept: u32,
}

impl Default for SearchParams {
    fn default() -> Self {
        Self {
            iterations: 1500,
            goal_bias: 0.05,
            max_edge: 3.0,
            min_edge: 1e-6,
            shrinking_radius: true,
            radius_factor: 1.0,
            rewire: true,
            next_best_parent: true,
            ancestors: 1,
            steer: true,
            informed: true,
            street_bounds: true,
            prune: true,
            straighten: true,
            refine_share: 0.3,
            warm_start: true,
            max_kept: 1500,
        }
    }
}

impl SearchParams {
    /// The values of the chasing-game paper's experiments.
    pub fn paper() -> Self {
        Self {
            iterations: 1500,
            goal_bias: 0.05,
            max_edge: 3.0,
            min_edge: 0.2,
            shrinking_radius: false,
            radius_factor: 1.0,
            rewire: false,
            next_best_parent: false,
            ancestors: 0,
            steer: false,
            informed: false,
            street_bounds: false,
            prune: false,
            straighten: false,
            refine_share: 0.0,
            warm_start: false,
            max_kept: 0,
        }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        require(
            (1..=MAX_ITERATIONS).contains(&self.iterations),
            "iterations",
            &self.iterations,
            "a number from 1 to 1000000: without iterations there is no plan",
        )?;
        fraction("goal_bias", self.goal_bias)?;
        positive("max_edge", self.max_edge)?;
        not_negative("min_edge", self.min_edge)?;
        require(
            self.min_edge < self.max_edge,
            "min_edge",
            &self.min_edge,
            "less than `max_edge`",
        )?;
        positive("radius_factor", self.radius_factor)?;
        require(
            self.ancestors <= 8,
            "ancestors",
            &self.ancestors,
            "a number from 0 to 8",
        )?;
        fraction("refine_share", self.refine_share)?;
        require(
            self.goal_bias + self.refine_share < 1.0,
            "refine_share",
            &self.refine_share,
            "less than 1 - `goal_bias`: something must be left for the tree",
        )?;
        require(
            self.max_kept <= MAX_ITERATIONS,
            "max_kept",
            &self.max_kept,
            "at most 1000000",
        )
    }
}

/// The motion primitive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Primitive {
    /// Straight lines.
    #[default]
    Line,
    /// Circular arcs.
    Arc,
}

/// Parameters of arcs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ArcParams {
    /// Smallest turning radius [m], > 0; absent: the robot's highest speed through its highest
    /// turning rate (as far as the follower may use it).
    pub min_radius: Option<f64>,
    /// Largest bearing of an arc's end from the heading at its start [rad], in (0, π/2]: half of
    /// the largest turn in one arc.
    pub max_bearing: f64,
    /// Whether the robot may turn on the spot before it sets off.
    pub free_start: bool,
}

impl Default for ArcParams {
    fn default() -> Self {
        Self {
            min_radius: None,
            max_bearing: core::f64::consts::FRAC_PI_4,
            free_start: true,
        }
    }
}

impl ArcParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        self.min_radius
            .map_or(Ok(()), |radius| positive("min_radius", radius))?;
        require(
            self.max_bearing > 0.0 && self.max_bearing <= core::f64::consts::FRAC_PI_2,
            "max_bearing",
            &self.max_bearing,
            "a number above 0 and at most π/2",
        )
    }
}

/// Parameters of the time that planning takes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TimingParams {
    /// Whether the world stands still while the evader plans (the paper's experiments): a plan
    /// holds at the tick at which it was begun.
    pub pause: bool,
    /// Simulated time that an iteration takes [s], ≥ 0. A plan holds `iterations` times this after
    /// it was begun; until then the last one is followed. The default is about ten times what the
    /// search takes on a desktop processor: a small robot's.
    pub time_per_iteration_s: f64,
    /// Wall-clock time after which a plan is cut short [s], > 0; absent: never. In real-time runs
    /// only: in lock-step the history must not depend on the machine.
    pub real_time_budget_s: Option<f64>,
}

impl Default for TimingParams {
    fn default() -> Self {
        Self {
            pause: false,
            time_per_iteration_s: 3e-5,
            real_time_budget_s: None,
        }
    }
}

impl TimingParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        not_negative("time_per_iteration_s", self.time_per_iteration_s)?;
        self.real_time_budget_s
            .map_or(Ok(()), |budget| positive("real_time_budget_s", budget))
    }
}

/// When an evader plans anew, as long as its plan still stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ReplanRule {
    /// Every `period_s`, and when a pursuer threatens the path.
    #[default]
    Periodic,
    /// The chasing-game paper's: every `period_s` it looks at the pursuers' distances from the
    /// path's segments, each divided by a weight that begins with 1 and is itself divided by the
    /// square of every segment's length; it plans anew if the least is below `paper_threshold`.
    Paper,
}

/// Parameters of replanning. Without a path, off it, and when an obstacle has come onto it, an
/// evader plans anew as soon as `least_s` lets it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ReplanParams {
    /// Which rule.
    pub rule: ReplanRule,
    /// Time between two plans (`periodic`) or two looks (`paper`) [s], > 0.
    pub period_s: f64,
    /// Shortest time between the beginnings of two plans [s], ≥ 0.
    pub least_s: f64,
    /// A path is threatened when a pursuer can be within this distance [m] of a place on it when
    /// the evader gets there; ≥ 0, 0 for never.
    pub threat_distance: f64,
    /// How far ahead threats are looked for [s], ≥ 0.
    pub threat_horizon_s: f64,
    /// Distance from the path at which it is no longer followed [m], > 0.
    pub off_path: f64,
    /// See [`ReplanRule::Paper`]; > 0.
    pub paper_threshold: f64,
    /// Distance from the exit within which the paper's rule plans at every chance [m], ≥ 0.
    pub paper_near_exit: f64,
}

impl Default for ReplanParams {
    fn default() -> Self {
        Self {
            rule: ReplanRule::Periodic,
            period_s: 0.5,
            least_s: 0.2,
            threat_distance: 0.5,
            threat_horizon_s: 3.0,
            off_path: 0.3,
            paper_threshold: 1.5,
            paper_near_exit: 0.3,
        }
    }
}

impl ReplanParams {
    /// The values of the chasing-game paper's experiments.
    pub fn paper() -> Self {
        Self {
            rule: ReplanRule::Paper,
            period_s: 3.0,
            least_s: 0.0,
            threat_distance: 0.0,
            // The paper's evader never looks whether it is still on its path.
            off_path: 1e3,
            ..Self::default()
        }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        positive("period_s", self.period_s)?;
        not_negative("least_s", self.least_s)?;
        not_negative("threat_distance", self.threat_distance)?;
        not_negative("threat_horizon_s", self.threat_horizon_s)?;
        positive("off_path", self.off_path)?;
        positive("paper_threshold", self.paper_threshold)?;
        not_negative("paper_near_exit", self.paper_near_exit)
    }
}

/// How a path is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Follower {
    /// Pure pursuit.
    #[default]
    PurePursuit,
    /// A potential field from one point of the path to the next, and feedback linearisation (the
    /// chasing-game paper).
    PotentialField,
}

/// Parameters of an [`RrtStarEvader`](crate::RrtStarEvader).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RrtStarParams {
    /// The motion primitive.
    pub primitive: Primitive,
    /// Of arcs.
    pub arc: ArcParams,
    /// The tree.
    pub search: SearchParams,
    /// What ways cost.
    pub cost: CostParams,
    /// Distance kept from walls beyond the robot's own radius [m], ≥ 0: room for the follower.
    pub margin: f64,
    /// Distance by which an exit's centre may be moved to where the robot fits [m], ≥ 0; where
    /// that is not enough, the exit is left out.
    pub goal_tolerance: f64,
    /// The time that planning takes.
    pub timing: TimingParams,
    /// When it plans anew.
    pub replan: ReplanParams,
    /// How paths are followed.
    pub follower: Follower,
    /// Of pure pursuit.
    pub tracking: TrackingParams,
    /// Distance of the control point from a point of the path at which the potential field turns
    /// to the next [m], > 0.
    pub waypoint_reached: f64,
    /// The potential field: of the follower of that name, and of the flight while there is no way.
    pub field: EvaderParams,
    /// Most edges of the tree that are published, at most 8192; 0 for none.
    pub tree_edges: u32,
}

impl Default for RrtStarParams {
    fn default() -> Self {
        Self {
            primitive: Primitive::default(),
            arc: ArcParams::default(),
            search: SearchParams::default(),
            cost: CostParams::default(),
            margin: 0.03,
            goal_tolerance: 0.3,
            timing: TimingParams::default(),
            replan: ReplanParams::default(),
            follower: Follower::default(),
            tracking: TrackingParams::default(),
            waypoint_reached: 0.3,
            field: EvaderParams::default(),
            tree_edges: 512,
        }
    }
}

impl RrtStarParams {
    /// The values of the chasing-game paper's experiments: no rewiring, one candidate for a
    /// parent, the pursuers where they are now, planning in no time. The robot's radius is its
    /// true one all the same.
    pub fn paper() -> Self {
        Self {
            search: SearchParams::paper(),
            cost: CostParams::paper(),
            margin: 0.0,
            timing: TimingParams {
                pause: true,
                ..TimingParams::default()
            },
            replan: ReplanParams::paper(),
            follower: Follower::PotentialField,
            field: EvaderParams::paper(),
            ..Self::default()
        }
    }

    /// The paper's parameters with its first planner's motion primitive, circular arcs.
    pub fn paper_arc() -> Self {
        Self {
            primitive: Primitive::Arc,
            search: SearchParams {
                iterations: 5000,
                max_edge: 1.5,
                ..SearchParams::paper()
            },
            cost: CostParams::length(),
            arc: ArcParams {
                free_start: false,
                ..ArcParams::default()
            },
            ..Self::paper()
        }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] with the path, the value and what was expected, for the first field that is
    /// out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        self.arc.validate().map_err(within("arc"))?;
        self.search.validate().map_err(within("search"))?;
        self.cost.validate().map_err(within("cost"))?;
        not_negative("margin", self.margin)?;
        not_negative("goal_tolerance", self.goal_tolerance)?;
        self.timing.validate().map_err(within("timing"))?;
        self.replan.validate().map_err(within("replan"))?;
        self.tracking.validate().map_err(within("tracking"))?;
        positive("waypoint_reached", self.waypoint_reached)?;
        self.field.validate().map_err(within("field"))?;
        require(
            self.tree_edges <= MAX_TREE_EDGES,
            "tree_edges",
            &self.tree_edges,
            "at most 8192",
        )
    }
}

#[cfg(test)]
mod tests;
