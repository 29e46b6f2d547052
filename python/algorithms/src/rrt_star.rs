//! Paths by RRT*.

use core::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use evader_rrt_star::RrtStarParams;
use evader_rrt_star::collision_map::CollisionMap;
use evader_rrt_star::cost::{CostModel, Pursuer};
use evader_rrt_star::params::MAX_ITERATIONS;
use evader_rrt_star::planning::{self, Task};
use evader_rrt_star::tree::{NONE, Node};
use geometry::pose::Pose2;
use navigation::shortest_paths::free_end;
use numpy::{PyArray1, PyArray2};
use planner_view::limits::Limits;
use pyo3::prelude::*;

use crate::arguments::{self, invalid, refused, scalar};
use crate::interruptible::compute;
use crate::map::Map;

/// Turning rate (rad/s) of a robot for which none is given: arcs of at least the speed over it.
const OMEGA_MAX: f64 = FRAC_PI_2;

/// Result of a search: its best path and its tree.
#[pyclass(
    frozen,
    get_all,
    new = "from_fields",
    module = "protean_robotics.rrt_star"
)]
#[derive(Debug)]
pub struct Tree {
    /// Points of the best path (m), shape (n, 2), to a goal or, if `reached` is false, as near to one as possible; shape
    /// (0, 2) without a step.
    path: Py<PyArray2<f64>>,
    /// True if the path ends at a goal.
    reached: bool,
    /// Cost of the path (m): its length, and more near pursuers; infinity without a path.
    cost: f64,
    /// Positions of the nodes that are joined to the start, which is the first (m), shape (nodes, 2).
    nodes: Py<PyArray2<f64>>,
    /// Index of the parent of each node; −1 for the start; shape (nodes,).
    parents: Py<PyArray1<i64>>,
    /// Cost from the start to each node (m), shape (nodes,).
    costs: Py<PyArray1<f64>>,
}

