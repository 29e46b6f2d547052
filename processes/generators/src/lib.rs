//! Keys and generators of points in the unit square: chaotic maps with integer state, the papers'
//! floating-point forms of them, and a keyed stream for observers who know the method.

/// A source of points in the plane, one per step.
///
/// A source has one native range; the other view of a point is the affine image of it. Stepping
/// never fails and never ends: what would (a degenerate key) is refused where a source is made.
pub trait Source {
    /// The next point, each coordinate in [0, 1].
    fn next_unit(&mut self) -> [f64; 2];

    /// The next point, each coordinate in [−1, 1]. Takes the same step as [`Source::next_unit`].
    fn next_symmetric(&mut self) -> [f64; 2] {
        self.next_unit().map(|c| 2.0 * c - 1.0)
    }
}
