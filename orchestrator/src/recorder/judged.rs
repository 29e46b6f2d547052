//! What a referee said of a robot, over a run.

use ipc_types::messages::world::RobotState;

use super::summary::status_name;

/// The verdicts on one robot so far.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Judged {
    pub(super) verdicts: u64,
    possible: u64,
    /// Time of the first of the verdicts "not possible" since the last other one [s].
    impossible_from: Option<f64>,
}

impl Judged {
    /// Takes up a verdict of a moment [s].
    pub(super) fn add(&mut self, time_s: f64, possible: bool) {
        self.verdicts += 1;
        if possible {
            self.possible += 1;
            self.impossible_from = None;
        } else {
            self.impossible_from = self.impossible_from.or(Some(time_s));
        }
    }

    /// The verdicts on both.
    pub(super) fn and(self, other: &Self) -> Self {
        Self {
            verdicts: self.verdicts + other.verdicts,
            possible: self.possible + other.possible,
            impossible_from: None,
        }
    }

    /// Share of the verdicts that said "possible"; `None` without any.
    pub(super) fn fraction(&self) -> Option<f64> {
        (self.verdicts > 0).then(|| self.possible as f64 / self.verdicts as f64)
    }

    /// When an escape became impossible for good [s]; `None` if it did not, or the robot escaped.
    pub(super) fn impossible_from(&self, state: &RobotState) -> Option<f64> {
        self.impossible_from
            .filter(|_| status_name(state.status) != "escaped")
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use ipc_types::messages::referee::Verdict;
    use ipc_types::messages::world::{RobotState, WorldHeader};

    use super::super::options::RobotInfo;
    use super::super::outcome::Outcome;
    use super::super::summary::Summary;

    fn verdict(robot: u32, possible: bool) -> Verdict {
        Verdict {
            robot,
            escape_possible: u8::from(possible),
            ..Verdict::default()
        }
    }

    fn summary(states: &[(u8, &[(f64, bool)])]) -> Summary {
        let infos: Vec<RobotInfo> = (0..states.len())
            .map(|i| RobotInfo {
                name: format!("evader_{i}"),
                radius: 0.1,
                visits_waypoints: false,
            })
            .collect();
        let mut outcome = Outcome::new(&infos, &[], 1_000_000_000);
        let robots: Vec<RobotState> = (0..)
            .zip(states)
            .map(|(robot, &(status, _))| RobotState {
                robot,
                status,
                team: 2,
                ..RobotState::default()
            })
            .collect();
        outcome.state(&WorldHeader::default(), robots.into_iter());
        for (robot, (_, verdicts)) in (0..).zip(states) {
            for &(time_s, possible) in *verdicts {
                outcome.verdict(time_s, &verdict(robot, possible));
            }
        }
        // A robot that does not exist changes nothing.
        outcome.verdict(1.0, &verdict(99, true));
        outcome.finish(String::new(), BTreeMap::new(), BTreeMap::new())
    }

    #[test]
    fn escapes_become_impossible_with_the_last_verdict_that_is_not_taken_back() {
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
        // One that got away was not stopped, whatever was said last.
        let lucky = summary(&[(2, &lost)]);
        assert_eq!(lucky.robots[0].escape_impossible_from_s, None);
        assert_eq!(lucky.escape_impossible_from_s, None);
    }

    #[test]
    fn without_a_referee_there_is_nothing_to_say() {
        let summary = summary(&[(0, &[])]);
        assert_eq!(summary.escape_possible_fraction, None);
        let json = serde_json::to_string(&summary).unwrap();
        assert!(!json.contains("escape_"), "{json}");
    }
}
