//! Comparison of two cells that were played on the same seeds.

use std::collections::BTreeMap;

use statistics::{Interval, Mean, Sample, wilson_at};

use super::mcnemar::mcnemar_exact;
use super::newcombe::newcombe;

/// Hits and members of the game of every seed.
pub type BySeed = BTreeMap<u64, (u32, u32)>;

/// The difference of the shares of two cells, over the seeds that both have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Share of the first less share of the second, −1 to 1.
    pub value: f64,
    /// Number of seeds whose game has the larger share in the first cell, and in the second.
    pub larger: [u64; 2],
    /// Two-sided p-value of the hypothesis that both numbers have the same chance: McNemar's exact test by game.
    pub p_value: f64,
    /// Shares with their effective sizes.
    sides: [(f64, f64); 2],
    /// Correlation of the shares of a seed.
    correlation: f64,
}

impl Difference {
    /// Compares two cells; `None` without a common seed.
    pub fn of(first: &BySeed, second: &BySeed) -> Option<Self> {
        let pairs = || {
            let seeds = first.iter().filter(|(_, group)| group.1 > 0);
            seeds.filter_map(|(seed, &a)| Some((a, *second.get(seed).filter(|b| b.1 > 0)?)))
        };
        let (a, b): (Sample, Sample) = (
            pairs().map(|(a, _)| a).collect(),
            pairs().map(|(_, b)| b).collect(),
        );
        let (p, q) = (a.share()?, b.share()?);
        let mut larger = [0, 0];
        for (a, b) in pairs() {
            let (a, b) = (share(a), share(b));
            larger[0] += u64::from(a > b);
            larger[1] += u64::from(b > a);
        }
        let shares: Vec<_> = pairs().map(|(a, b)| [share(a), share(b)]).collect();
        Some(Self {
            value: p - q,
            larger,
            p_value: mcnemar_exact(larger[0], larger[1]),
            sides: [(p, a.effective_size()), (q, b.effective_size())],
            correlation: correlation(&shares),
        })
    }

    /// Returns the interval of the difference, `z` standard errors to either side ([`newcombe`]), with the
    /// outcomes of each cell counted by their [effective size](Sample::effective_size).
    pub fn interval(&self, z: f64) -> Interval {
        let [first, second] = self.sides.map(|(share, n)| (share, wilson_at(share, n, z)));
        newcombe(first, second, self.correlation)
    }
}

/// Returns the mean over the seeds of a difference of differences, (first − second) − (third − fourth), of the
/// shares of the seeds that all have.
pub fn difference_of_differences(cells: [&BySeed; 4]) -> Option<Mean> {
    let [first, second, third, fourth] = cells;
    let values = first.iter().filter_map(|(seed, &a)| {
        let of = |cell: &BySeed| cell.get(seed).copied().map(share);
        Some(share(a) - of(second)? - of(third)? + of(fourth)?)
    });
    Mean::of(&values.collect::<Vec<_>>())
}

fn share((hits, members): (u32, u32)) -> f64 {
    f64::from(hits) / f64::from(members.max(1))
}

