//! Quantiles of sorted values.

/// Returns the smallest of the ascending values that has at least this share of the values at or below it;
/// `None` without values.
pub fn quantile(ascending: &[f64], share: f64) -> Option<f64> {
    let rank = (share * ascending.len() as f64).ceil() as usize;
    ascending
        .get(rank.max(1).min(ascending.len()).checked_sub(1)?)
        .copied()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn quantiles_are_values_of_the_list(mut values in prop::collection::vec(-1e3..1e3, 1..40), share in 0.0..1.0) {
            values.sort_by(f64::total_cmp);
            let found = quantile(&values, share).unwrap();
            let below = values.iter().filter(|&&v| v <= found).count() as f64;
            prop_assert!(below >= share * values.len() as f64 - 1e-9);
            let under = values.iter().filter(|&&v| v < found).count() as f64;
            prop_assert!(under <= share * values.len() as f64 + 1e-9);
        }
    }
}
