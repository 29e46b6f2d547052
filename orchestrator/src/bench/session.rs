//! A whole run of a scenario as a child of the bench, looked at from outside.

use std::fs::File;
use std::os::fd::{AsFd as _, OwnedFd};
use std::os::unix::process::CommandExt as _;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use kit::lockstep::TurnPage;
use rustix::event::{PollFd, PollFlags};
use rustix::process::{Pid, PidfdFlags, Signal};
use serde_json::Value as Json;

use super::probe::{self, Member};
use super::{BenchError, Deadline, Options};
use crate::descriptors;
use crate::mission::annex::Annex;

/// Time that a run has to end in order when it is told to.
const END_WITHIN: Duration = Duration::from_secs(8);

/// A running `protean run`; ended when dropped.
#[derive(Debug)]
pub struct Session {
    child: Child,
    pidfd: OwnedFd,
    folder: Annex,
    begun: Instant,
    deadline: Deadline,
}

impl Session {
    /// Starts `protean run SCENARIO` with these further arguments; its log goes to a temporary
    /// folder.
    pub fn start(
        scenario: &str,
        arguments: &[String],
        deadline: Deadline,
    ) -> Result<Self, BenchError> {
        let folder = Annex::for_files()?;
        let file = |name: &str| {
            File::create(folder.path().join(name))
                .map_err(BenchError::system("cannot write a temporary file"))
        };
        let (output, errors) = (file("report.json")?, file("errors.txt")?);
        let this = crate::program::this().map_err(BenchError::system("cannot find myself"))?;
        let begun = Instant::now();
        let mut command = Command::new(this);
        command
            .args(["run", scenario, "--json", "--quiet", "--force", "--out"])
            .arg(folder.path().join("run.mcap"))
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(output)
            .stderr(errors)
            // Ctrl-C in a terminal is for the bench, which then ends the run.
            .process_group(0);
        descriptors::leave_behind(&mut command);
        let mut child = command
            .spawn()
            .map_err(BenchError::system("cannot start a run"))?;
        let pidfd = rustix::process::pidfd_open(Pid::from_child(&child), PidfdFlags::empty());
        let pidfd = match pidfd {
            Ok(pidfd) => pidfd,
            Err(error) => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(BenchError::system("cannot watch a run")(error.into()));
            }
        };
        Ok(Self {
            child,
            pidfd,
            folder,
            begun,
            deadline,
        })
    }

    /// Process id of the run's orchestrator.
    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Time since the run was started.
    pub fn age(&self) -> Duration {
        self.begun.elapsed()
    }

    /// Sleeps for `time` or until the run has ended; whether it has.
    pub fn ended_within(&self, time: Duration) -> bool {
        let timeout = rustix::thread::Timespec {
            tv_sec: i64::try_from(time.as_secs()).unwrap_or(i64::MAX),
            tv_nsec: i64::from(time.subsec_nanos()),
        };
        let mut fds = [PollFd::from_borrowed_fd(self.pidfd.as_fd(), PollFlags::IN)];
        rustix::event::poll(&mut fds, Some(&timeout)).is_ok_and(|ready| ready > 0)
    }

    /// Waits for the end, calling `look` every `beat`; returns what `protean run --json` printed.
    pub fn finish(
        mut self,
        options: &Options,
        beat: Duration,
        mut look: impl FnMut(&Self),
    ) -> Result<Json, BenchError> {
        while !self.ended_within(beat) {
            options.check()?;
            self.deadline.check("a run")?;
            look(&self);
        }
        let status = self
            .child
            .wait()
            .map_err(BenchError::system("cannot wait for a run"))?;
        let read =
            |name: &str| std::fs::read_to_string(self.folder.path().join(name)).unwrap_or_default();
        let failed = |how: String| BenchError::Process {
            process: "protean run".into(),
            how,
        };
        if !status.success() {
            return Err(failed(format!("{status}: {}", read("errors.txt").trim())));
        }
        serde_json::from_str(&read("report.json")).map_err(|e| failed(format!("its JSON: {e}")))
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        if matches!(self.child.try_wait(), Ok(Some(_))) {
            return;
        }
        let _ = rustix::process::pidfd_send_signal(&self.pidfd, Signal::TERM);
        if !self.ended_within(END_WITHIN) {
            let _ = self.child.kill();
        }
        let _ = self.child.wait();
    }
}

/// A run as seen from outside: its processes and its turn page.
#[derive(Debug)]
pub struct View {
    /// The processes, the orchestrator not among them.
    pub members: Vec<Member>,
    /// The turn page.
    pub page: TurnPage,
}

impl View {
    /// Looks for the run of this orchestrator; `None` while it has no processes or page yet.
    pub fn find(orchestrator: u32) -> Option<Self> {
        let members = probe::members(orchestrator);
        let root = &members.first()?.root;
        let prefix = format!("protean_{}_", root.file_name()?.to_string_lossy());
        let page = TurnPage::open(&prefix).ok()?;
        // Not all of them have been started, or executed, yet.
        (members.len() == page.processes()).then_some(Self { members, page })
    }
}

/// A number in a run's JSON; 0 if it is missing.
pub fn number(report: &Json, pointer: &str) -> f64 {
    report
        .pointer(pointer)
        .and_then(Json::as_f64)
        .unwrap_or(0.0)
}
