//! Sample size after the spread of the belief (KLD sampling).

use super::cloud::Cloud;
use crate::params::AdaptiveSize;

/// Particles needed so that, at the wanted confidence, the Kullback–Leibler divergence between the
/// sampled and the true distribution over `bins` occupied bins stays below the bound (Fox,
/// "Adapting the sample size in particle filters through KLD-sampling", 2003, eq. 14: the
/// Wilson–Hilferty approximation of the χ² quantile).
pub(crate) fn sample_size(params: &AdaptiveSize, bins: usize) -> usize {
    if bins < 2 {
        return params.least;
    }
    let k = (bins - 1) as f64;
    let a = 2.0 / (9.0 * k);
    let root = 1.0 - a + a.sqrt() * params.quantile;
    let n = k / (2.0 * params.divergence) * root * root * root;
    // `as` saturates.
    (n.ceil() as usize).clamp(params.least, params.most)
}

/// Number of bins of (x, y, heading) that hold a particle. `keys` is working memory.
pub(crate) fn occupied_bins(params: &AdaptiveSize, cloud: &Cloud, keys: &mut Vec<u64>) -> usize {
    let per_metre = (1.0 / params.bin) as f32;
    let per_radian = params.heading_bins as f32 / core::f32::consts::TAU;
    keys.clear();
    keys.extend((0..cloud.len()).map(|i| {
        // 24 bits each for x and y; far-off maps wrap around, which merges bins 2^24 apart.
        let x = (cloud.x[i] * per_metre).floor() as i32 as u64 & 0x00ff_ffff;
        let y = (cloud.y[i] * per_metre).floor() as i32 as u64 & 0x00ff_ffff;
        let heading = (cloud.heading[i] * per_radian).floor() as i32;
        let turn = heading.rem_euclid(params.heading_bins as i32) as u64;
        (x << 40) | (y << 16) | turn
    }));
    keys.sort_unstable();
    keys.dedup();
    keys.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_follow_the_chi_square_quantile() {
        let params = AdaptiveSize {
            least: 1,
            most: 1_000_000,
            ..AdaptiveSize::default()
        };
        assert_eq!(sample_size(&params, 1), 1);
        // χ²(10, 0.99) = 23.209 and χ²(100, 0.99) = 135.807, over 2·0.05.
        assert!(
            sample_size(&params, 11).abs_diff(232) <= 2,
            "{}",
            sample_size(&params, 11)
        );
        assert!(
            sample_size(&params, 101).abs_diff(1358) <= 3,
            "{}",
            sample_size(&params, 101)
        );
        let capped = AdaptiveSize {
            least: 50,
            most: 200,
            ..params
        };
        assert_eq!(sample_size(&capped, 0), 50);
        assert_eq!(sample_size(&capped, 1000), 200);
    }

    #[test]
    fn bins_are_counted_once_and_headings_wrap() {
        let params = AdaptiveSize {
            bin: 0.5,
            heading_bins: 4,
            ..AdaptiveSize::default()
        };
        let mut cloud = Cloud::default();
        cloud.resize(6);
        cloud.x = vec![0.1, 0.4, -0.1, 0.1, 0.1, 0.1];
        cloud.y = vec![0.1, 0.4, 0.1, 0.6, 0.1, 0.1];
        cloud.heading = vec![0.1, 0.2, 0.1, 0.1, 3.1, -3.1];
        // {0, 1}, {2}, {3}, {4: second quadrant}, {5: third quadrant}.
        assert_eq!(occupied_bins(&params, &cloud, &mut Vec::new()), 5);
    }
}
