//! Interface of a steering algorithm, and its inputs of a robot.

use core::fmt;
use parameters::Parameters;

use geometry::map::MapSpec;
use geometry::region::Region;
use ipc_types::bus::Bus;
use ipc_types::messages::robot::TreeEdge;
use planner_view::event::RobotEvent;
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use planner_view::waypoint::WaypointReport;
use rand::Rng as _;
use robot::spec::RobotSpec;
use runtime::config::{ProcessConfig, RobotInfo};
use runtime::declaration::Declaration;
use runtime::error::ProcessError;
use runtime::kind::{Remark, Task, TaskFault, TaskSketch};

use crate::error::PlannerError;
use crate::outputs::{PlannedPoint, headed_for};

/// Steering algorithm for one robot. [`PlannerProcess`](crate::PlannerProcess) makes it a kind of
/// process.
///
/// ```
/// use planner::{Planner, PlannerError, PlannerProcess};
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
///     fn new((): &(), robot: &RobotInfo, _seed: u64) -> Result<Self, PlannerError> {
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
    /// Name of its kind, which scenarios use (`kind = "…"`).
    const NAME: &'static str;

    /// One-line description.
    const SUMMARY: &'static str;

    /// Parameters. All of them have defaults.
    type Params: Parameters + Default + Clone + PartialEq + fmt::Debug + Send + Sync;

    /// Names of the parameters that are the path of a file in a scenario and its contents in a process
    /// ([`runtime::files`]).
    const FILES: &'static [&'static str] = &[];

    /// Sets of parameters for `params.preset`; keys beside it change single values.
    fn presets() -> Vec<(&'static str, Self::Params)> {
        Vec::new()
    }

    /// Returns what it reads beside the state and the map, and writes beside commands and plans. A planner is given
    /// [`Input::SHAPES`](runtime::declaration::Input::SHAPES),
    /// [`SCANS`](runtime::declaration::Input::SCANS) and
    /// [`BELIEFS`](runtime::declaration::Input::BELIEFS) in its map and view; [`Planner::open`] opens other
    /// inputs.
    fn declare(params: &Self::Params) -> Declaration {
        let _ = params;
        Declaration::default()
    }

    /// Returns the geometry of its task with a robot on this map.
    fn sketch(params: &Self::Params, robot: &RobotSpec, map: &MapSpec) -> TaskSketch {
        let _ = (params, robot, map);
        TaskSketch::default()
    }

    /// Checks that a robot can do its task on this map; `seed` is the planner's own.
    ///
    /// # Errors
    /// [`TaskFault`] names the parameter or obstacle.
    fn check_task(params: &Self::Params, task: &Task<'_>, seed: u64) -> Result<(), TaskFault> {
        let _ = (params, task, seed);
        Ok(())
    }

    /// Returns what a user should know about a task that [`Self::check_task`] accepts.
    fn remarks(params: &Self::Params, task: &Task<'_>, seed: u64) -> Vec<Remark> {
        let _ = (params, task, seed);
        Vec::new()
    }

    /// Returns a planner for a robot; `seed` is its own.
    ///
    /// # Errors
    /// [`PlannerError`] names the invalid parameter, or the robot.
    fn new(params: &Self::Params, robot: &RobotInfo, seed: u64) -> Result<Self, PlannerError>;

    /// Sets the rules: exits of evaders, and the capture distance of pursuers (m) (0 without
    /// capture). Called once, before all other calls.
    fn rules(&mut self, exits: &[Region], capture_radius: f64) {
        let _ = (exits, capture_radius);
    }

    /// Opens the ports of further inputs and outputs, for the robot with this index.
    /// Called once, after [`Planner::rules`].
    ///
    /// # Errors
    /// Ends the process before it is ready.
    fn open(&mut self, config: &ProcessConfig, bus: &Bus, robot: u32) -> Result<(), ProcessError> {
        let _ = (config, bus, robot);
        Ok(())
    }

    /// Returns the error that prevents it from continuing, if any. It is checked after every
    /// steering call and ends the process.
    fn failure(&mut self) -> Option<ProcessError> {
        None
    }

    /// Prepares data of a new map before the next tick. Optional.
    fn prepare(&mut self, map: &PlannerMap, robot: &RobotInfo) {
        let _ = (map, robot);
    }

    /// Returns the robot's command in this tick.
    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering;

    /// Writes the plan behind the steering of this tick into `out`, the nearest point first; `out`
    /// is empty. By default: the point headed for and the final one.
    fn plan(&self, steering: &Steering, out: &mut Vec<PlannedPoint>) {
        headed_for(steering, out);
    }

    /// Returns the search tree behind the plan, each tree once; `None` while there is no new one.
    /// Edges beyond the declared number of `robot/tree` are not sent.
    fn tree(&mut self) -> Option<&[TreeEdge]> {
        None
    }

    /// Returns the waypoints that ended in this tick. Those beyond the declared number of
    /// `robot/waypoint` are not sent.
    fn waypoints(&mut self) -> &[WaypointReport] {
        &[]
    }

    /// Returns what has happened to the robot in this tick. Events beyond the declared number of `robot/event` are not sent.
    fn events(&mut self) -> &[RobotEvent] {
        &[]
    }
}

/// Kinds whose seeds come from their former names, so that their runs stay the same.
const SEED_NAMES: [(&str, &str); 1] = [("coverage_keyed", "keyed_coverage")];

/// Returns the seed of the planner of a robot in a run.
pub fn planner_seed(run_seed: u64, kind: &str, robot: &str) -> u64 {
    let name = SEED_NAMES.iter().find(|(present, _)| *present == kind);
    let name = name.map_or(kind, |(_, former)| former);
    runtime::seed::stream(run_seed, name, robot, "planner").next_u64()
}

/// Returns the limits of a robot in the form of its planner.
///
/// # Errors
/// [`PlannerError::Robot`] names the invalid limit.
pub fn limits(robot: &RobotInfo) -> Result<Limits, PlannerError> {
    let model = &robot.model;
    Limits::new(model.v_max, model.v_reverse_max, model.omega_max)
        .map_err(|e| PlannerError::of_robot(&robot.name, e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_renamed_kind_keeps_its_seed() {
        let seed = |kind| planner_seed(7, kind, "sweeper");
        assert_eq!(seed("coverage_keyed"), seed("keyed_coverage"));
        assert_ne!(seed("coverage_keyed"), seed("coverage_uniform"));
    }
}
