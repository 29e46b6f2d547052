//! Limits of an opponent's motion.

/// Motion limits of an opponent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionLimits {
    /// Maximum forward speed (m/s), ≥ 0.
    pub v_max: f64,
    /// Maximum backward speed (m/s), ≥ 0.
    pub v_reverse_max: f64,
    /// Maximum turning rate either way (rad/s), ≥ 0.
    pub omega_max: f64,
}