/// Returns Pearson's correlation of pairs; 0 if one side does not vary.
fn correlation(pairs: &[[f64; 2]]) -> f64 {
    let n = pairs.len() as f64;
    let mean = |side: usize| pairs.iter().filter_map(|p| p.get(side)).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let [xx, yy, xy] = pairs.iter().fold([0.0; 3], |[xx, yy, xy], &[a, b]| {
        let (a, b) = (a - x, b - y);
        [xx + a * a, yy + b * b, xy + a * b]
    });
    if xx > 0.0 && yy > 0.0 {
        (xy / (xx * yy).sqrt()).clamp(-1.0, 1.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use statistics::Z95;

    use super::*;

    /// Single outcomes: a seed for each `true` or `false`.
    fn singles(hits: impl IntoIterator<Item = bool>) -> BySeed {
        let hits = hits.into_iter().map(|hit| (u32::from(hit), 1));
        (1..).zip(hits).collect()
    }

    #[test]
    fn outcomes_of_the_same_seeds_give_mcnemar_s_test() {
        // 50 seeds: 20 hits in both cells, 12 in the first alone, 2 in the second alone.
        let first = singles((0..50).map(|i| i < 32));
        let second = singles((0..50).map(|i| i < 20 || (32..34).contains(&i)));
        let d = Difference::of(&first, &second).unwrap();
        assert!((d.value - 0.2).abs() < 1e-12);
        assert_eq!(d.larger, [12, 2]);
        // 2 · (1 + 14 + 91) / 2¹⁴. Fisher's test of 32 and 22 of 50, as if independent, gives 0.07.
        assert!((d.p_value - 212.0 / 16384.0).abs() < 1e-12, "{d:?}");
        // φ = (20 · 16 − 12 · 2) / √(32 · 18 · 22 · 28).
        assert!((d.correlation - 0.4969).abs() < 1e-4, "{d:?}");
        assert!(d.interval(Z95).low > 0.0 && d.interval(Z95).contains(0.2));
    }

    #[test]
    fn only_seeds_of_both_cells_count() {
        let first = singles([true, true, false, false]);
        let second = singles([false, true]);
        let d = Difference::of(&first, &second).unwrap();
        assert_eq!((d.value, d.larger, d.p_value), (0.5, [1, 0], 1.0));
        assert_eq!(Difference::of(&first, &BySeed::new()), None);
        let empty: BySeed = [(1, (0, 0))].into();
        assert_eq!(Difference::of(&first, &empty), None);
    }

    #[test]
    fn games_count_once_however_many_evaders_they_have() {
        let pairs: BySeed = (1..=20).map(|seed| (seed, (2, 2))).collect();
        let none: BySeed = (1..=20)
            .map(|seed| (seed, (u32::from(seed > 5), 2)))
            .collect();
        let d = Difference::of(&pairs, &none).unwrap();
        assert_eq!(d.larger, [20, 0]);
        assert!((d.p_value - 2.0 / f64::from(1 << 20)).abs() < 1e-12);
    }

    #[test]
    fn equal_extremes_do_not_differ() {
        let never = singles([false; 50]);
        let d = Difference::of(&never, &never).unwrap();
        assert_eq!((d.value, d.larger, d.p_value), (0.0, [0, 0], 1.0));
        assert!(d.interval(Z95).contains(0.0) && d.interval(Z95).width() > 0.05);
    }

    #[test]
    fn differences_of_differences_are_means_over_seeds() {
        let cell = |hits: [u32; 3]| -> BySeed { (1..).zip(hits.map(|hits| (hits, 2))).collect() };
        let (a, b) = (cell([2, 2, 1]), cell([0, 1, 1]));
        let (c, d) = (cell([1, 0, 2]), cell([1, 0, 0]));
        // By seed: 1 − 0, ½ − 0, 0 − 1.
        let mean = difference_of_differences([&a, &b, &c, &d]).unwrap();
        assert!((mean.value - 0.5 / 3.0).abs() < 1e-12);
        assert_eq!(
            difference_of_differences([&a, &b, &c, &BySeed::new()]),
            None
        );
    }

    fn cell() -> impl Strategy<Value = BySeed> {
        prop::collection::btree_map(1_u64..60, (0_u32..=2, Just(2)), 1..60)
    }

    proptest! {
        #[test]
        fn the_difference_is_antisymmetric(a in cell(), b in cell()) {
            if let (Some(ab), Some(ba)) = (Difference::of(&a, &b), Difference::of(&b, &a)) {
                prop_assert!((ab.value + ba.value).abs() < 1e-12);
                prop_assert_eq!(ab.p_value, ba.p_value);
                let interval = ab.interval(Z95);
                prop_assert!(interval.low - 1e-12 <= ab.value && ab.value <= interval.high + 1e-12);
            }
        }
    }
}
