//! Cells that a robot can visit.

use nalgebra::Point2;

use geometry::grid::GridFrame;

/// Known properties of the cells.
pub struct CoverageDomain<'a> {
    /// Frame of the cells.
    pub frame: &'a GridFrame,
    /// Distance (m) from each cell's centre to the nearest obstacle.
    pub clearance: &'a [f64],
}

/// Marks the cells whose centres come within `reach` (m) of a robot of radius `body` (m) that can
/// drive anywhere from `starts`.
///
/// The robot drives from cell to cell, centre to centre. A passage that is wider than the robot by
/// less than a cell may count as closed, and the space beyond it as unreachable.
pub fn mark(
    domain: &CoverageDomain<'_>,
    starts: impl Iterator<Item = Point2<f64>>,
    body: f64,
    reach: f64,
    coverable: &mut [bool],
) {
    let frame = domain.frame;
    let mut reached = vec![false; frame.len()];
    let mut open: Vec<(usize, usize)> = Vec::new();
    for (col, row) in starts.filter_map(|p| frame.cell_at(p)) {
        // The start is free, whatever its cell's centre.
        reached[frame.index(col, row)] = true;
        open.push((col, row));
    }
    while let Some((col, row)) = open.pop() {
        for (c, r) in neighbours(frame, col, row) {
            let cell = frame.index(c, r);
            if !reached[cell] && domain.clearance[cell] >= body {
                reached[cell] = true;
                open.push((c, r));
            }
        }
    }
    // A cell surrounded by others covers only itself in addition to the cells at the border.
    let cells = (reach / frame.resolution).floor() as isize;
    let within = (reach / frame.resolution) * (reach / frame.resolution);
    let disc: Vec<(isize, isize)> = (-cells..=cells)
        .flat_map(|r| (-cells..=cells).map(move |c| (c, r)))
        .filter(|&(c, r)| (c * c + r * r) as f64 <= within)
        .collect();
    for row in 0..frame.height {
        for col in 0..frame.width {
            if !reached[frame.index(col, row)] {
                continue;
            }
            coverable[frame.index(col, row)] = true;
            let around = neighbours(frame, col, row);
            if around.filter(|&(c, r)| reached[frame.index(c, r)]).count() == 4 {
                continue;
            }
            for &(dc, dr) in &disc {
                if let (Some(c), Some(r)) = (col.checked_add_signed(dc), row.checked_add_signed(dr))
                    && c < frame.width
                    && r < frame.height
                {
                    coverable[frame.index(c, r)] = true;
                }
            }
        }
    }
}

/// The up to four neighbours of a cell.
fn neighbours(
    frame: &GridFrame,
    col: usize,
    row: usize,
) -> impl Iterator<Item = (usize, usize)> + use<> {
    let (width, height) = (frame.width, frame.height);
    [
        (col.wrapping_sub(1), row),
        (col + 1, row),
        (col, row.wrapping_sub(1)),
        (col, row + 1),
    ]
    .into_iter()
    .filter(move |&(c, r)| c < width && r < height)
}
