//! Paths of several classes, arrival times and dominance regions.

use std::sync::Arc;

use ::navigation::dominance::{Arena, Cell, Dominance, DominanceParams, Runner};
use ::navigation::shortest_paths::{corners, free_end};
use ::navigation::tangent_graph::k_shortest_classes;
use ::navigation::wavefront::{Lattice, Medium, SIGHT, Source, Wave};
use numpy::{IntoPyArray as _, PyArray2, PyArrayMethods as _};
use planner_view::map::PlannerMap;
use pyo3::prelude::*;

use crate::arguments::{self, invalid, refused, scalar};
use crate::interruptible::compute;
use crate::map::Map;

/// Maximum number of classes of paths.
const MAX_CLASSES: usize = 1000;

/// Shortest paths of a disc, one for each way past the obstacles.
///
/// The shortest path of each of the shortest homotopy classes, in order of length.
///
/// Parameters
/// ----------
/// map
///     The map.
/// start
///     A point (m), shape (2,), or a robot.
/// goal
///     A point (m), shape (2,), or a robot.
/// radius
///     Radius of the disc (m).
/// count
///     Number of classes.
/// max_length
///     Maximum length of a path (m); unlimited if absent.
///
/// Returns
/// -------
/// list of ndarray
///     Corners of each path (m), shape (n, 2), as those of `Map.path`; fewer than `count` if there are fewer.
///
/// Raises
/// ------
/// InvalidInput
///     An argument is out of range, or the map has too many corners.
///
/// Examples
/// --------
/// >>> import numpy as np, protean_robotics as pr
/// >>> blocked = np.zeros((40, 40), dtype=bool)
/// >>> blocked[15:25, 15:25] = True
/// >>> map = pr.Map.from_grid(blocked, 0.1)
/// >>> above, below = pr.navigation.shortest_paths(map, (0.5, 2.1), (3.5, 2.1), radius=0.1, count=2)
/// >>> bool(above[2, 1] > 2.5 > 1.5 > below[2, 1])
/// True
#[pyfunction]
#[pyo3(signature = (map, start, goal, radius, *, count=3, max_length=None))]
pub fn shortest_paths<'py>(
    py: Python<'py>,
    map: &Map,
    start: &Bound<'py, PyAny>,
    goal: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = scalar)] radius: f64,
    #[pyo3(from_py_with = scalar)] count: usize,
    #[pyo3(from_py_with = scalar)] max_length: Option<f64>,
) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
    let start = arguments::point("start", start)?;
    let goal = arguments::point("goal", goal)?;
    arguments::positive("radius", radius)?;
    if count > MAX_CLASSES {
        let expected = format!("at most {MAX_CLASSES}");
        return Err(refused("count", &count, &expected));
    }
    let max_length = max_length.unwrap_or(f64::INFINITY);
    if max_length.is_nan() {
        return Err(refused("max_length", &max_length, "a number (m)"));
    }
    let Some(space) = map.map.space() else {
        return Err(refused("map", "grids alone", "a map with its exact pieces"));
    };
    let space = Arc::clone(space);
    let paths = compute(py, move || {
        let free = |p| free_end(&space, radius, p);
        match (free(start), free(goal)) {
            (Some(start), Some(goal)) => {
                k_shortest_classes(&space, radius, start, goal, count, max_length)
            }
            _ => Ok(Vec::new()),
        }
    });
    let paths = paths?.map_err(invalid)?;
    paths
        .iter()
        .map(|path| arguments::array_of_points(py, &corners(path)))
        .collect()
}

/// Times at which the first of some robots can be at each place.
///
/// Fast marching with second-order upwind differences (Sethian 1996; 1999, section 8.3), exact near the robots and
/// around corners; within 2 % of the exact shortest path. Turning takes no time.
///
/// Parameters
/// ----------
/// map
///     The map.
/// starts
///     Positions of the robots (m), shape (2,) or (n, 2), or a robot.
/// speeds
///     Their speeds (m/s), a number or shape (n,).
/// radius
///     Radius of their bodies (m).
/// pitch
///     Side of a place (m), rounded to whole cells of the map; a cell if absent.
///
/// Returns
/// -------
/// ndarray
///     Times (s), float32 of shape (rows, columns), rows along +y; infinity where no robot comes. Place (0, 0) begins at
///     the origin of the map.
///
/// Raises
/// ------
/// InvalidInput
///     An argument is out of range.
///
/// Examples
/// --------
/// >>> import numpy as np, protean_robotics as pr
/// >>> map = pr.Map.from_grid(np.zeros((20, 40), dtype=bool), 0.1)
/// >>> times = pr.navigation.arrival_times(map, (0.55, 0.95), 0.5, radius=0.2)
/// >>> times.shape, round(float(times[9, 25]), 2)
/// ((20, 40), 4.0)
#[pyfunction]
#[pyo3(signature = (map, starts, speeds, radius, *, pitch=None))]
pub fn arrival_times<'py>(
    py: Python<'py>,
    map: &Map,
    starts: &Bound<'py, PyAny>,
    speeds: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = scalar)] radius: f64,
    #[pyo3(from_py_with = scalar)] pitch: Option<f64>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let pitch = checked_pitch(&map.map, radius, pitch)?;
    let starts = arguments::goals("starts", starts)?;
    let speeds = speeds_of("speeds", speeds, starts.len())?;
    let sources: Vec<Source> = (0..)
        .zip(starts.iter().zip(speeds))
        .map(|(label, (&at, speed))| Source::new(at, speed, label))
        .collect();
    let map = Arc::clone(&map.map);
    let (times, [height, width]) = compute(py, move || {
        let medium = medium(&map, pitch, radius);
        let mut wave = Wave::default();
        wave.spread(&medium, &map, &sources, None);
        let lattice = medium.lattice();
        let time = |cell| {
            let node = lattice.node_of_cell(cell);
            node.map_or(f32::INFINITY, |node| wave.time(node))
        };
        let times: Vec<f32> = (0..lattice.frame().len()).map(time).collect();
        (times, [lattice.frame().height, lattice.frame().width])
    })?;
    times.into_pyarray(py).reshape([height, width])
}

