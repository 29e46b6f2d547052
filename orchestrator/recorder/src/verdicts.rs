//! Verdicts of a referee over a run.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::topics::{TopicId, Verdicts};

use super::summary::{OutcomePart, Summary};

/// Verdicts on all robots.
#[derive(Debug)]
pub(super) struct VerdictTotals(Vec<RobotVerdicts>);

impl VerdictTotals {
    /// Creates the totals for this many robots.
    pub(super) fn new(robots: usize) -> Self {
        Self(vec![RobotVerdicts::default(); robots])
    }
}

impl Consumer for VerdictTotals {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::Verdicts]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        if let Some((_, verdicts)) = message.view::<Verdicts>() {
            for verdict in verdicts {
                if let Some(verdicts) = self.0.get_mut(verdict.robot as usize) {
                    verdicts.add(message.time_s(), verdict.escape_possible != 0);
                }
            }
        }
    }
}

impl OutcomePart for VerdictTotals {
    fn finish(self: Box<Self>, summary: &mut Summary) {
        // The latest time counts; a robot that escaped or could escape at the end leaves none.
        let mut last = Some(f64::NEG_INFINITY);
        for (robot, verdicts) in summary.robots.iter_mut().zip(&self.0) {
            robot.escape_possible_fraction = verdicts.fraction();
            robot.escape_impossible_from_s = verdicts
                .impossible_from
                .filter(|_| robot.outcome != "escaped");
            if verdicts.verdicts > 0 {
                let from = robot.escape_impossible_from_s;
                last = last.and_then(|last| Some(last.max(from?)));
            }
        }
        summary.escape_impossible_from_s = last.filter(|from| from.is_finite());
        let all = self
            .0
            .iter()
            .fold(RobotVerdicts::default(), RobotVerdicts::and);
        summary.escape_possible_fraction = all.fraction();
    }
}

/// Verdicts on one robot.
#[derive(Debug, Clone, Copy, Default)]
struct RobotVerdicts {
    verdicts: u64,
    possible: u64,
    /// Time of the first verdict "not possible" after the last "possible" (s).
    impossible_from: Option<f64>,
}

impl RobotVerdicts {
    /// Adds a verdict at a time (s).
    fn add(&mut self, time_s: f64, possible: bool) {
        self.verdicts += 1;
        if possible {
            self.possible += 1;
            self.impossible_from = None;
        } else {
            self.impossible_from = self.impossible_from.or(Some(time_s));
        }
    }

    /// Returns the verdicts on both robots.
    fn and(self, other: &Self) -> Self {
        Self {
            verdicts: self.verdicts + other.verdicts,
            possible: self.possible + other.possible,
            impossible_from: None,
        }
    }

    /// Returns the share of verdicts "possible"; `None` without verdicts.
    fn fraction(&self) -> Option<f64> {
        (self.verdicts > 0).then(|| self.possible as f64 / self.verdicts as f64)
    }
}

#[cfg(test)]
mod tests {
    use ipc_types::cdr;
    use ipc_types::messages::referee::Verdict;
    use ipc_types::stamp::PlainHeader;

    use super::super::summary::{RobotOutcome, status_name};
    use super::*;

    fn verdict(robot: u32, possible: bool) -> Verdict {
        Verdict {
            robot,
            escape_possible: u8::from(possible),
            ..Verdict::default()
        }
    }

    fn summary(robots: &[(u8, &[(f64, bool)])]) -> Summary {
        let mut verdicts = Box::new(VerdictTotals::new(robots.len()));
        let mut judge = |time_s: f64, verdict: Verdict| {
            let mut bytes = Vec::new();
            cdr::encode::<Verdicts>(&PlainHeader::default(), &[verdict], &mut bytes);
            let time_ns = (time_s * 1e9) as u64;
            let message = LoggedMessage::new(TopicId::Verdicts, time_ns, &bytes).unwrap();
            verdicts.message(&message, &mut ());
        };
        for (robot, (_, verdicts)) in (0..).zip(robots) {
            for &(time_s, possible) in *verdicts {
                judge(time_s, verdict(robot, possible));
            }
        }
        // A robot that does not exist is ignored.
        judge(1.0, verdict(99, true));
        let robots = robots.iter().map(|&(status, _)| RobotOutcome {
            outcome: status_name(status).to_owned(),
            ..RobotOutcome::default()
        });
        let mut summary = Summary {
            robots: robots.collect(),
            ..Summary::default()
        };
        verdicts.finish(&mut summary);
        summary
    }

    #[test]
    fn escapes_become_impossible_with_the_last_verdict_that_is_not_reversed() {
        let lost = [
            (0.0, true),
            (1.0, false),
            (2.0, true),
            (3.0, false),
            (4.0, false),
        ];
        let sure = [(0.0, false), (1.0, true)];
        let only_lost = summary(&[(1, &lost)]);
        assert_eq!(only_lost.robots[0].escape_possible_fraction, Some(0.4));
        assert_eq!(only_lost.robots[0].escape_impossible_from_s, Some(3.0));
        assert_eq!(only_lost.escape_impossible_from_s, Some(3.0));
        let both = summary(&[(1, &lost), (0, &sure)]);
        assert_eq!(both.escape_possible_fraction, Some(3.0 / 7.0));
        assert_eq!(both.escape_impossible_from_s, None);
        // A robot that escaped counts as such, regardless of the last verdict.
        let lucky = summary(&[(2, &lost)]);
        assert_eq!(lucky.robots[0].escape_impossible_from_s, None);
        assert_eq!(lucky.escape_impossible_from_s, None);
    }

    #[test]
    fn without_a_referee_the_summary_has_no_verdicts() {
        let summary = summary(&[(0, &[])]);
        assert_eq!(summary.escape_possible_fraction, None);
        let json = serde_json::to_string(&summary).unwrap();
        assert!(!json.contains("escape_"), "{json}");
    }
}
