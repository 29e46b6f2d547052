//! Speeds for arrival at a due time.

/// Minimum fraction of the maximum speed: the robot does not stand still to wait.
const MIN_PACE: f64 = 0.02;

/// Fraction of its maximum speed `v_max` (m/s) at which a robot covers `distance` (m) in `time_s`; 1
/// if that is not enough, or if it is late.
pub fn part(distance: f64, time_s: f64, v_max: f64) -> f64 {
    let needed = distance / (time_s * v_max);
    // In this form, NaN counts as late.
    if time_s > 0.0 && needed < 1.0 {
        needed.max(MIN_PACE)
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pace_is_the_required_speed_within_bounds() {
        assert_eq!(part(1.0, 4.0, 0.5), 0.5);
        assert_eq!(part(1.0, 1.0, 0.5), 1.0);
        assert_eq!(part(1e-9, 4.0, 0.5), MIN_PACE);
        for late in [0.0, -1.0, f64::NAN] {
            assert_eq!(part(1.0, late, 0.5), 1.0);
            assert_eq!(part(0.0, late, 0.5), 1.0);
        }
    }
}
