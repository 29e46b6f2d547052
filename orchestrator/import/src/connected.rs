//! The largest connected part of the free cells.

use geometry::grid::Grid;

/// Marks all free cells as occupied except those of the largest part that is connected over the sides of cells; of equal
/// ones, that with the first cell. Returns the number of free cells that remain.
pub fn keep_largest(occupied: &mut Grid<bool>) -> usize {
    let (width, height) = (occupied.frame.width, occupied.frame.height);
    // The part of each cell, from 1; 0 is none yet.
    let mut part_of = vec![0_u32; occupied.cells.len()];
    let (mut parts, mut largest) = (0, (0_usize, 0));
    let mut open = Vec::new();
    for start in 0..occupied.cells.len() {
        if occupied.cells[start] || part_of[start] != 0 {
            continue;
        }
        parts += 1;
        part_of[start] = parts;
        open.push(start);
        let mut size = 0;
        while let Some(cell) = open.pop() {
            size += 1;
            let (column, row) = (cell % width, cell / width);
            let neighbours = [
                (column > 0).then(|| cell - 1),
                (column + 1 < width).then_some(cell + 1),
                (row > 0).then(|| cell - width),
                (row + 1 < height).then_some(cell + width),
            ];
            for next in neighbours.into_iter().flatten() {
                if !occupied.cells[next] && part_of[next] == 0 {
                    part_of[next] = parts;
                    open.push(next);
                }
            }
        }
        if size > largest.0 {
            largest = (size, parts);
        }
    }
    for (cell, part) in occupied.cells.iter_mut().zip(&part_of) {
        *cell = *part == 0 || *part != largest.1;
    }
    largest.0
}
