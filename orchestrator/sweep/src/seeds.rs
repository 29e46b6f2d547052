//! The seeds of an experiment.

use serde::{Deserialize, Serialize};

/// Maximum number of missions (cells times seeds) of one experiment.
pub const MAX_MISSIONS: usize = 1_000_000;
/// Maximum seed of a scenario.
pub const MAX_SEED: u64 = i64::MAX as u64;

/// A set of seeds, in ascending order.
///
/// Written as ranges, both ends included: `[[1, 200], [500, 500]]`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Vec<(u64, u64)>", into = "Vec<(u64, u64)>")]
pub struct Seeds(Vec<u64>);

/// Error: a text is not a range of seeds.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{text:?} is not a range of seeds: expected A..B with 0 <= A <= B (both included), or one seed"
)]
pub struct SeedsError {
    /// The text.
    pub text: String,
}

impl Seeds {
    /// Returns `count` seeds from `first` on; `None` if they exceed the maximum seed.
    pub fn range(first: u64, count: u64) -> Option<Self> {
        let Some(last) = count.checked_sub(1) else {
            return Some(Self::default());
        };
        let last = first.checked_add(last).filter(|&last| last <= MAX_SEED)?;
        Some(Self((first..=last).collect()))
    }

    /// Returns a set of these seeds.
    pub fn from_values(mut seeds: Vec<u64>) -> Self {
        seeds.sort_unstable();
        seeds.dedup();
        Self(seeds)
    }

    /// Parses `A..B`, both included, or one number.
    ///
    /// # Errors
    /// `SeedsError` if it is neither, or has more than a million seeds.
    pub fn parse(text: &str) -> Result<Self, SeedsError> {
        let refused = || SeedsError {
            text: text.to_owned(),
        };
        let number = |s: &str| s.trim().parse::<u64>().map_err(|_| refused());
        let (first, last) = match text.split_once("..") {
            Some((first, last)) => (number(first)?, number(last)?),
            None => (number(text)?, number(text)?),
        };
        let count = last.checked_sub(first).ok_or_else(refused)?;
        if count >= MAX_MISSIONS as u64 {
            return Err(refused());
        }
        Self::range(first, count + 1).ok_or_else(refused)
    }

    /// Returns the seeds, ascending.
    pub fn iter(&self) -> impl Iterator<Item = u64> {
        self.0.iter().copied()
    }

    /// Returns the number of seeds.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns `true` if there is no seed.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the union with other seeds.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self::from_values(self.iter().chain(other.iter()).collect())
    }
}

impl From<Vec<(u64, u64)>> for Seeds {
    fn from(ranges: Vec<(u64, u64)>) -> Self {
        let most = MAX_MISSIONS;
        Self::from_values(
            ranges
                .into_iter()
                .flat_map(|(first, last)| first..=last)
                // A manifest is an untrusted file: bound the number of seeds.
                .take(most)
                .collect(),
        )
    }
}

impl From<Seeds> for Vec<(u64, u64)> {
    fn from(seeds: Seeds) -> Self {
        let mut ranges: Self = Self::new();
        for seed in seeds.iter() {
            match ranges.last_mut() {
                Some((_, last)) if *last + 1 == seed => *last = seed,
                _ => ranges.push((seed, seed)),
            }
        }
        ranges
    }
}

impl std::fmt::Display for Seeds {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ranges: Vec<(u64, u64)> = self.clone().into();
        for (i, (first, last)) in ranges.iter().enumerate() {
            let comma = if i > 0 { ", " } else { "" };
            if first == last {
                write!(f, "{comma}{first}")?;
            } else {
                write!(f, "{comma}{first}..{last}")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn both_ends_of_a_range_are_included() {
        assert_eq!(Seeds::parse("3..5").unwrap(), Seeds(vec![3, 4, 5]));
        assert_eq!(Seeds::parse("7").unwrap(), Seeds(vec![7]));
        for text in [
            "5..3",
            "a..b",
            "",
            "1..",
            "-1..2",
            "0..99999999999",
            "1...3",
        ] {
            let error = Seeds::parse(text).unwrap_err().to_string();
            assert!(error.contains("both included"), "{text}: {error}");
        }
    }

    #[test]
    fn the_largest_seed_is_the_largest_of_a_scenario() {
        assert!(Seeds::range(MAX_SEED, 1).is_some());
        assert!(Seeds::range(MAX_SEED, 2).is_none());
        assert!(Seeds::range(u64::MAX, 1).is_none());
        assert_eq!(Seeds::range(1, 0), Some(Seeds::default()));
    }

    proptest! {
        #[test]
        fn ranges_hold_the_same_seeds(seeds in prop::collection::vec(0_u64..60, 0..50)) {
            let seeds = Seeds::from_values(seeds);
            let json = serde_json::to_string(&seeds).unwrap();
            prop_assert_eq!(serde_json::from_str::<Seeds>(&json).unwrap(), seeds);
        }
    }
}
