//! The map of the particle filters: valid space and visibility.

use geometry::blur::BlurredMap;
use geometry::grid::GridFrame;
use geometry::visibility::VisibilityField;
use nalgebra::Point2;

use crate::fast;

/// A map prepared for the filters; rebuilt when an obstacle changes.
///
/// Every free cell is valid space, including exits and the space beyond them. Occupied cells and
/// all space outside the grid are not.
#[derive(Debug, Clone)]
pub struct Space {
    field: VisibilityField,
    frame: GridFrame,
    /// 1 per free cell, with a border of zeros one cell wide on each side.
    valid: Vec<u8>,
    /// Storage indices of the free cells, ascending.
    free: Vec<u32>,
    origin: [f32; 2],
    cells_per_metre: f32,
}

impl Space {
    /// Prepares a map.
    pub fn new(map: &BlurredMap) -> Self {
        let frame = *map.frame();
        let stride = frame.width + 2;
        let mut valid = vec![0; stride * (frame.height + 2)];
        let mut free = Vec::new();
        for (i, _) in map
            .occupied()
            .cells
            .iter()
            .enumerate()
            .filter(|&(_, &occupied)| !occupied)
        {
            valid[(i / frame.width + 1) * stride + i % frame.width + 1] = 1;
            // A map has at most 2^28 cells.
            free.push(i as u32);
        }
        Self {
            field: VisibilityField::new(map),
            frame,
            valid,
            free,
            origin: [frame.origin.x as f32, frame.origin.y as f32],
            cells_per_metre: (1.0 / frame.resolution) as f32,
        }
    }

    /// Frame of the cells.
    pub fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// Line of sight on this map.
    pub fn field(&self) -> &VisibilityField {
        &self.field
    }

    /// Storage indices of the free cells, ascending.
    pub fn free_cells(&self) -> &[u32] {
        &self.free
    }

    /// Returns `true` if a point (m) is valid for a particle.
    pub fn is_valid(&self, p: Point2<f64>) -> bool {
        self.field.is_free(p)
    }

    /// World position of a point in a cell, given by its storage index and two fractions in [0, 1).
    pub fn point_in(&self, cell: u32, fx: f64, fy: f64) -> Point2<f64> {
        let (col, row) = (
            cell as usize % self.frame.width,
            cell as usize / self.frame.width,
        );
        Point2::new(
            self.frame.origin.x + (col as f64 + fx) * self.frame.resolution,
            self.frame.origin.y + (row as f64 + fy) * self.frame.resolution,
        )
    }

    /// Looks up many points (m): writes their places in the table read by [`Self::valid_at`].
    ///
    /// Points outside the grid (and NaN) fall on the table's border.
    #[inline]
    pub(crate) fn locate(&self, xs: &[f32], ys: &[f32], places: &mut [u32]) {
        for ((&x, &y), place) in xs.iter().zip(ys).zip(places) {
            *place = self.place_of(x, y);
        }
    }

    /// As [`Self::locate`], for one point (m).
    #[inline]
    pub(crate) fn place_of(&self, x: f32, y: f32) -> u32 {
        let (right, top) = (self.frame.width as f32, self.frame.height as f32);
        let stride = (self.frame.width + 2) as u32;
        let [x0, y0] = self.origin;
        let (u, w) = (
            (x - x0) * self.cells_per_metre,
            (y - y0) * self.cells_per_metre,
        );
        border_index(w, top) * stride + border_index(u, right)
    }

    /// 1 if the place found by [`Self::locate`] is valid, else 0.
    #[inline]
    pub(crate) fn valid_at(&self, place: u32) -> u8 {
        self.valid[place as usize]
    }
}

/// Index along one axis of the bordered table: 0 below the grid (or NaN), `len + 1` above it.
#[inline]
fn border_index(coordinate: f32, len: f32) -> u32 {
    // `max` first: it turns NaN into −1. The sum has the integer in its low bits.
    const INTEGER: f32 = 8_388_608.0;
    let cell = fast::floor(coordinate.max(-1.0).min(len));
    (cell + 1.0 + INTEGER).to_bits() & 0x007f_ffff
}

#[cfg(test)]
pub(crate) mod tests;
