//! Quantiles: the one definition for all results.

/// Returns the quantile of a share (0 to 1) of ascending values, linear between the two neighbours; `None`
/// without values or for a share out of range.
///
/// The value at place `share · (n − 1)`, counted from 0, as `numpy.quantile` does by default (definition 7 of
/// R. J. Hyndman and Y. Fan, *Sample quantiles in statistical packages*, Am. Stat. 50 (1996)). The median of an
/// even number is the mean of the middle two.
pub fn quantile(ascending: &[f64], share: f64) -> Option<f64> {
    if !(0.0..=1.0).contains(&share) {
        return None;
    }
    let at = share * ascending.len().checked_sub(1)? as f64;
    let (a, b) = (
        *ascending.get(at.floor() as usize)?,
        *ascending.get(at.ceil() as usize)?,
    );
    // Equal infinite values have no difference.
    Some(if a == b {
        a
    } else {
        a + (at - at.floor()) * (b - a)
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn quantiles_are_those_of_numpy() {
        let values = [1.0, 2.0, 4.0, 8.0];
        let found =
            [0.0, 0.05, 0.25, 0.5, 0.95, 1.0].map(|share| quantile(&values, share).unwrap());
        let expected = [1.0, 1.15, 1.75, 3.0, 7.4, 8.0];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        assert_eq!(quantile(&[7.0], 0.5), Some(7.0));
        assert_eq!(
            quantile(&[1.0, f64::INFINITY, f64::INFINITY], 0.75),
            Some(f64::INFINITY)
        );
        assert_eq!(quantile(&[1.0], 1.5), None);
        assert_eq!(quantile(&[1.0], f64::NAN), None);
        assert_eq!(quantile(&[], 0.5), None);
    }

    proptest! {
        #[test]
        fn quantiles_rise_with_the_share_and_have_that_share_below(
            mut values in prop::collection::vec(-1e3..1e3, 1..40), share in 0.0..1.0, more in 0.0..1.0,
        ) {
            values.sort_by(f64::total_cmp);
            let found = quantile(&values, share).unwrap();
            prop_assert!(quantile(&values, share.max(more)).unwrap() >= found);
            let intervals = (values.len() - 1) as f64;
            let below = values.iter().filter(|&&v| v < found).count() as f64;
            prop_assert!(below <= share * intervals + 1.0 + 1e-9);
            let above = values.iter().filter(|&&v| v > found).count() as f64;
            prop_assert!(above <= (1.0 - share) * intervals + 1.0 + 1e-9);
        }
    }
}
