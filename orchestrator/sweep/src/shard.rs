//! One of several parts of an experiment.

/// Part `index` of `count`: the missions whose number in the canonical order of the experiment
/// (cell by cell, seed by seed) is `index − 1` modulo `count`. Every part thus has a share of every
/// cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    count: usize,
}

/// Error: a text does not name a shard.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{text:?} is not a shard: expected I/N with 1 <= I <= N <= 100000, for example 1/4")]
pub struct ShardError {
    /// The text.
    pub text: String,
}

/// Maximum number of shards.
pub const MAX_SHARDS: usize = 100_000;

impl Shard {
    /// The whole experiment in one part.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Parses `I/N`, counted from 1.
    ///
    /// # Errors
    /// [`ShardError`] if the text has another form or a number is out of range.
    pub fn parse(text: &str) -> Result<Self, ShardError> {
        let read = || {
            let (index, count) = text.split_once('/')?;
            let (index, count) = (index.parse().ok()?, count.parse().ok()?);
            ((1..=count).contains(&index) && count <= MAX_SHARDS).then_some(Self { index, count })
        };
        read().ok_or_else(|| ShardError {
            text: text.to_owned(),
        })
    }

    /// Returns the number of the part, from 1.
    pub fn index(self) -> usize {
        self.index
    }

    /// Returns `true` if the mission with this number belongs to the part.
    pub fn has(self, number: usize) -> bool {
        number % self.count == self.index - 1
    }

    /// Returns a name for a directory: `shard-1-of-4`; `None` for the whole.
    pub fn directory(self) -> Option<String> {
        (self.count > 1).then(|| format!("shard-{}-of-{}", self.index, self.count))
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mission_belongs_to_exactly_one_shard() {
        for count in 1..7 {
            for number in 0..50 {
                let holders = (1..=count).filter(|index| {
                    Shard::parse(&format!("{index}/{count}"))
                        .unwrap()
                        .has(number)
                });
                assert_eq!(holders.count(), 1, "{number} of {count}");
            }
        }
    }

    #[test]
    fn invalid_shards_are_refused() {
        for text in [
            "0/3", "4/3", "1", "1/0", "a/b", "1/2/3", "-1/2", "", "1/100001",
        ] {
            let error = Shard::parse(text).unwrap_err().to_string();
            assert!(error.contains("I/N"), "{error}");
        }
        assert_eq!(Shard::parse("2/3").unwrap().to_string(), "2/3");
        assert_eq!(Shard::WHOLE.directory(), None);
    }
}
