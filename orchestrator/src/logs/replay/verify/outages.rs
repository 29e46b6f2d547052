//! Failures of the processes under test in the run of the log, and which of them a test repeats.

use super::super::super::failures::{Failure, Left};

/// A time for which the run was without a process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Outage {
    /// Index of the process in the run.
    pub(super) process: u32,
    /// The first tick that it did not do.
    pub(super) from: u64,
    /// The first tick that it, started anew, did again.
    pub(super) until: u64,
}

/// What of a run with failures can be tested.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Outages {
    /// Those that are repeated.
    pub(super) repeated: Vec<Outage>,
    /// The first failure that is not, and why: what was said before it can be tested.
    pub(super) end: Option<(Left, &'static str)>,
}

impl Outages {
    /// Sorts the failures of those under test, by tick; `obstacle` is what keeps a process from being
    /// replaced.
    pub(super) fn new(
        failures: Vec<Failure>,
        obstacle: impl Fn(u32) -> Option<&'static str>,
    ) -> Self {
        let mut found = Self::default();
        // Of whoever has not come back yet: who, when it left and what the log says of that.
        let mut away: Vec<(u32, Left)> = Vec::new();
        for failure in failures {
            let before = away.iter().position(|(index, _)| *index == failure.index);
            let left = if let Some(at) = before {
                // It failed before it was back: one outage.
                away.remove(at).1
            } else {
                let in_between = failure.had_spoken.then_some(IN_BETWEEN);
                if let Some(why) = obstacle(failure.index).or(in_between) {
                    found.end_with(failure.left, why);
                    break;
                }
                failure.left
            };
            match failure.back {
                Some(until) if until > left.tick => found.add(Outage {
                    process: failure.index,
                    from: left.tick,
                    until,
                }),
                Some(_) => found.end_with(left, NOT_SAID),
                None => away.push((failure.index, left)),
            }
        }
        for (_, left) in away {
            found.end_with(left, NEVER_BACK);
        }
        found
    }

    /// One that begins where another of the same process ends goes on with it: who came back then was
    /// gone before it had done anything.
    fn add(&mut self, outage: Outage) {
        let mut all = self.repeated.iter_mut();
        match all.find(|o| o.process == outage.process && o.until == outage.from) {
            Some(before) => before.until = outage.until,
            None => self.repeated.push(outage),
        }
    }

    fn end_with(&mut self, left: Left, why: &'static str) {
        if self
            .end
            .as_ref()
            .is_none_or(|(end, _)| left.tick < end.tick)
        {
            self.end = Some((left, why));
        }
    }
}

const IN_BETWEEN: &str = "it had said a part of what it had to say in that tick";
const NOT_SAID: &str = "the log does not say at which tick it came back";
const NEVER_BACK: &str = "it never came back";

#[cfg(test)]
mod tests {
    use super::*;

    fn failure(index: u32, tick: u64, back: Option<u64>) -> Failure {
        Failure {
            left: Left {
                process: format!("process {index}"),
                tick,
                reason: "was killed".to_owned(),
            },
            index,
            is_settled: back.is_some(),
            back,
            had_spoken: false,
        }
    }

    fn of(failures: &[Failure]) -> (Vec<[u64; 3]>, Option<(u64, &'static str)>) {
        let found = Outages::new(failures.to_vec(), |_| None);
        let repeated = found.repeated.iter();
        (
            repeated
                .map(|o| [u64::from(o.process), o.from, o.until])
                .collect(),
            found.end.map(|(left, why)| (left.tick, why)),
        )
    }

    #[test]
    fn who_came_back_was_away_until_then() {
        let found = of(&[failure(1, 10, Some(14)), failure(2, 12, Some(13))]);
        assert_eq!(found, (vec![[1, 10, 14], [2, 12, 13]], None));
    }

    #[test]
    fn failures_on_the_way_back_are_one_outage() {
        // Not ready in time at 14; back at 18, and gone again before it did anything.
        let found = of(&[
            failure(1, 10, None),
            failure(1, 14, Some(18)),
            failure(1, 18, Some(22)),
        ]);
        assert_eq!(found, (vec![[1, 10, 22]], None));
    }

    #[test]
    fn a_test_ends_with_whoever_did_not_come_back() {
        let found = of(&[
            failure(1, 10, Some(14)),
            failure(2, 20, None),
            failure(1, 30, Some(34)),
        ]);
        assert_eq!(found.1, Some((20, NEVER_BACK)));
        assert_eq!(of(&[failure(1, 10, Some(10))]).1, Some((10, NOT_SAID)));
    }

    #[test]
    fn a_test_ends_with_whoever_cannot_be_replaced_or_failed_in_between() {
        let mut half = failure(1, 10, Some(14));
        half.had_spoken = true;
        assert_eq!(of(&[half]).1, Some((10, IN_BETWEEN)));
        let found = Outages::new(vec![failure(1, 10, Some(14))], |_| Some("so"));
        assert_eq!(
            found.end.map(|(left, why)| (left.tick, why)),
            Some((10, "so"))
        );
        assert_eq!(found.repeated, []);
    }
}
