//! Systematic resampling: one random offset, equally spaced pointers into the summed weights.

use super::cloud::Cloud;

/// 1.5·2^52: adding it to a number of magnitude below 2^31 leaves the nearest integer in the low bits.
const INTEGER: f64 = 6_755_399_441_055_744.0;

/// Chooses the ancestor of each of `count` new particles, with expected numbers of descendants
/// proportional to the weights and none for a weight of 0.
///
/// `total` is the sum of the weights, > 0, and `offset` is in (0, 1). Writes `starts`: entry j is
/// the particle whose first descendant is j, 0 where a previous particle has more than one.
/// Summation is sequential, in f64.
pub fn choose(weights: &[f32], total: f64, count: usize, offset: f64, starts: &mut Vec<u32>) {
    starts.clear();
    // One more, because particles after the last descendant are written there.
    starts.resize(count + 1, 0);
    let starts = &mut starts[..=count];
    let scale = count as f64 / total;
    // Descendants of the first i particles: the pointers j + offset below the scaled sum, that is
    // floor(sum·scale − offset + 1), computed by rounding to nearest.
    let shift = 0.5 - offset;
    let mut sum = 0.0_f64;
    let mut done = 0_usize;
    for (i, &w) in weights.iter().enumerate() {
        // The next particle overwrites it if this one has no descendants.
        starts[done] = i as u32;
        sum += f64::from(w);
        done = ((sum * scale + shift + INTEGER).to_bits() as u32 as usize).min(count);
    }
    // Rounding may leave the last pointer without a particle: it continues the previous one. A
    // particle without descendants may have written its number there.
    if done < count {
        starts[done] = 0;
    }
}

/// Copies the chosen particles.
pub fn copy(from: &Cloud, starts: &[u32], to: &mut Cloud) {
    let n = from.len();
    let count = starts.len().saturating_sub(1);
    to.resize(count);
    let (x, y, heading) = (&from.x[..n], &from.y[..n], &from.heading[..n]);
    let (v, omega) = (&from.v[..n], &from.omega[..n]);
    let (to_x, to_y, to_heading) = (
        &mut to.x[..count],
        &mut to.y[..count],
        &mut to.heading[..count],
    );
    let (to_v, to_omega) = (&mut to.v[..count], &mut to.omega[..count]);
    let mut from = 0;
    for (j, &start) in starts[..count].iter().enumerate() {
        from = from.max(start as usize);
        to_x[j] = x[from];
        to_y[j] = y[from];
        to_heading[j] = heading[from];
        to_v[j] = v[from];
        to_omega[j] = omega[from];
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn ancestors(weights: &[f32], count: usize, offset: f64) -> Vec<u32> {
        let total = weights.iter().map(|&w| f64::from(w)).sum();
        let mut starts = Vec::new();
        choose(weights, total, count, offset, &mut starts);
        let n = weights.len();
        let mut from = Cloud::default();
        from.resize(n);
        for (i, x) in from.x.iter_mut().enumerate() {
            *x = i as f32;
        }
        let mut to = Cloud::default();
        copy(&from, &starts, &mut to);
        to.x.iter().map(|&x| x as u32).collect()
    }

    #[test]
    fn equal_weights_keep_every_particle() {
        assert_eq!(ancestors(&[1.0; 5], 5, 0.5), [0, 1, 2, 3, 4]);
        assert_eq!(ancestors(&[0.3; 4], 8, 0.9), [0, 0, 1, 1, 2, 2, 3, 3]);
        assert_eq!(ancestors(&[2.0; 4], 2, 0.3), [0, 2]);
        assert_eq!(ancestors(&[0.0, 0.0, 1e-30, 0.0], 3, 0.999), [2, 2, 2]);
    }

    /// Over many offsets, the mean number of descendants is proportional to the weight.
    #[test]
    fn descendants_are_unbiased() {
        let weights = [0.1, 0.0, 2.0, 0.7, 0.0, 0.03, 1.1];
        let total: f32 = weights.iter().sum();
        let rounds = 2000;
        let mut counts = [0_u32; 7];
        for round in 0..rounds {
            let offset = (f64::from(round) + 0.5) / f64::from(rounds);
            for a in ancestors(&weights, 10, offset) {
                counts[a as usize] += 1;
            }
        }
        for (&w, &count) in weights.iter().zip(&counts) {
            let expected = f64::from(w / total) * 10.0;
            let mean = f64::from(count) / f64::from(rounds);
            assert!((mean - expected).abs() < 2e-3, "{mean} against {expected}");
        }
    }

    proptest! {
        /// Each particle has its expected number of descendants rounded up or down, in order.
        #[test]
        fn numbers_of_descendants_are_the_expected_ones_rounded(
            weights in proptest::collection::vec(
                prop_oneof![2 => Just(0.0_f32), 5 => 0.0..1.0_f32, 1 => 1e-12..1e-6_f32], 1..60),
            count in 1..100_usize,
            offset in 1e-10..1.0_f64,
        ) {
            let total: f64 = weights.iter().map(|&w| f64::from(w)).sum();
            prop_assume!(total > 0.0);
            let chosen = ancestors(&weights, count, offset);
            prop_assert_eq!(chosen.len(), count);
            prop_assert!(chosen.is_sorted());
            for (i, &w) in weights.iter().enumerate() {
                let expected = f64::from(w) / total * count as f64;
                let found = chosen.iter().filter(|&&a| a as usize == i).count() as f64;
                prop_assert!((found - expected).abs() < 1.0 + 1e-9, "{} of {}", found, expected);
                prop_assert!(w > 0.0 || found == 0.0);
            }
        }
    }
}
