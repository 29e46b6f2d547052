//! Distributions of durations in bounded memory.

use hdrhistogram::{CreationError, Histogram};

/// An empty histogram of durations from one nanosecond to `longest_ns` that keeps three digits.
///
/// # Errors
/// [`CreationError`]: `longest_ns` is below two.
pub(crate) fn durations(longest_ns: u64) -> Result<Histogram<u64>, CreationError> {
    Histogram::new_with_bounds(1, longest_ns, 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_are_kept_and_what_is_too_long_counts_as_the_longest() {
        let mut histogram = durations(60_000_000_000).unwrap();
        for duration in [1, 1234, 987_654_321, u64::MAX] {
            histogram.saturating_record(duration);
        }
        assert_eq!(histogram.len(), 4);
        assert_eq!(histogram.value_at_quantile(0.25), 1);
        assert!(histogram.value_at_quantile(0.5).abs_diff(1234) <= 1);
        assert!(histogram.value_at_quantile(0.75).abs_diff(987_654_321) < 1_000_000);
        assert!(histogram.max() >= 60_000_000_000);
        assert_eq!(durations(0).unwrap_err(), durations(1).unwrap_err());
    }
}
