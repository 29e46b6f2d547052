//! The interface of a steering algorithm, and what a robot gives it.

use core::fmt;
use parameters::Parameters;

use geometry::region::Region;
use ipc_types::bus::Bus;
use ipc_types::messages::robot::TreeEdge;
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use planner_view::waypoint::WaypointReport;
use rand::Rng as _;
use runtime::config::{ProcessConfig, RobotInfo};
use runtime::error::ProcessError;
use runtime::kind::{Need, Task, TaskFault};

use crate::outputs::{PlannedPoint, headed_for};

/// Which topics beside state and map a planner reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PlannerInputs {
    /// Beliefs about the opponents.
    pub beliefs: bool,
    /// Range scans of its robots.
    pub scans: bool,
    /// The exact pieces of the map ([`PlannerMap::space`]).
    pub shapes: bool,
}

/// A steering algorithm for one robot. With [`PlannerProcess`](crate::PlannerProcess) around it, it
/// is a kind of process.
///
/// ```
/// use planner::{Planner, PlannerInputs, PlannerProcess};
/// use planner_view::map::PlannerMap;
/// use planner_view::steering::Steering;
/// use planner_view::view::View;
/// use runtime::ProcessKind;
/// use runtime::config::RobotInfo;
/// use geometry::pose::Twist2;
///
/// /// Drives ahead at half of its robot's speed.
/// struct Ahead(f64);
///
/// impl Planner for Ahead {
///     const NAME: &'static str = "ahead";
///     const SUMMARY: &'static str = "drives ahead";
///     type Params = ();
///
///     fn inputs((): &()) -> PlannerInputs {
///         PlannerInputs::default()
///     }
///
///     fn new((): &(), robot: &RobotInfo, _seed: u64) -> Result<Self, String> {
///         Ok(Self(0.5 * robot.model.v_max))
///     }
///
///     fn steer(&mut self, _: &PlannerMap, _: &View<'_>) -> Steering {
///         Steering {
///             command: Twist2::new(self.0, 0.0),
///             ..Steering::stop()
///         }
///     }
/// }
///
/// assert_eq!(<PlannerProcess<Ahead> as ProcessKind>::NAME, "ahead");
/// ```
pub trait Planner: Sized + 'static {
    /// The name of its kind, which scenarios use (`kind = "…"`).
    const NAME: &'static str;

    /// What it does, in one line.
    const SUMMARY: &'static str;

    /// Its parameters. All of them have defaults.
    type Params: Parameters + Default + Clone + PartialEq + fmt::Debug + Send + Sync;

    /// Most edges of a tree that it publishes; 0 for a planner without trees.
    const TREE_EDGES: usize = 0;

    /// Most waypoints that may end in one tick; 0 for a planner without waypoints.
    const WAYPOINTS: usize = 0;

    /// Sets of parameters that `params.preset` names; keys beside it change single values.
    fn presets() -> Vec<(&'static str, Self::Params)> {
        Vec::new()
    }

    /// Which topics it reads, given its parameters.
    fn inputs(params: &Self::Params) -> PlannerInputs;

    /// What another part of the scenario must provide: by default the beliefs and scans that are
    /// among its inputs.
    fn needs(params: &Self::Params) -> Vec<Need> {
        let inputs = Self::inputs(params);
        let needs = [
            inputs.beliefs.then_some(Need::Belief),
            inputs.scans.then_some(Need::Scan),
        ];
        needs.into_iter().flatten().collect()
    }

    /// Checks whether a robot can do what it is told on this map; `seed` is the planner's own.
    ///
    /// # Errors
    /// What does not fit.
    fn check_task(params: &Self::Params, task: &Task<'_>, seed: u64) -> Result<(), TaskFault> {
        let _ = (params, task, seed);
        Ok(())
    }

    /// A planner for a robot; `seed` is its own.
    ///
    /// # Errors
    /// A text that names the parameter that does not do.
    fn new(params: &Self::Params, robot: &RobotInfo, seed: u64) -> Result<Self, String>;

    /// Takes note of the rules: where evaders get away, and the distance below which Police catch
    /// them (m) (0 if they do not). Called once, before everything else.
    fn rules(&mut self, exits: &[Region], capture_radius: f64) {
        let _ = (exits, capture_radius);
    }

    /// Opens what it needs of the bus besides the topics of [`PlannerInputs`], for the robot with
    /// this index. Called once, after [`Planner::rules`].
    ///
    /// # Errors
    /// Ends the process before it is ready.
    fn open(&mut self, config: &ProcessConfig, bus: &Bus, robot: u32) -> Result<(), ProcessError> {
        let _ = (config, bus, robot);
        Ok(())
    }

    /// Why it cannot go on, if it cannot; asked after every steering. Ends the process.
    fn failure(&mut self) -> Option<ProcessError> {
        None
    }

    /// Builds what it needs of a new map, if it wants to do that before the next tick.
    fn prepare(&mut self, map: &PlannerMap, robot: &RobotInfo) {
        let _ = (map, robot);
    }

    /// What the robot does in this tick.
    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering;

    /// Writes the plan behind the steering of this tick into `out`, the nearest point first; `out`
    /// is empty. By default the point headed for and the one to reach in the end.
    fn plan(&self, steering: &Steering, out: &mut Vec<PlannedPoint>) {
        headed_for(steering, out);
    }

    /// The search tree behind the plan, each tree once: `None` while there is no new one. Edges
    /// beyond [`Self::TREE_EDGES`] are not sent.
    fn tree(&mut self) -> Option<&[TreeEdge]> {
        None
    }

    /// The waypoints that ended in this tick. Those beyond [`Self::WAYPOINTS`] are not sent.
    fn waypoints(&mut self) -> &[WaypointReport] {
        &[]
    }
}

/// The seed that the planner of a robot gets in a run.
pub fn planner_seed(run_seed: u64, kind: &str, robot: &str) -> u64 {
    runtime::seed::stream(run_seed, kind, robot, "planner").next_u64()
}

/// The limits of a robot as its planner sees them.
///
/// # Errors
/// A text that names the limit that does not do.
pub fn limits(robot: &RobotInfo) -> Result<Limits, String> {
    let model = &robot.model;
    Limits::new(model.v_max, model.v_reverse_max, model.omega_max)
        .map_err(|e| format!("{}: {e}", robot.name))
}
