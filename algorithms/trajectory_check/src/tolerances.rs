//! How far a trajectory may miss what it claims.

/// Allowances of the checker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Depth of the path inside a grown obstacle, or outside the bounds (m).
    pub penetration: f64,
    /// Speeds, turning rates, wheel speeds and accelerations above their limits, as a fraction of
    /// the limit.
    pub limit: f64,
    /// Error of each condition at the start and the goal (m, rad, m/s, rad/s).
    pub boundary: f64,
    /// Difference between a sample's pose and where the controls lead from the sample before, as a
    /// fraction of what `v_max` and `omega_max` cover in the time between.
    pub mismatch: f64,
    /// The same difference that is always allowed between two samples (m, rad).
    pub mismatch_floor: f64,
    /// The same differences summed over the trajectory, beyond the fraction `mismatch` (m, rad).
    /// Without it, samples close enough together could crawl anywhere by `mismatch_floor` a step.
    pub mismatch_total: f64,
    /// What rounding may add to any difference of two samples (m, rad, m/s, rad/s, s); so close are
    /// poses "the same".
    pub rounding: f64,
    /// Longest way between two samples (m).
    pub spacing: f64,
}

impl Tolerances {
    /// What [`check`](crate::check) allows: 1 mm, a thousandth of a limit, 10⁻⁶ at both ends, and
    /// samples no more than 2 cm apart.
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
