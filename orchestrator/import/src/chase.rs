//! A chase on an imported world.

use std::path::Path;

use scenario::Loader;

use super::check::first_valid;
use super::vectors::World;
use super::{ImportError, Imported, read};

/// Radius of a robot, in lengths of the world: a cell, or half the width of a street.
const RADIUS: f64 = 0.3;
/// Distance between a Police robot and an evader at their starts, in lengths: none is captured at once.
const MIN_DISTANCE: f64 = 1.5;

/// Makes a chase from random starts, whose sizes follow from a length of the world (m): four Police robots and two
/// evaders, or fewer that are nearer to each other where space is short.
///
/// # Errors
/// The smallest chase does not pass the check.
pub fn scenario(
    path: &Path,
    world: &World,
    length: f64,
    loader: &Loader<'_>,
) -> Result<Imported, ImportError> {
    let [min, max] = world.corners();
    let near = MIN_DISTANCE * length;
    let far = (10.0 * length).min(0.25 * (max - min).min()).max(near);
    let stem = read::stem(path);
    let sizes = [(4, 2, far), (4, 2, near), (2, 1, near), (1, 1, near)];
    let chases = sizes.into_iter().map(|(police, evaders, distance)| {
        chase(&stem, world, length, [police, evaders], distance)
    });
    let radius = RADIUS * length;
    let last =
        format!("one Police robot and one evader of radius {radius:.3} m, {near:.3} m apart");
    first_valid(path, world, chases, last, loader)
}

fn chase(
    stem: &str,
    world: &World,
    length: f64,
    [police, evaders]: [usize; 2],
    distance: f64,
) -> Imported {
    let robot = robot(length);
    let (speed, faster) = (length, 1.1 * length);
    let (near, reach) = (length, length);
    let map_path = format!("maps/{stem}.toml");
    let exit = world.place_in_corner(RADIUS * length);
    let exits = exit.map_or_else(String::new, |at| {
        format!(
            "exits = [{{ circle = {{ center = [{:?}, {:?}], radius = {reach:?} }} }}]  # [m]\n",
            at.x, at.y
        )
    });
    let scenario = format!(
        r#"# A chase on an imported map. `protean check --picture` draws it.

title = "Chase on {stem}"
description = """
Police that see along lines of sight chase evaders that run for the exit in the lower left corner, from random starts."""

[run]
dt = 0.05  # [s]
seed = 1   # another seed is another layout

[world]
map = "{map_path}"
blur_sigma = {blur:?}  # [m]

[rules]
capture = {{ radius = {reach:?} }}  # [m]
{exits}time_limit = 240.0  # [s]

{robot}
[defaults.robot.random_start]
robot_distance = {near:?}  # [m]
opponent_distance = {distance:?}  # [m]
exit_distance = {distance:?}  # of an evader [m]

[teams.police]
count = {police}
limits = {{ v_max = {speed:?} }}  # [m/s]

[teams.evader]
count = {evaders}
limits = {{ v_max = {faster:?} }}  # [m/s]

[[robots]]
name = "police"
team = "police"

[[robots]]
name = "evader"
team = "evader"

[[processes]]
kind = "perception"

[[processes]]
kind = "pursuer"
team = "police"

[[processes]]
kind = "evader_potential"
team = "evader"
"#,
        blur = blur(world),
    );
    Imported {
        scenario,
        map: world.toml(stem),
        map_path,
    }
}

/// The table of all robots.
pub fn robot(length: f64) -> String {
    format!(
        "[defaults.robot]\nradius = {:?}  # [m]\nlimits = {{ v_max = {length:?} }}  # [m/s]\n",
        RADIUS * length
    )
}

/// Returns the standard deviation of the blur of the map (m): a cell, at most the largest one allowed.
pub fn blur(world: &World) -> f64 {
    world.resolution.min(10.0)
}
