//! Correction for several tests.

/// Holm's correction: adjusts p-values so that the chance of any false one among those below 5 % is
/// below 5 %. The order is kept.
///
/// Source: S. Holm, *A simple sequentially rejective multiple test procedure*, Scand. J. Stat. 6
/// (1979).
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let mut order: Vec<(usize, f64)> = p_values.iter().copied().enumerate().collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    let mut adjusted = p_values.to_vec();
    let mut largest = 0.0_f64;
    for (rank, (index, p)) in order.into_iter().enumerate() {
        let remaining = (p_values.len() - rank) as f64;
        largest = largest.max(p * remaining).min(1.0);
        if let Some(slot) = adjusted.get_mut(index) {
            *slot = largest;
        }
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_smallest_p_value_is_corrected_most_and_the_order_is_kept() {
        // By hand: 4 · 0.005, 3 · 0.01, 2 · 0.03, and 0.04 not below the one before.
        let adjusted = holm(&[0.01, 0.04, 0.03, 0.005]);
        let expected = [0.03, 0.06, 0.06, 0.02];
        for (a, e) in adjusted.iter().zip(expected) {
            assert!((a - e).abs() < 1e-12, "{adjusted:?}");
        }
        assert_eq!(holm(&[0.2]), [0.2]);
        assert!(holm(&[]).is_empty());
    }

    proptest! {
        #[test]
        fn holm_is_between_no_correction_and_bonferroni(
            p in prop::collection::vec(0.0..=1.0_f64, 1..20),
        ) {
            let adjusted = holm(&p);
            let n = p.len() as f64;
            for (i, (a, raw)) in adjusted.iter().zip(&p).enumerate() {
                prop_assert!(*a >= *raw && *a <= (raw * n).min(1.0) + 1e-12);
                for (b, other) in adjusted.iter().zip(&p).skip(i) {
                    prop_assert!((raw <= other) == (a <= b) || a == b);
                }
            }
        }
    }
}
