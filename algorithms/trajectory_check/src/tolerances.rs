//! Tolerances of the check.

/// Allowances of the checker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Depth of the path inside a grown obstacle, or outside the bounds (m).
    pub penetration: f64,
    /// Speeds, turning rates, wheel speeds and accelerations above their limits, as a fraction of
    /// the limit; of `v_max` for the speed backwards, whose limit may be 0.
    pub limit: f64,
    /// Error of each condition at the start and the goal (m, rad, m/s, rad/s).
    pub boundary: f64,
    /// Difference between a sample's pose and the pose that follows from the controls since the
    /// previous sample, as a fraction of the distance or turn at the largest speed and at
    /// `omega_max` in the time between.
    pub mismatch: f64,
    /// The same difference that is always allowed between two samples (m, rad).
    pub mismatch_floor: f64,
    /// The same differences summed over the trajectory, beyond the fraction `mismatch` (m, rad).
    /// Without it, samples close enough together could drift anywhere by `mismatch_floor` a step.
    pub mismatch_total: f64,
    /// Effect of rounding on any difference of two samples (m, rad, m/s, rad/s, s); poses that
    /// differ by less are "the same".
    pub rounding: f64,
    /// Maximum length of the path between two samples (m).
    pub spacing: f64,
}

impl Tolerances {
    /// Tolerances of [`check`](crate::check): 1 mm, a thousandth of a limit, 10⁻⁶ at both ends, and
    /// samples at most 2 cm apart.
    pub const STANDARD: Self = Self {
        penetration: 1e-3,
        limit: 1e-3,
        boundary: 1e-6,
        mismatch: 1e-3,
        mismatch_floor: 1e-7,
        mismatch_total: 1e-5,
        rounding: 1e-9,
        spacing: 0.02,
    };
}

impl Default for Tolerances {
    fn default() -> Self {
        Self::STANDARD
    }
}
