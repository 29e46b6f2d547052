//! Speeds with which a robot arrives when it is due.

/// Least part of its highest speed that a robot drives at to be on time: it does not stand still to
/// wait.
const MIN_PACE: f64 = 0.02;

/// Part of its highest speed `v_max` (m/s) at which a robot covers `distance` (m) in `time_s`; all of
/// it if that is not enough, or if it is late.
pub(super) fn part(distance: f64, time_s: f64, v_max: f64) -> f64 {
    let needed = distance / (time_s * v_max);
    // Written so that NaN is late as well.
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
    fn it_is_the_speed_that_is_needed_within_bounds() {
        assert_eq!(part(1.0, 4.0, 0.5), 0.5);
        assert_eq!(part(1.0, 1.0, 0.5), 1.0);
        assert_eq!(part(1e-9, 4.0, 0.5), MIN_PACE);
        for late in [0.0, -1.0, f64::NAN] {
            assert_eq!(part(1.0, late, 0.5), 1.0);
            assert_eq!(part(0.0, late, 0.5), 1.0);
        }
    }
}
