//! The benchmark files of MovingAI: octile maps and the problems on them.
//!
//! Format: N. Sturtevant, *Benchmarks for Grid-Based Pathfinding*, 2012, and movingai.com/benchmarks/formats.html.

use std::path::Path;

use geometry::grid::{Grid, GridFrame};
use nalgebra::Point2;

use super::ImportError;

/// Maximum number of cells.
const MAX_CELLS: usize = 25_000_000;

/// Reads a map (`.map`): passable are ground (`.`, `G`) and swamp (`S`); trees (`T`), water (`W`) and what is out of
/// bounds (`@`, `O`) are obstacles. The first row of the file is the one with the largest y. Cells have side 1.
pub fn map(path: &Path, text: &str) -> Result<Grid<bool>, ImportError> {
    let end = text.lines().count() + 1;
    let mut lines = (1..).zip(text.lines());
    let mut header = |key: &str, expected: &str| {
        let (line, found) = lines.next().unwrap_or((end, ""));
        let value = found.trim().strip_prefix(key).map(str::trim);
        value
            .map(|value| (line, value.to_owned()))
            .ok_or_else(|| ImportError::line(path, line, found, expected))
    };
    header("type", "type octile")?;
    let mut size = |key: &str| {
        let expected = format!("{key} and a number of cells > 0");
        let (line, value) = header(key, &expected)?;
        match value.parse::<usize>() {
            Ok(size) if size > 0 => Ok(size),
            _ => Err(ImportError::line(path, line, &value, &expected)),
        }
    };
    let (height, width) = (size("height")?, size("width")?);
    header("map", "map")?;
    if width.saturating_mul(height) > MAX_CELLS {
        let found = format!("{width} × {height} cells");
        return Err(ImportError::content(
            path,
            found,
            format!("at most {MAX_CELLS} cells"),
        ));
    }
    let mut rows: Vec<Vec<bool>> = Vec::new();
    for (line, row) in lines.by_ref().take(height) {
        let cells: Option<Vec<bool>> = row.trim_end().chars().map(is_occupied).collect();
        let expected = format!("{width} of the characters . G S T W @ O");
        rows.push(
            cells
                .filter(|cells| cells.len() == width)
                .ok_or_else(|| ImportError::line(path, line, row, &expected))?,
        );
    }
    if rows.len() != height {
        let found = format!("{} rows of cells", rows.len());
        return Err(ImportError::content(path, found, format!("{height} rows")));
    }
    Ok(Grid {
        frame: GridFrame {
            width,
            height,
            resolution: 1.0,
            origin: Point2::origin(),
        },
        cells: rows.into_iter().rev().flatten().collect(),
    })
}

fn is_occupied(cell: char) -> Option<bool> {
    match cell {
        '.' | 'G' | 'S' => Some(false),
        'T' | 'W' | '@' | 'O' => Some(true),
        _ => None,
    }
}

/// The problems of a `.scen` file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problems {
    /// Path of the map as written.
    pub map: String,
    /// Size of the map: columns and rows.
    pub size: [usize; 2],
    /// Start and goal of each problem: column and row, counted from the *top* left.
    pub tasks: Vec<[[usize; 2]; 2]>,
}

/// Reads problems (`.scen`, version 1), all on one map.
pub fn problems(path: &Path, text: &str) -> Result<Problems, ImportError> {
    const FORM: &str = "bucket, map, width, height, start x, start y, goal x, goal y, length";
    let mut lines = (1..).zip(text.lines());
    let (line, version) = lines.next().unwrap_or((1, ""));
    if !version.trim().starts_with("version 1") {
        return Err(ImportError::line(path, line, version, "version 1"));
    }
    let mut found: Option<Problems> = None;
    for (line, text) in lines.filter(|(_, text)| !text.trim().is_empty()) {
        let bad = |expected: &str| ImportError::line(path, line, text, expected);
        // Names of maps contain spaces; tabs separate the fields then.
        let tab = text.contains('\t');
        let fields: Vec<&str> = if tab {
            text.split('\t').map(str::trim).collect()
        } else {
            text.split_whitespace().collect()
        };
        let &[_, map, width, height, sx, sy, gx, gy, _] = fields.as_slice() else {
            return Err(bad(FORM));
        };
        let number = |text: &str| text.parse::<usize>().map_err(|_| bad(FORM));
        let size = [number(width)?, number(height)?];
        let task = [[number(sx)?, number(sy)?], [number(gx)?, number(gy)?]];
        if task.iter().any(|at| at[0] >= size[0] || at[1] >= size[1]) {
            return Err(bad("positions on the map"));
        }
        let all = found.get_or_insert_with(|| Problems {
            map: map.to_owned(),
            size,
            tasks: Vec::new(),
        });
        if all.map != map || all.size != size {
            return Err(bad("the map of the lines before"));
        }
        all.tasks.push(task);
    }
    found.ok_or_else(|| ImportError::content(path, "no problem", "at least one"))
}

/// Returns the path, from the folder of the problems, of their map: its name if a file of this name is beside them, else its
/// path as written.
pub fn map_beside<'map>(folder: &Path, map: &'map str) -> &'map str {
    let name = Path::new(map).file_name().and_then(|name| name.to_str());
    let beside = name.filter(|name| !matches!(folder.join(name).try_exists(), Ok(false)));
    beside.unwrap_or(map)
}
