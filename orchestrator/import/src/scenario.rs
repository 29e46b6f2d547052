//! Texts of scenarios.

use std::collections::BTreeSet;
use std::path::Path;

use super::movingai::Problems;
use super::vectors::World;
use super::{ImportError, Imported};

/// Maximum number of robots of a scenario with problems.
const MAX_ROBOTS: usize = 4;
/// Radius of a robot, in lengths of the world: a cell, or half the width of a street.
const RADIUS: f64 = 0.3;

/// A chase from random starts, whose sizes follow from a length of the world (m).
pub fn chase(stem: &str, world: &World, length: f64) -> Imported {
    let robot = robot(length);
    let (speed, faster) = (length, 1.1 * length);
    let [min, max] = world.corners();
    let far = (10.0 * length).min(0.25 * (max - min).min());
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
opponent_distance = {far:?}  # [m]
exit_distance = {far:?}  # of an evader [m]

[teams.police]
count = 4
limits = {{ v_max = {speed:?} }}  # [m/s]

[teams.evader]
count = 2
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
        blur = world.resolution,
    );
    Imported {
        scenario,
        map: world.toml(stem),
        map_path,
    }
}

/// Robots with the starts and goals of the first problems that do not share a cell.
///
/// # Errors
/// Problems of another map, or none on its connected free cells.
pub fn problems(
    path: &Path,
    stem: &str,
    world: &World,
    cell: f64,
    problems: &Problems,
) -> Result<Imported, ImportError> {
    let frame = world.occupied.frame;
    if problems.size != [frame.width, frame.height] {
        let [width, height] = problems.size;
        return Err(ImportError::content(
            path,
            format!("problems on {width} × {height} cells"),
            format!("the {} × {} cells of the map", frame.width, frame.height),
        ));
    }
    // Rows of problems are counted from the top.
    let index = |[column, row]: [usize; 2]| frame.index(column, frame.height - 1 - row);
    let is_free = |at: &[usize; 2]| world.occupied.cells.get(index(*at)) == Some(&false);
    let mut taken = BTreeSet::new();
    let mut robots = String::new();
    let mut count = 0;
    for [start, goal] in &problems.tasks {
        let is_new = !taken.contains(&(0, *start)) && !taken.contains(&(1, *goal));
        if count == MAX_ROBOTS || start == goal || !is_free(start) || !is_free(goal) || !is_new {
            continue;
        }
        taken.extend([(0, *start), (1, *goal)]);
        count += 1;
        let at = |[column, row]: [usize; 2]| frame.center(column, frame.height - 1 - row);
        let (from, to) = (at(*start), at(*goal));
        robots.push_str(&format!(
            "[[robots]]\nname = \"robot_{count}\"\nteam = \"neutral\"\n\
             start = {{ x = {:?}, y = {:?}, theta = 0.0 }}  # cell {start:?} of the map's file\n\
             goal.circle = {{ center = [{:?}, {:?}], radius = {:?} }}  # cell {goal:?}\n\n",
            from.x,
            from.y,
            to.x,
            to.y,
            0.25 * cell
        ));
    }
    if count == 0 {
        return Err(ImportError::content(
            path,
            "no problem between different cells of the largest connected free part",
            "at least one",
        ));
    }
    let robot = robot(cell);
    let map = super::read::stem(Path::new(&problems.map));
    let map_path = format!("maps/{map}.toml");
    let scenario = format!(
        r#"# Robots with starts and goals of an imported file of problems. `protean check --picture` draws it.

title = "Problems of {stem}"
description = """
Each robot drives from the start to the goal of a problem in minimum time; they keep apart."""

[run]
dt = 0.05  # [s]
seed = 1

[world]
map = "{map_path}"
blur_sigma = {blur:?}  # [m]

[rules]
time_limit = 600.0  # [s]

{robot}
{robots}[[processes]]
kind = "optimiser"

[[processes]]
kind = "navigator"
team = "neutral"
"#,
        blur = world.resolution,
    );
    Ok(Imported {
        scenario,
        map: world.toml(&map),
        map_path,
    })
}

/// The table of all robots.
fn robot(length: f64) -> String {
    format!(
        "[defaults.robot]\nradius = {:?}  # [m]\nlimits = {{ v_max = {length:?} }}  # [m/s]\n",
        RADIUS * length
    )
}
