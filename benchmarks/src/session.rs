//! A whole run of a scenario as a child process, observed from outside.

use std::fs::File;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use runtime::config::ProcessConfig;
use runtime::lockstep::TickBarrier;
use rustix::process::{Pid, Signal};
use serde_json::Value as Json;
use tempfile::TempDir;

use super::Result;
use super::probe::{self, Member};

/// A running `protean run`; dropping it ends the run. It is in this program's process group, so
/// that Ctrl-C ends both.
#[derive(Debug)]
pub struct Session {
    child: Child,
    folder: TempDir,
    begun: Instant,
}

impl Session {
    /// Starts `protean run SCENARIO` with these further arguments; its log is in a temporary
    /// folder.
    ///
    /// # Errors
    /// An error of the operating system.
    pub fn start(scenario: &str, arguments: &[String]) -> Result<Self> {
        let folder = tempfile::tempdir()?;
        let file = |name: &str| File::create(folder.path().join(name));
        let (output, errors) = (file("report.json")?, file("errors.txt")?);
        let begun = Instant::now();
        let child = Command::new(std::env::current_exe()?)
            .args(["run", scenario, "--json", "--quiet", "--force", "--out"])
            .arg(folder.path().join("run.mcap"))
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(output)
            .stderr(errors)
            .spawn()?;
        Ok(Self {
            child,
            folder,
            begun,
        })
    }

    /// Returns the process id of the run's orchestrator.
    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Returns the time since the run was started.
    pub fn age(&self) -> Duration {
        self.begun.elapsed()
    }

    /// Waits for the end, calling `look` every `poll_interval`; returns the output of `protean run
    /// --json`.
    ///
    /// # Errors
    /// The stderr of a failed run.
    pub fn finish(mut self, poll_interval: Duration, mut look: impl FnMut(&Self)) -> Result<Json> {
        let status = loop {
            if let Some(status) = self.child.try_wait()? {
                break status;
            }
            look(&self);
            std::thread::sleep(poll_interval);
        };
        let read = |name: &str| std::fs::read_to_string(self.folder.path().join(name));
        if !status.success() {
            return Err(format!("protean run: {status}: {}", read("errors.txt")?.trim()).into());
        }
        Ok(serde_json::from_str(&read("report.json")?)?)
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        if matches!(self.child.try_wait(), Ok(Some(_))) {
            return;
        }
        let _ = rustix::process::kill_process(Pid::from_child(&self.child), Signal::TERM);
        let _ = self.child.wait();
    }
}

/// A run observed from outside: its processes and its tick barrier.
#[derive(Debug)]
pub struct View {
    /// The processes, without the orchestrator.
    pub members: Vec<Member>,
    /// The tick barrier.
    pub barrier: TickBarrier,
}

impl View {
    /// Finds the run of this orchestrator; `None` while it has no processes or barrier.
    pub fn find(orchestrator: u32) -> Option<Self> {
        let members = probe::members(orchestrator);
        let config = ProcessConfig::load(&members.first()?.config).ok()?;
        let barrier = TickBarrier::open(&config.run.prefix).ok()?;
        // Some processes may not have been started, or executed, yet.
        (members.len() == barrier.processes()).then_some(Self { members, barrier })
    }
}

/// Returns a number in a run's JSON; 0 if it is missing.
pub fn number(report: &Json, pointer: &str) -> f64 {
    report
        .pointer(pointer)
        .and_then(Json::as_f64)
        .unwrap_or(0.0)
}
