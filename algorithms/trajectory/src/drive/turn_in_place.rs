//! Turning on the spot.

use trajectory_problem::RobotLimits;

/// Phase of a turn: duration and turning rates, changed linearly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Duration (s).
    pub duration: f64,
    /// Turning rate at the beginning (rad/s).
    pub from: f64,
    /// Turning rate at the end (rad/s).
    pub to: f64,
}

/// The fastest turn by an angle (rad) on the spot from rest to rest: with limited angular
/// acceleration a trapezoid of turning rates, else constantly at the maximum.
pub fn phases(limits: &RobotLimits, angle: f64) -> Vec<Phase> {
    let (size, sign) = (angle.abs(), angle.signum());
    let top = limits.top_turn_rate();
    if size == 0.0 {
        return Vec::new();
    }
    let phase = |duration: f64, from: f64, to: f64| Phase {
        duration,
        from: sign * from,
        to: sign * to,
    };
    let Some(alpha) = limits.angular_acceleration else {
        return vec![phase(size / top, top, top)];
    };
    let peak = (alpha * size).sqrt().min(top);
    let ramp = peak / alpha;
    let level = (size - peak * ramp) / peak;
    let mut all = vec![phase(ramp, 0.0, peak)];
    if level > 1e-12 {
        all.push(phase(level, peak, peak));
    }
    all.push(phase(ramp, peak, 0.0));
    all
}

/// Shortest time (s) in which a heading can change by this angle (rad) ≥ 0, beginning with a
/// turning rate (rad/s) of at most `from` towards it and ending with any.
pub fn least_duration(limits: &RobotLimits, angle: f64, from: f64) -> f64 {
    let top = limits.top_turn_rate();
    let Some(alpha) = limits.angular_acceleration else {
        return angle / top;
    };
    let from = from.min(top);
    let peak = (from * from + 2.0 * alpha * angle).sqrt().min(top);
    let ramp = (peak - from) / alpha;
    let turned = 0.5 * (peak + from) * ramp;
    ramp + (angle - turned).max(0.0) / peak.max(f64::MIN_POSITIVE)
}
