//! Parameters of the evader that plans with RRT*.

use parameters::{Parameters, ParamsError, above, at_least, between, require, within};
use pursuit_evasion::potential_evader::EvaderParams;

/// Maximum number of iterations of a plan.
pub const MAX_ITERATIONS: u32 = 1_000_000;

/// Share of iterations that change points of the best path once there is one.
pub(crate) const REFINE_SHARE: f64 = 0.3;

parameters::choice! {
    /// Variant of the search and of the rules that belong to it.
    pub enum Algorithm {
        /// RRT* with the improvements listed at [`Search`](crate::search::Search).
        #[default]
        Improved,
        /// The search of the program that the chasing-game paper's authors published: nodes keep their
        /// first parent, only the cheapest parent is tried, samples come from the whole map, a goal is
        /// reached by samples at the goal only, every plan starts from an empty tree. Pursuers count as
        /// far as 1 mm, and arcs begin along the robot's heading.
        Published,
    }
}

impl Algorithm {
    /// Returns the lower bound on edges (m): they are longer than this.
    pub fn min_edge(self) -> f64 {
        match self {
            Self::Improved => 1e-6,
            Self::Published => 0.2,
        }
    }

    /// Returns the minimum distance of a pursuer in the cost (m): a nearer one counts as this far,
    /// which bounds the danger.
    pub fn closest(self) -> f64 {
        match self {
            Self::Improved => 0.5,
            Self::Published => 1e-3,
        }
    }
}

parameters::table! {
    /// Parameters of the tree search.
    #[derive(Copy)]
    pub struct SearchParams {
        /// The variant of the search.
        pub algorithm: Algorithm = Algorithm::Improved,
        /// Number of iterations of one plan.
        pub iterations: u32 [between(1, MAX_ITERATIONS)] = 1500,
        /// Share of iterations that try to reach a goal.
        pub goal_bias: f64 [at_least(0).below(1.0 - REFINE_SHARE)] = 0.05,
        /// Maximum length of an edge.
        pub max_edge: f64 [above(0).unit("m")] = 3.0,
    }
}

impl Parameters for SearchParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        require(
            self.max_edge > self.algorithm.min_edge(),
            "max_edge",
            &self.max_edge,
            "more than the 0.2 m of the shortest edges of the published search",
        )
    }
}

impl SearchParams {
    /// Returns the values of the chasing-game paper's experiments.
    pub fn paper() -> Self {
        Self {
            algorithm: Algorithm::Published,
            ..Self::default()
        }
    }
}

parameters::choice! {
    /// Formula of the cost of an edge.
    pub enum CostKind {
        /// The edge's length (m): shortest paths, without regard to pursuers.
        Length,
        /// The chasing-game paper's: length + (scale / d)³ with the distance d from the edge to the
        /// nearest pursuer *where it is now*. Per edge, so that a path of many short edges past a
        /// pursuer costs more than the same path in one.
        Paper,
        /// Length + the integral along the edge of weight · (scale / m)³, where m is how far off the
        /// nearest pursuer can still be *when the evader gets there*:
        ///
        /// ```text
        /// m = max(distance − reach · v_pursuer · min(t, horizon), closest),   t = way so far / v_own
        /// ```
        ///
        /// An integral: cutting an edge in two changes nothing.
        #[default]
        TimeAware,
    }
}

parameters::table! {
    /// Parameters of the cost.
    #[derive(Copy)]
    pub struct CostParams {
        /// Formula of the cost.
        pub kind: CostKind = CostKind::TimeAware,
        /// Extra metres per metre of path where the danger is 1 (`time_aware` only).
        pub weight: f64 [at_least(0)] = 1.0,
        /// Share of a pursuer's speed with which it is assumed to approach (`time_aware` only): 1 for a
        /// pursuer that drives straight for the place at once, 0 for one that stays.
        pub reach: f64 [between(0, 1)] = 0.5,
    }
}

impl Parameters for CostParams {}

impl CostParams {
    /// The paper's formula.
    pub fn paper() -> Self {
        Self {
            kind: CostKind::Paper,
            ..Self::default()
        }
    }

    /// The length alone.
    pub fn length() -> Self {
        Self {
            kind: CostKind::Length,
            ..Self::default()
        }
    }
}

parameters::choice! {
    /// The motion primitive.
    pub enum Primitive {
        /// Straight lines.
        #[default]
        Line,
        /// Circular arcs.
        Arc,
    }
}

parameters::table! {
    /// Parameters of arcs.
    #[derive(Copy)]
    pub struct ArcParams {
        /// Smallest turning radius; absent: the robot's highest speed through its highest
        /// turning rate (as far as the follower may use it).
        pub min_radius: Option<f64> [above(0).unit("m")],
    }
}

impl Parameters for ArcParams {}

