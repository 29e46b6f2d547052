//! Optimal matchings with integer costs, the same on every machine.

use pathfinding::kuhn_munkres::kuhn_munkres_min;
use pathfinding::matrix::Matrix;

/// Cost of an impossible match (ms), about three hours.
pub const NEVER_MS: i64 = 10_000_000;

/// Additional cost of a place beyond an evader's fair share (ms), so that all fair shares are
/// filled first; above any sum of driving times of a full team.
const SURPLUS_MS: i64 = NEVER_MS * 1024;

/// Converts a time to a cost (ms); [`NEVER_MS`] for NaN and infinity.
pub fn milliseconds(seconds: f64) -> i64 {
    let ms = (seconds * 1000.0).round();
    if ms >= 0.0 && ms < NEVER_MS as f64 {
        ms as i64
    } else {
        NEVER_MS
    }
}

/// Matches every row (pursuer) with a column (evader) at the minimum sum of costs (ms).
///
/// With n rows and m columns every column gets at least ⌊n/m⌋ rows and at most one more. With fewer
/// rows than columns, every row gets a separate column. `costs` holds n · m values in 0 ..= 10⁷,
/// row by row. Integer costs and a fixed order make the solution the same on every machine; the
/// algorithm's order decides between several optimal solutions.
pub fn balanced(costs: &[i64], rows: usize, columns: usize) -> Vec<(usize, usize)> {
    if rows == 0 || columns == 0 || costs.len() != rows * columns {
        return Vec::new();
    }
    let share = rows / columns;
    let surplus = usize::from(!rows.is_multiple_of(columns));
    let slots = columns * (share + surplus);
    let mut weights = Vec::with_capacity(rows * slots);
    for row in costs.chunks_exact(columns) {
        // Column number s is the (s / columns)-th place at evader s % columns.
        weights.extend((0..slots).map(|slot| {
            let beyond = share > 0 && slot / columns >= share;
            row[slot % columns] + if beyond { SURPLUS_MS } else { 0 }
        }));
    }
    let Ok(weights) = Matrix::from_vec(rows, slots, weights) else {
        return Vec::new();
    };
    let (_, chosen) = kuhn_munkres_min(&weights);
    chosen
        .into_iter()
        .enumerate()
        .map(|(row, slot)| (row, slot % columns))
        .collect()
}

/// Matches every row (pursuer) with a separate column (place) at the minimum sum of costs (ms).
///
/// `costs` holds n · m values in 0 ..= 10⁷, row by row, with n ≤ m; otherwise nothing is matched.
pub fn one_each(costs: &[i64], rows: usize, columns: usize) -> Vec<usize> {
    if rows == 0 || rows > columns || costs.len() != rows * columns {
        return Vec::new();
    }
    let Ok(weights) = Matrix::from_vec(rows, columns, costs.to_vec()) else {
        return Vec::new();
    };
    kuhn_munkres_min(&weights).1
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn load(matches: &[(usize, usize)], columns: usize) -> Vec<usize> {
        (0..columns)
            .map(|c| matches.iter().filter(|(_, to)| *to == c).count())
            .collect()
    }

    #[test]
    fn pursuers_nearest_to_one_evader_are_still_split_fairly() {
        let costs = [10, 500, 20, 500, 30, 500, 40, 500];
        let matches = balanced(&costs, 4, 2);
        assert_eq!(load(&matches, 2), [2, 2]);
        // Ties: all have the same cost for evader 1, so the two cheapest on evader 0 stay there.
        assert_eq!(matches, [(0, 0), (1, 0), (2, 1), (3, 1)]);
    }

    #[test]
    fn the_surplus_pursuer_goes_to_the_cheapest_evader() {
        let costs = [10, 900, 10, 900, 10, 900];
        assert_eq!(load(&balanced(&costs, 3, 2), 2), [2, 1]);
    }

    #[test]
    fn fewer_pursuers_than_evaders_take_one_each() {
        let costs = [5, 1, 9, 4, 1, 9];
        let matches = balanced(&costs, 2, 3);
        assert_eq!(matches.len(), 2);
        assert_ne!(matches[0].1, matches[1].1);
        assert_eq!(
            matches.iter().map(|&(r, c)| costs[r * 3 + c]).sum::<i64>(),
            5
        );
    }

    #[test]
    fn no_pursuer_and_no_evader_gives_no_assignment() {
        assert!(balanced(&[], 0, 2).is_empty());
        assert!(balanced(&[], 2, 0).is_empty());
        assert!(balanced(&[1, 2, 3], 2, 2).is_empty());
    }

    #[test]
    fn places_are_assigned_at_the_minimum_sum() {
        // The first is nearest to both places, but the second has no other near place.
        assert_eq!(one_each(&[10, 20, 15, 90], 2, 2), [1, 0]);
        assert_eq!(one_each(&[10, 20, 5], 1, 3), [2]);
        assert!(one_each(&[1, 2], 2, 1).is_empty());
        assert!(one_each(&[], 0, 0).is_empty());
        assert!(one_each(&[1], 1, 2).is_empty());
    }

    #[test]
    fn impossible_times_are_never() {
        assert_eq!(milliseconds(f64::NAN), NEVER_MS);
        assert_eq!(milliseconds(f64::INFINITY), NEVER_MS);
        assert_eq!(milliseconds(1.2345), 1235);
    }

    proptest! {
        #[test]
        fn shares_are_fair_and_no_exchange_of_two_is_cheaper(
            rows in 1_usize..7,
            columns in 1_usize..5,
            seed in prop::collection::vec(0_i64..=NEVER_MS, 35),
        ) {
            let costs: Vec<_> = (0..rows * columns).map(|i| seed[i % seed.len()]).collect();
            let matches = balanced(&costs, rows, columns);
            prop_assert_eq!(matches.len(), rows);
            prop_assert_eq!(&matches, &balanced(&costs, rows, columns));
            for count in load(&matches, columns) {
                prop_assert!(count >= rows / columns && count <= rows.div_ceil(columns));
            }
            let cost = |row: usize, column: usize| costs[row * columns + column];
            for &(a, ca) in &matches {
                for &(b, cb) in &matches {
                    prop_assert!(cost(a, ca) + cost(b, cb) <= cost(a, cb) + cost(b, ca));
                }
            }
        }
    }
}
