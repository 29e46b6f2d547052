//! Branches that a page asks for after the end of its run, or during a replay: this program makes each as `protean branch`, one at a time.

use std::io;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use mcap_log::{LogReadError, ReadProgress};
use platform::{program, shell};
use report::page::{LivePage, comparison};
use serde::Deserialize;
use serde_json::{Value as Json, json};

/// Interval between two checks for the end of the branch.
const POLL_INTERVAL: Duration = Duration::from_millis(10);

/// Change of a branch, as on the command line.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WhatIf {
    /// Simulated time of the change (s).
    at_s: f64,
    /// Places of robots: `ROBOT=X,Y[,HEADING]` (m, rad).
    #[serde(default)]
    place: Vec<String>,
    /// Values of the scenario: `KEY=VALUE`.
    #[serde(default)]
    set: Vec<String>,
}

/// Reason why there is no branch.
#[derive(Debug, thiserror::Error)]
pub(super) enum WhatIfError {
    /// The run has not ended.
    #[error("the run goes on: expected its end before a branch")]
    Running,
    /// Another branch is being made.
    #[error("another branch is being made: expected one at a time")]
    Busy,
    /// The command refuses the change, or the server ends meanwhile.
    #[error("{0}")]
    Refused(String),
    /// The command cannot be executed.
    #[error("protean branch: cannot be executed: {0}")]
    System(#[from] io::Error),
    /// The log of the branch cannot be read.
    #[error(transparent)]
    Log(#[from] LogReadError),
}

impl WhatIf {
    /// Returns the words of the command that makes the branch of a log.
    fn words(&self, log: &Path) -> Vec<String> {
        let mut words = vec!["branch".to_owned(), log.display().to_string()];
        words.push(format!("--at={}", self.at_s));
        words.extend(self.place.iter().map(|text| format!("--place={text}")));
        words.extend(self.set.iter().map(|text| format!("--set={text}")));
        words
    }

    /// Makes the branch of a log, and returns it with the differences (JSON, for the page); `ends`: the server ends.
    ///
    /// # Errors
    /// [`WhatIfError`].
    pub(super) fn make(&self, log: &Path, ends: impl Fn() -> bool) -> Result<String, WhatIfError> {
        let words = self.words(log);
        let mut child = Command::new(program::THIS)
            .arg0("protean")
            .args(&words)
            .args(["--json", "--quiet"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        // Its output is shorter than a pipe.
        while child.try_wait()?.is_none() {
            if ends() {
                child.kill()?;
            }
            std::thread::park_timeout(POLL_INTERVAL);
        }
        let output = child.wait_with_output()?;
        let report: Json = serde_json::from_slice(&output.stdout).unwrap_or_default();
        let branch = report.get("log").and_then(Json::as_str).map(PathBuf::from);
        let Some(branch) = branch.filter(|_| output.status.success()) else {
            let words = String::from_utf8_lossy(&output.stderr);
            let words = words.trim().trim_start_matches("error: ");
            let is_silent = words.is_empty();
            return Err(WhatIfError::Refused(if is_silent {
                format!("protean branch ended with {}", output.status)
            } else {
                words.to_owned()
            }));
        };
        let mut watch = ReadProgress::default();
        let differences = comparison(log, &branch, &mut watch)?;
        let run = LivePage::new(&branch).data(None, true, &Json::Null)?;
        let made = json!({
            "command": shell::line(["protean"].into_iter().chain(words.iter().map(String::as_str))),
            "log": branch.display().to_string(),
            "digest": report.get("branch_digest"),
            "comparison": differences,
        });
        // The run is large, and JSON already.
        let run = run.unwrap_or_else(|| Json::Null.to_string());
        Ok(format!("{{\"run\":{run},\"made\":{made}}}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_the_options_of_the_command_and_nothing_else() {
        let text = r#"{"at_s": 2.5, "place": ["a=1,-2"], "set": ["--force", "x=$(y)"]}"#;
        let change: WhatIf = serde_json::from_str(text).unwrap();
        assert_eq!(
            change.words(Path::new("logs/a.mcap")),
            [
                "branch",
                "logs/a.mcap",
                "--at=2.5",
                "--place=a=1,-2",
                "--set=--force",
                "--set=x=$(y)"
            ]
        );
        for text in ["{}", r#"{"at_s": 1, "out": "x"}"#, r#"{"at_s": "1"}"#] {
            assert!(serde_json::from_str::<WhatIf>(text).is_err(), "{text}");
        }
    }
}
