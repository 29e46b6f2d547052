//! Results of tests, as `protean test --json` prints them.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// Verdict of a test, from the best to the worst.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Every expectation holds.
    #[default]
    Pass,
    /// An interval is neither inside the expected range nor outside: more missions can decide. Or a mission did not end
    /// within its limit of real time.
    Inconclusive,
    /// An expectation does not hold, or a mission failed.
    Fail,
}

impl Verdict {
    /// Name in outputs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Inconclusive => "inconclusive",
            Self::Fail => "fail",
        }
    }
}

/// An expectation that does not hold, or is not decided.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Verdict; never a pass.
    pub verdict: Verdict,
    /// The expectation as its file has it.
    pub expected: String,
    /// Its line.
    pub line: usize,
    /// Seed of the mission; absent if it is about several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// The value.
    pub found: String,
    /// First difference from the accepted run, if its log is there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_difference: Option<String>,
    /// Command that repeats the mission with a log; absent if it is about several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
    /// Log of the mission, if it is kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub log: Option<PathBuf>,
}

/// Result of a mission.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MissionRecord {
    /// Seed.
    pub seed: u64,
    /// `ended`, `time_limit` or `failed`.
    pub outcome: String,
    /// Digest; empty if it failed.
    pub digest: String,
    /// Outcomes of the robots, by name.
    pub robots: BTreeMap<String, String>,
    /// Numbers of its row of results, by column.
    pub columns: BTreeMap<String, f64>,
    /// First difference from the accepted run, if its log is there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_difference: Option<String>,
}

/// Result of a test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestReport {
    /// Name: that of its file, and its own if the file has several.
    pub name: String,
    /// Its file.
    pub file: PathBuf,
    /// Its line in the file.
    pub line: usize,
    /// Verdict.
    pub verdict: Verdict,
    /// Expectations that do not hold.
    pub findings: Vec<Finding>,
    /// Its missions that ended or failed, by seed.
    pub missions: Vec<MissionRecord>,
}

/// Result of all tests.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SuiteReport {
    /// The worst verdict of its tests.
    pub verdict: Verdict,
    /// `true` if Ctrl-C ended it: some missions are missing.
    pub interrupted: bool,
    /// Real time (s).
    pub wall_time_s: f64,
    /// The tests, in the order of the files.
    pub tests: Vec<TestReport>,
}

impl SuiteReport {
    /// Returns the number of tests with a verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.tests.iter().filter(|t| t.verdict == verdict).count()
    }

    /// Returns the total in one line, without a full stop.
    pub fn total(&self) -> String {
        let missions: usize = self.tests.iter().map(|test| test.missions.len()).sum();
        let [pass, fail, open] =
            [Verdict::Pass, Verdict::Fail, Verdict::Inconclusive].map(|v| self.count(v));
        let end = if self.interrupted {
            ", interrupted"
        } else {
            ""
        };
        format!(
            "{pass} passed, {fail} failed, {open} inconclusive ({}){end}",
            count_text(missions)
        )
    }
}

/// Returns a number of missions in words.
pub fn count_text(missions: usize) -> String {
    let noun = if missions == 1 { "mission" } else { "missions" };
    format!("{missions} {noun}")
}