/// Places that evaders reach before any pursuer can stop them.
///
/// An evader safely reaches a place if there is a path to it on which it is, everywhere, before any pursuer could have
/// come within the capture radius (Zhou, Ding, Huang, Takei and Tomlin, *Efficient path planning algorithms in
/// reach-avoid problems*, Automatica 2018, section 4).
///
/// Parameters
/// ----------
/// map
///     The map.
/// evaders, pursuers
///     Positions (m), shape (2,) or (n, 2), or a robot.
/// evader_speeds, pursuer_speeds
///     Speeds (m/s), a number or shape (n,).
/// radius
///     Radius of the bodies (m).
/// capture_radius
///     Distance at which a pursuer stops an evader (m).
/// pitch
///     Side of a place (m), rounded to whole cells of the map; 0.2 m if absent.
///
/// Returns
/// -------
/// ndarray
///     Owner of each place, uint8 of shape (rows, columns), rows along +y: 0 neither, 1 pursuers, 2 evaders, 3 cut off
///     (an evader would be first, but pursuers can cut off every path there).
///
/// Raises
/// ------
/// InvalidInput
///     An argument is out of range.
///
/// Examples
/// --------
/// >>> import numpy as np, protean_robotics as pr
/// >>> map = pr.Map.from_grid(np.zeros((20, 40), dtype=bool), 0.1)
/// >>> owner = pr.navigation.dominance(map, (1, 1), 0.5, (3, 1), 0.5, radius=0.1)
/// >>> bool(owner[5, 1] == 2), bool(owner[5, 18] == 1)
/// (True, True)
#[pyfunction]
#[pyo3(signature = (map, evaders, evader_speeds, pursuers, pursuer_speeds, *, radius, capture_radius=0.0, pitch=None))]
#[expect(clippy::too_many_arguments, reason = "two teams")]
pub fn dominance<'py>(
    py: Python<'py>,
    map: &Map,
    evaders: &Bound<'py, PyAny>,
    evader_speeds: &Bound<'py, PyAny>,
    pursuers: &Bound<'py, PyAny>,
    pursuer_speeds: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = scalar)] radius: f64,
    #[pyo3(from_py_with = scalar)] capture_radius: f64,
    #[pyo3(from_py_with = scalar)] pitch: Option<f64>,
) -> PyResult<Bound<'py, PyArray2<u8>>> {
    let pitch = checked_pitch(
        &map.map,
        radius,
        pitch.or(Some(DominanceParams::default().pitch)),
    )?;
    arguments::not_negative("capture_radius", capture_radius)?;
    let team = |names: [&str; 2], at: &Bound<'_, PyAny>, speeds: &Bound<'_, PyAny>, reach| {
        let at = arguments::robots(names[0], at)?;
        let speeds = speeds_of(names[1], speeds, at.len())?;
        let runners = at.into_iter().zip(speeds);
        PyResult::Ok(
            runners
                .map(|(at, speed)| Runner { at, speed, reach })
                .collect::<Vec<_>>(),
        )
    };
    let evaders = team(["evaders", "evader_speeds"], evaders, evader_speeds, 0.0)?;
    let names = ["pursuers", "pursuer_speeds"];
    let pursuers = team(names, pursuers, pursuer_speeds, capture_radius)?;
    let map = Arc::clone(&map.map);
    let (owners, [height, width]) = compute(py, move || {
        let map = &*map;
        let key = [pitch, radius, capture_radius];
        let arena = map.derived().get(key, || {
            Arena::new(map, &DominanceParams { pitch }, radius, &[], capture_radius)
        });
        let mut dominance = Dominance::default();
        dominance.assess(map, &arena, &pursuers, &evaders);
        let mut cells: Vec<Cell> = Vec::new();
        dominance.cells(map, &arena, &evaders, &mut cells);
        let frame = arena.lattice().frame();
        let owners: Vec<u8> = cells.iter().map(|cell| cell.owner.code()).collect();
        (owners, [frame.height, frame.width])
    })?;
    owners.into_pyarray(py).reshape([height, width])
}

/// The pitch of places (m).
fn checked_pitch(map: &PlannerMap, radius: f64, pitch: Option<f64>) -> PyResult<f64> {
    arguments::not_negative("radius", radius)?;
    let pitch = pitch.unwrap_or(map.clearance_grid().frame.resolution);
    arguments::positive("pitch", pitch)?;
    Ok(pitch)
}

fn speeds_of(name: &str, speeds: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<f64>> {
    let speeds = match speeds.extract::<f64>() {
        Ok(speed) => vec![speed; count],
        Err(_) => arguments::per_row(name, Some(speeds), count, 0.0)?,
    };
    for &speed in &speeds {
        arguments::not_negative(name, speed)?;
    }
    Ok(speeds)
}

fn medium(map: &PlannerMap, pitch: f64, radius: f64) -> Arc<Medium> {
    map.derived().get([pitch, radius], || {
        Medium::new(map, Lattice::new(map, pitch, radius), SIGHT)
    })
}