parameters::table! {
    /// Parameters of the planning time.
    #[derive(Copy)]
    pub struct TimingParams {
        /// Simulated time of an iteration. A plan takes effect `iterations` times this after its start;
        /// until then the last one is followed. With 0 planning takes no simulated time (the paper's
        /// experiments). The default is about ten times the search's time on a desktop processor: that
        /// of a small robot's.
        pub time_per_iteration_s: f64 [at_least(0).unit("s")] = 3e-5,
    }
}

impl Parameters for TimingParams {}

parameters::choice! {
    /// Rule by which an evader replans while its plan is valid.
    pub enum ReplanRule {
        /// Every `period_s`, and when a pursuer threatens the path or the robot has left it; at most
        /// five times a second.
        #[default]
        Periodic,
        /// The chasing-game paper's: every `period_s` it checks the pursuers' distances from the path's
        /// segments, each divided by a weight that begins with 1 and is itself divided by the square of
        /// every segment's length; it replans if the minimum is below 1.5. Within 0.3 m of the exit it
        /// plans at every chance. It never checks that the robot is still on its path. A plan without a
        /// path to an exit drops the last one: the last command continues, and the robot plans at every
        /// chance.
        Paper,
    }
}

impl ReplanRule {
    /// Minimum time between the starts of two plans (s).
    pub fn least_s(self) -> f64 {
        match self {
            Self::Periodic => 0.2,
            Self::Paper => 0.0,
        }
    }

    /// Returns `true` if the last command continues while there is no path to an exit; `false` if
    /// the last path to one is kept, and without one the robot approaches an exit or flees.
    pub fn keeps_command(self) -> bool {
        self == Self::Paper
    }

    /// Distance from the path beyond which the robot no longer follows it (m).
    pub fn off_path(self) -> f64 {
        match self {
            Self::Periodic => 0.3,
            Self::Paper => f64::INFINITY,
        }
    }
}

parameters::table! {
    /// Parameters of replanning. Without a path, off it, and when a new obstacle blocks it, an evader
    /// replans as soon as the rule allows it.
    #[derive(Copy)]
    pub struct ReplanParams {
        /// The rule.
        pub rule: ReplanRule = ReplanRule::Periodic,
        /// Time between two plans (`periodic`) or two checks (`paper`).
        pub period_s: f64 [above(0).unit("s")] = 0.5,
        /// Distance of a threat (`periodic` only): a path is threatened when a pursuer can be this near
        /// to a place on it when the evader gets there; 0 for never.
        pub threat_distance: f64 [at_least(0).unit("m")] = 0.5,
    }
}

impl Parameters for ReplanParams {}

impl ReplanParams {
    /// Returns the values of the chasing-game paper's experiments.
    pub fn paper() -> Self {
        Self {
            rule: ReplanRule::Paper,
            period_s: 3.0,
            threat_distance: 0.0,
        }
    }
}

parameters::choice! {
    /// Control law that follows a path.
    pub enum Follower {
        /// Pure pursuit.
        #[default]
        PurePursuit,
        /// The chasing-game paper's: its potential field from one point of the path to the next, and
        /// feedback linearisation.
        PotentialField,
    }
}

impl Follower {
    /// Returns the potential field of the follower of that name, and of the flight while there is
    /// no path.
    pub fn field(self) -> EvaderParams {
        match self {
            Self::PurePursuit => EvaderParams::default(),
            Self::PotentialField => EvaderParams::paper(),
        }
    }
}

parameters::table! {
    /// Parameters of an [`RrtStarEvader`](crate::RrtStarEvader).
    #[derive(Copy)]
    pub struct RrtStarParams {
        /// The motion primitive.
        pub primitive: Primitive,
        /// Parameters of arcs.
        pub arc: ArcParams,
        /// The tree.
        pub search: SearchParams,
        /// The cost of paths.
        pub cost: CostParams,
        /// Distance kept from walls beyond the robot's own radius: room for the follower.
        pub margin: f64 [at_least(0).unit("m")] = 0.03,
        /// Planning time.
        pub timing: TimingParams,
        /// The times of plans.
        pub replan: ReplanParams,
        /// Control law that follows paths.
        pub follower: Follower,
    }
}

impl Parameters for RrtStarParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.search.check_relations().map_err(within("search"))
    }
}

impl RrtStarParams {
    /// Returns the values of the chasing-game paper's experiments: no rewiring, one candidate for a
    /// parent, the pursuers at their current positions, no planning time. The robot's radius is
    /// still its true one.
    pub fn paper() -> Self {
        Self {
            search: SearchParams::paper(),
            cost: CostParams::paper(),
            margin: 0.0,
            timing: TimingParams {
                time_per_iteration_s: 0.0,
            },
            replan: ReplanParams::paper(),
            follower: Follower::PotentialField,
            ..Self::default()
        }
    }

    /// Returns the paper's parameters with its first planner's motion primitive, circular arcs.
    pub fn paper_arc() -> Self {
        Self {
            primitive: Primitive::Arc,
            search: SearchParams {
                iterations: 5000,
                max_edge: 1.5,
                ..SearchParams::paper()
            },
            cost: CostParams::length(),
            ..Self::paper()
        }
    }
}

#[cfg(test)]
mod tests;