/// Path between two places by RRT*: a tree that is rewired as it grows.
///
/// Karaman and Frazzoli (2011), with parents among ancestors (Quick-RRT*, Jeong et al. 2019), samples only where they can
/// shorten the path (Informed RRT*, Gammell et al. 2014) and refinement of the best path's points. The planner of the
/// chasing-game paper (section III.G) with ``params={"search": {"algorithm": "published"}}``.
///
/// Parameters
/// ----------
/// map
///     The map.
/// start
///     A point (m), shape (2,), a pose with a heading (rad), shape (3,), or a robot.
/// goals
///     Goals (m), shape (2,) or (k, 2), or a robot; the cheapest counts.
/// radius
///     Radius of the robot (m), margin included.
/// iterations
///     Number of iterations.
/// seed
///     Seed of the random numbers; the same seed and arguments give the same tree.
/// pursuers
///     Positions of pursuers (m), shape (2,) or (k, 2), or a robot: paths near them cost more.
/// pursuer_speed
///     Their speed (m/s).
/// v_max
///     Speed of the robot (m/s).
/// omega_max
///     Its turning rate (rad/s), which limits arcs.
/// params
///     Other values than the defaults of ``primitive`` ("line" or "arc"), ``arc``, ``search`` and ``cost`` of the planner
///     `evader_rrt_star`.
///
/// Returns
/// -------
/// Tree
///     The best path and the tree.
///
/// Raises
/// ------
/// InvalidInput
///     An argument is out of range, or start or goal is more than 0.3 m from a free place.
///
/// Examples
/// --------
/// >>> import numpy as np, protean_robotics as pr
/// >>> blocked = np.zeros((40, 40), dtype=bool)
/// >>> blocked[15:25, 15:25] = True
/// >>> map = pr.Map.from_grid(blocked, 0.1)
/// >>> tree = pr.rrt_star.plan(map, (0.5, 2.0), (3.5, 2.0), 0.1, iterations=500, seed=1)
/// >>> shortest = map.path_length((0.5, 2.0), (3.5, 2.0), 0.1)
/// >>> tree.reached, bool(shortest <= tree.cost < 1.05 * shortest)
/// (True, True)
#[pyfunction]
#[pyo3(signature = (map, start, goals, radius, *, iterations=1500, seed=0, pursuers=None, pursuer_speed=1.0, v_max=1.0, omega_max=OMEGA_MAX, params=None))]
#[expect(clippy::too_many_arguments, reason = "keywords")]
pub fn plan(
    py: Python<'_>,
    map: &Map,
    start: &Bound<'_, PyAny>,
    goals: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = scalar)] radius: f64,
    #[pyo3(from_py_with = scalar)] iterations: u32,
    #[pyo3(from_py_with = scalar)] seed: u64,
    pursuers: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = scalar)] pursuer_speed: f64,
    #[pyo3(from_py_with = scalar)] v_max: f64,
    #[pyo3(from_py_with = scalar)] omega_max: f64,
    params: Option<&Bound<'_, PyAny>>,
) -> PyResult<Tree> {
    let params: RrtStarParams = arguments::params(params)?;
    let limits = Limits::new(v_max, 0.0, omega_max).map_err(invalid)?;
    arguments::positive("radius", radius)?;
    arguments::not_negative("pursuer_speed", pursuer_speed)?;
    if iterations > MAX_ITERATIONS {
        let expected = format!("at most {MAX_ITERATIONS}");
        return Err(refused("iterations", &iterations, &expected));
    }
    let from = arguments::pose("start", start)
        .or_else(|_| arguments::point("start", start).map(|p| Pose2::new(p.x, p.y, 0.0)))?;
    let goals = arguments::goals("goals", goals)?;
    let pursuers = match pursuers {
        Some(pursuers) => arguments::robots("pursuers", pursuers)?,
        None => Vec::new(),
    };
    let Some(space) = map.map.space() else {
        return Err(refused("map", "grids alone", "a map with its exact pieces"));
    };
    let free = |p| free_end(space, radius, p);
    let place = free(from.position());
    let ends: Option<Vec<_>> = goals.into_iter().map(free).collect();
    let (Some(place), Some(goals)) = (place, ends.filter(|ends| !ends.is_empty())) else {
        let expected = "a start and goals within 0.3 m of a free place for the radius";
        return Err(refused("radius", &radius, expected));
    };
    let from = Pose2::new(place.x, place.y, from.theta);
    let mut cost = CostModel::new(params.cost, params.search.algorithm, v_max);
    cost.set_pursuers(pursuers.into_iter().map(|at| Pursuer {
        at,
        v_max: pursuer_speed,
    }));
    let (space, revision) = (Arc::clone(space), map.map.revision());
    let (route, nodes) = compute(py, move || {
        let mut collision_map = CollisionMap::new(&space, radius, revision);
        let towards = collision_map.towards(&goals);
        let mut planning = planning::for_robot(&params, &limits, seed);
        let route = planning.plan(&Task {
            collision_map: &collision_map,
            bodies: &[],
            cost: &cost,
            start: from,
            goals: &goals,
            towards: &towards,
            map_changed: true,
            iterations,
        });
        (route, joined(planning.tree().nodes()))
    })?;
    let path = route.as_ref().map_or(&[][..], |route| route.path.points());
    Ok(Tree {
        path: arguments::array_of_points(py, path)?.unbind(),
        reached: route.as_ref().is_some_and(|route| route.is_complete),
        cost: route.as_ref().map_or(f64::INFINITY, |route| route.cost),
        nodes: arguments::array_of_rows(py, nodes.iter().map(|(p, ..)| *p))?.unbind(),
        parents: PyArray1::from_vec(py, nodes.iter().map(|n| n.1).collect()).unbind(),
        costs: PyArray1::from_vec(py, nodes.iter().map(|n| n.2).collect()).unbind(),
    })
}

/// The nodes that are joined to the root: position (m), index of the parent among them, cost (m).
fn joined(nodes: &[Node]) -> Vec<([f64; 2], i64, f64)> {
    let mut numbers = vec![-1; nodes.len()];
    let is_joined = |node: &Node| node.cost.is_finite();
    for (new, (number, _)) in
        (0_i64..).zip(numbers.iter_mut().zip(nodes).filter(|n| is_joined(n.1)))
    {
        *number = new;
    }
    let parent = |node: &Node| match node.parent {
        NONE => -1,
        parent => numbers.get(parent as usize).copied().unwrap_or(-1),
    };
    let joined = nodes.iter().filter(|node| is_joined(node));
    joined
        .map(|node| ([node.pose.x, node.pose.y], parent(node), node.cost))
        .collect()
}
