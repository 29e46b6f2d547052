//! Merges free cells into rectangles: always the largest that contains a corner cell.

use super::SAME;
use super::cells::{Block, Cells};

/// Cells that belong to no rectangle.
pub const UNOWNED: u32 = u32::MAX;

/// Appends disjoint blocks of all free cells of a strip, in the order in which they were taken, and notes
/// the block of each cell.
///
/// The remaining space only shrinks. So a corner cell remains one until it is taken, and the
/// largest rectangle about it remains the largest until one of its cells is taken. Both are
/// searched again only where the space has changed.
pub fn merge(cells: &Cells, strip: usize, blocks: &mut Vec<Block>, owners: &mut [u32]) {
    let mut rest = Rest {
        cells,
        free: cells.free_in(strip),
        left: vec![0; cells.count()],
        right: vec![0; cells.count()],
    };
    for row in 0..cells.rows() {
        rest.measure(row);
    }
    let mut corners: Vec<Corner> = (0..cells.count())
        .filter(|&cell| rest.is_corner(cell))
        .map(|cell| rest.best(cell))
        .collect();
    while let Some(taken) = corners.iter().copied().reduce(better) {
        let owner = blocks.len() as u32;
        blocks.push(taken.block);
        rest.take(&taken.block, owner, owners);
        corners.retain(|corner| rest.is_free(corner.cell));
        for corner in &mut corners {
            if corner.block.meets(&taken.block) {
                *corner = rest.best(corner.cell);
            }
        }
        for cell in rest.around(&taken.block) {
            if rest.is_corner(cell) && !corners.iter().any(|corner| corner.cell == cell) {
                corners.push(rest.best(cell));
            }
        }
    }
}

/// Extends a run of free cells by the next cell of a row; `beside` is the run before it.
fn count(run: &mut u32, free: bool, beside: &mut u32) {
    *beside = *run;
    *run = if free { *run + 1 } else { 0 };
}

/// A corner cell and the best block about it.
#[derive(Clone, Copy)]
struct Corner {
    cell: usize,
    area: f64,
    block: Block,
}

/// The larger block; of equal ones the one with the smaller x0, y0, x1, y1.
fn better(a: Corner, b: Corner) -> Corner {
    let b_wins = if (a.area - b.area).abs() <= SAME {
        b.block < a.block
    } else {
        b.area > a.area
    };
    if b_wins { b } else { a }
}

/// The cells that have not been taken.
struct Rest<'a> {
    cells: &'a Cells,
    free: Vec<bool>,
    /// Per free cell, the number of free cells in a row to its left.
    left: Vec<u32>,
    /// Per free cell, the number of free cells in a row to its right.
    right: Vec<u32>,
}

impl Rest<'_> {
    fn is_free(&self, cell: usize) -> bool {
        self.free.get(cell).copied().unwrap_or(false)
    }

    /// Returns `true` if a cell lacks a neighbour along x and one along y.
    fn is_corner(&self, cell: usize) -> bool {
        let width = self.cells.columns();
        let (column, row) = (cell % width, cell / width);
        let left = column > 0 && self.is_free(cell - 1);
        let right = column + 1 < width && self.is_free(cell + 1);
        let below = row > 0 && self.is_free(cell - width);
        let above = row + 1 < self.cells.rows() && self.is_free(cell + width);
        self.is_free(cell) && !(left && right) && !(below && above)
    }

    /// Recounts the runs of free cells of a row.
    fn measure(&mut self, row: usize) {
        let width = self.cells.columns();
        let cells = row * width..(row + 1) * width;
        let free = self.free.get(cells.clone()).unwrap_or_default();
        let mut run = 0;
        let left = self.left.get_mut(cells.clone()).unwrap_or_default();
        for (&free, left) in free.iter().zip(left) {
            count(&mut run, free, left);
        }
        run = 0;
        let right = self.right.get_mut(cells).unwrap_or_default();
        for (&free, right) in free.iter().zip(right).rev() {
            count(&mut run, free, right);
        }
    }

    /// The largest block of free cells about a free cell.
    fn best(&self, cell: usize) -> Corner {
        let width = self.cells.columns();
        let (column, row) = (cell % width, cell / width);
        // The free run through each row above and below, seen from the cell's column.
        let reach = |cell: usize| {
            let run = |runs: &[u32]| runs.get(cell).map_or(0, |&run| run as usize);
            (column - run(&self.left), column + run(&self.right))
        };
        let (mut low, mut high) = reach(cell);
        let start = Block {
            x0: low,
            y0: row,
            x1: high,
            y1: row,
        };
        let mut best = self.corner(cell, start);
        let mut first = row;
        loop {
            let (mut x0, mut x1) = (low, high);
            let mut last = row;
            loop {
                let block = Block {
                    x0,
                    y0: first,
                    x1,
                    y1: last,
                };
                best = better(best, self.corner(cell, block));
                last += 1;
                let above = last * width + column;
                if last >= self.cells.rows() || !self.is_free(above) {
                    break;
                }
                let (left, right) = reach(above);
                (x0, x1) = (x0.max(left), x1.min(right));
            }
            if first == 0 || !self.is_free((first - 1) * width + column) {
                return best;
            }
            first -= 1;
            let (left, right) = reach(first * width + column);
            (low, high) = (low.max(left), high.min(right));
        }
    }

    fn corner(&self, cell: usize, block: Block) -> Corner {
        let width = self.cells.width(block.x0, block.x1);
        Corner {
            cell,
            area: width * self.cells.height(block.y0, block.y1),
            block,
        }
    }

    fn take(&mut self, block: &Block, owner: u32, owners: &mut [u32]) {
        let width = self.cells.columns();
        for row in block.y0..=block.y1 {
            for cell in row * width + block.x0..=row * width + block.x1 {
                if let (Some(free), Some(slot)) = (self.free.get_mut(cell), owners.get_mut(cell)) {
                    *free = false;
                    *slot = owner;
                }
            }
            self.measure(row);
        }
    }

    /// The cells along the border of a block, outside it: taking the block can make them corners.
    fn around(&self, block: &Block) -> Vec<usize> {
        let (width, rows) = (self.cells.columns(), self.cells.rows());
        let mut around = Vec::new();
        for row in block.y0..=block.y1 {
            around.extend((block.x0 > 0).then(|| row * width + block.x0 - 1));
            around.extend((block.x1 + 1 < width).then(|| row * width + block.x1 + 1));
        }
        for column in block.x0..=block.x1 {
            around.extend((block.y0 > 0).then(|| (block.y0 - 1) * width + column));
            around.extend((block.y1 + 1 < rows).then(|| (block.y1 + 1) * width + column));
        }
        around
    }
}
