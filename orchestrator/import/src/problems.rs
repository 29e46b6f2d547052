//! Robots with the starts and goals of problems.

use std::collections::BTreeSet;
use std::path::Path;

use scenario::Loader;
use scenario::files::Base;

use super::chase::{blur, robot};
use super::check::first_valid;
use super::vectors::World;
use super::{ImportError, Imported, movingai, read};

/// Maximum number of robots.
const MAX_ROBOTS: usize = 4;

/// Makes robots with the starts and goals of the first problems of a file that do not share a cell, on its map with cells of
/// this side (m).
///
/// # Errors
/// The file or its map is invalid, or the map lies outside the base; problems of another map, or none on its connected free
/// cells.
pub fn scenario(
    path: &Path,
    base: &Base,
    cell: f64,
    loader: &Loader<'_>,
) -> Result<Imported, ImportError> {
    let problems = movingai::problems(path, &read::text(path)?)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let map = movingai::map_beside(folder, &problems.map);
    let text = base.read_text(map, read::MAX_TEXT);
    let text = text.map_err(|refused| ImportError::other(path, map, refused))?;
    let map = folder.join(map);
    let world = World::of_cells(&map, movingai::map(&map, &text)?, cell)?;
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
    let (stem, map) = (read::stem(path), read::stem(&map));
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
        blur = blur(&world),
    );
    let imported = Imported {
        scenario,
        map: world.toml(&map),
        map_path,
    };
    let last = "one of the first problems".to_owned();
    first_valid(path, &world, [imported], last, loader)
}
