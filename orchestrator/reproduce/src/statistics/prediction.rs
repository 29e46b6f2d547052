//! Intervals for one more observation.

use statistics::{Interval, Mean};

/// Returns the 95 % prediction interval for one more value like these (Student's t, values normally distributed);
/// unbounded for a single value.
pub fn prediction_95(mean: &Mean) -> Interval {
    let half = mean.interval().width() / 2.0 * (mean.count as f64 + 1.0).sqrt();
    Interval {
        low: mean.value - half,
        high: mean.value + half,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_more_value_scatters_more_than_the_mean() {
        let mean = Mean::of(&[1.0, 2.0, 3.0, 4.0]).unwrap();
        let interval = prediction_95(&mean);
        // s = 1.29099, t with 3 degrees of freedom 3.18245: 2.5 ± 3.18245 s √(1 + 1/4).
        assert!(
            (interval.high - 2.5 - 4.593_471).abs() < 1e-4,
            "{interval:?}"
        );
        assert!(
            (interval.low - 2.5 + 4.593_471).abs() < 1e-4,
            "{interval:?}"
        );
        let one = prediction_95(&Mean::of(&[1.0]).unwrap());
        assert!(!one.width().is_finite());
    }
}
