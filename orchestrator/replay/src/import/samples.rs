//! Messages of a topic by their times, and those nearest to the ticks of a run.

use std::path::Path;

use robot::spec::ScanSpec;
use ros_messages::messages::Time;

use super::{ImportError, ImportedTopic};

/// The messages of a topic.
#[derive(Debug)]
pub struct Samples<T> {
    /// Their frame.
    pub frame: String,
    /// The frame that odometry places.
    pub child: String,
    /// The scanner of scans.
    pub scanner: Option<ScanSpec>,
    /// Times (ns) and contents, at least one; in ascending order after the bag was read.
    pub list: Vec<(i64, T)>,
}

/// Returns a time of ROS 2 in nanoseconds.
pub fn nanoseconds(time: &Time) -> i64 {
    i64::from(time.sec) * 1_000_000_000 + i64::from(time.nanosec)
}

impl<T> Samples<T> {
    /// Returns the times of the first and last message (ns).
    pub fn span(&self) -> (i64, i64) {
        let at = |sample: Option<&(i64, T)>| sample.map_or(0, |(at, _)| *at);
        (at(self.list.first()), at(self.list.last()))
    }

    /// Returns the message nearest to each tick (ns), with its time; the last argument are the bag and the topic.
    ///
    /// # Errors
    /// [`ImportError::Gap`].
    pub fn at_ticks(
        &self,
        ticks: impl Iterator<Item = i64>,
        max_age_s: f64,
        (bag, topic): (&Path, &str),
    ) -> Result<(Vec<&(i64, T)>, ImportedTopic), ImportError> {
        let (mut out, mut largest) = (Vec::new(), 0);
        for tick in ticks {
            let after = self.list.partition_point(|(at, _)| *at < tick);
            let near = self
                .list
                .get(after.saturating_sub(1)..)
                .unwrap_or_default()
                .iter()
                .take(2);
            let Some(nearest) = near.clone().min_by_key(|(at, _)| at.abs_diff(tick)) else {
                continue;
            };
            let age = nearest.0.abs_diff(tick);
            if age as f64 > max_age_s * 1e9 {
                let seconds =
                    |sample: Option<&(i64, T)>| sample.map_or(0.0, |(at, _)| *at as f64 / 1e9);
                return Err(ImportError::Gap {
                    bag: bag.to_owned(),
                    topic: topic.to_owned(),
                    from_s: seconds(near.clone().next()),
                    to_s: seconds(near.last()),
                    max_age_s,
                });
            }
            largest = largest.max(age);
            out.push(nearest);
        }
        let used = ImportedTopic {
            topic: topic.to_owned(),
            messages: self.list.len(),
            max_age_s: largest as f64 / 1e9,
        };
        Ok((out, used))
    }
}
