//! The common trait of all generators.

/// A source of points in the plane, one per step.
///
/// A source has one native range; the other view of a point is its affine image. A step never fails
/// and a source never ends: degenerate keys are rejected when a source is created.
pub trait Source {
    /// The next point, each coordinate in [0, 1].
    fn next_unit(&mut self) -> [f64; 2];

    /// The next point, each coordinate in [−1, 1]. Takes the same step as [`Source::next_unit`].
    fn next_symmetric(&mut self) -> [f64; 2] {
        self.next_unit().map(|c| 2.0 * c - 1.0)
    }
}

/// A point of [−1, 1]² as one of [0, 1]².
pub fn symmetric_to_unit(point: [f64; 2]) -> [f64; 2] {
    point.map(|c| 0.5 * (c + 1.0))
}
