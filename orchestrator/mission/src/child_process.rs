//! One process of a run: started, watched, killed.

use std::os::fd::{AsFd as _, BorrowedFd, OwnedFd};
use std::os::unix::process::{CommandExt as _, ExitStatusExt as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};

use platform::{descriptors, proc, program};
use rustix::event::{PollFd, PollFlags, Timespec};
use rustix::process::{Pid, PidfdFlags, Signal, WaitId, WaitIdOptions};

use super::orphans::{self, CONFIG_VARIABLE};
use super::stderr_lines::{StderrLine, StderrLines};

/// Time for the system to end a process that was killed.
const KILL_WITHIN: Duration = Duration::from_secs(5);

/// Why a process cannot be started or watched.
#[derive(Debug, thiserror::Error)]
#[error("process {name}: {what}: {source}")]
pub struct ChildError {
    /// Name of the process.
    pub name: String,
    /// What was attempted.
    pub what: &'static str,
    /// What the system said.
    pub source: std::io::Error,
}

impl ChildError {
    /// What follows the name of the process.
    pub(super) fn of_it(&self) -> String {
        format!("{}: {}", self.what, self.source)
    }
}

/// How a process is executed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Executable {
    /// One of our own kinds: this program executes itself.
    Kind(String),
    /// An external program, not of ours, with its arguments; the configuration's path is in the
    /// environment variable `PROTEAN_CONFIG`.
    Command(Vec<String>),
}

/// One process of the run.
#[derive(Debug)]
pub struct RunningProcess {
    /// Name in the scenario.
    pub name: String,
    /// Index in the run.
    pub slot: usize,
    /// The end of its stdin is what tells the process that the orchestrator is gone.
    child: Child,
    pidfd: OwnedFd,
    /// Configuration of an external program, by which processes that it has started are found.
    external: Option<PathBuf>,
    stderr: Option<StderrLines>,
    /// How it ended.
    pub exit: Option<ExitStatus>,
}

impl RunningProcess {
    /// Starts a process of the run, whose configuration lies at `config`.
    ///
    /// `echo` shows its stderr on ours, each line with the name of the process before it; `lines` gets every line
    /// as long as it has room.
    ///
    /// # Errors
    /// [`ChildError`] names the process and the reason.
    pub fn start(
        name: &str,
        slot: usize,
        executable: &Executable,
        config: &Path,
        echo: bool,
        lines: Option<SyncSender<StderrLine>>,
    ) -> Result<Self, ChildError> {
        let failed = |what: &'static str| {
            let name = name.to_owned();
            move |source: std::io::Error| ChildError { name, what, source }
        };
        let mut command = match executable {
            Executable::Kind(kind) => {
                let mut command = Command::new(program::THIS);
                command.arg0(format!("protean:{name}"));
                command.args(["process", kind, "--config"]).arg(config);
                command
            }
            Executable::Command(words) => {
                orphans::adopt().map_err(failed("cannot be watched"))?;
                let mut words = words.iter();
                let mut command = Command::new(words.next().map_or("", |program| program));
                command.args(words);
                command
            }
        };
        command
            .env(CONFIG_VARIABLE, config)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            // Ctrl-C in a terminal is for the orchestrator, which then ends the run in order.
            .process_group(0);
        descriptors::inherit_only_standard_streams(&mut command);
        die_with_this_thread(&mut command);
        let mut child = command.spawn().map_err(failed("cannot be started"))?;
        let pid = Pid::from_child(&child);
        let pidfd = match rustix::process::pidfd_open(pid, PidfdFlags::empty()) {
            Ok(pidfd) => pidfd,
            Err(error) => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(failed("cannot be watched")(error.into()));
            }
        };
        let stderr = child.stderr.take();
        let stderr = stderr.map(|stderr| StderrLines::read(stderr, name, slot, echo, lines));
        Ok(Self {
            name: name.to_owned(),
            slot,
            child,
            pidfd,
            external: matches!(executable, Executable::Command(_)).then(|| config.to_owned()),
            stderr,
            exit: None,
        })
    }

    /// Takes note if it has ended; true the first time.
    pub fn check_exit(&mut self) -> bool {
        if self.exit.is_some() {
            return false;
        }
        if !self.has_ended() {
            return false;
        }
        // Before it is reaped: until then nobody else can have its group. What it started and left
        // behind ends with it.
        let _ = rustix::process::kill_process_group(Pid::from_child(&self.child), Signal::KILL);
        match self.child.try_wait() {
            Ok(Some(status)) => {
                self.exit = Some(status);
                if let Some(config) = &self.external {
                    // Also what has left the group.
                    orphans::kill_with_config(config);
                }
                if let Some(stderr) = &mut self.stderr {
                    stderr.finish();
                }
                true
            }
            _ => false,
        }
    }

    /// Whether it has ended and waits to be reaped.
    fn has_ended(&self) -> bool {
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        match rustix::process::waitid(WaitId::PidFd(self.pidfd.as_fd()), options) {
            Ok(status) => status.is_some(),
            // Whatever that is, `try_wait` knows.
            Err(_) => true,
        }
    }

    /// Ends it at once, also when it is stopped; true if that was to be noted now (see
    /// [`RunningProcess::check_exit`]).
    pub fn kill(&mut self) -> bool {
        self.signal(Signal::KILL);
        let deadline = Instant::now() + KILL_WITHIN;
        while self.exit.is_none() && Instant::now() < deadline {
            if self.check_exit() {
                return true;
            }
            sleep_until_readable(self.end(), Duration::from_millis(50));
        }
        false
    }

    /// Whether it stands still by SIGSTOP or under a debugger.
    pub fn is_stopped(&self) -> bool {
        proc::stat(self.child.id().cast_signed()).is_some_and(|stat| stat.is_stopped())
    }

    /// The last lines it wrote to stderr.
    pub fn last_words(&self) -> Vec<String> {
        self.stderr
            .as_ref()
            .map(StderrLines::last)
            .unwrap_or_default()
    }

    /// Readable when it has ended; `None` once that is noted.
    pub(super) fn end(&self) -> Option<BorrowedFd<'_>> {
        self.exit.is_none().then(|| self.pidfd.as_fd())
    }

    /// Sends it a signal, unless its end is noted.
    pub(super) fn signal(&self, signal: Signal) {
        if self.exit.is_some() {
            return;
        }
        let _ = rustix::process::pidfd_send_signal(&self.pidfd, signal);
    }
}

/// Sleeps until one of these is readable, at most for `timeout`.
pub(super) fn sleep_until_readable<'a>(
    fds: impl IntoIterator<Item = BorrowedFd<'a>>,
    timeout: Duration,
) {
    let fds = fds.into_iter();
    let mut fds: Vec<_> = fds
        .map(|fd| PollFd::from_borrowed_fd(fd, PollFlags::IN))
        .collect();
    let timeout = Timespec::try_from(timeout).unwrap_or_default();
    // Woken by a signal or failed: the caller looks anyway.
    let _ = rustix::event::poll(&mut fds, Some(&timeout));
}

/// How a process ended, in words.
pub fn exit_words(status: ExitStatus) -> String {
    match (status.code(), status.signal()) {
        (Some(code), _) => format!("ended with exit code {code}"),
        (None, Some(signal)) => format!("was ended by signal {signal}"),
        (None, None) => "ended".into(),
    }
}

/// Has a process killed, also when it is stopped, as soon as the thread that starts it ends, however that goes.
#[expect(
    unsafe_code,
    reason = "the child must ask for it between fork and exec"
)]
fn die_with_this_thread(command: &mut Command) {
    let parent = rustix::process::getpid();
    let ask = move || {
        rustix::process::set_parent_process_death_signal(Some(Signal::KILL))?;
        // The parent can have ended before that.
        if rustix::process::getppid() == Some(parent) {
            Ok(())
        } else {
            Err(std::io::Error::from(std::io::ErrorKind::BrokenPipe))
        }
    };
    // SAFETY: between fork and exec only two system calls are made, which are safe after a fork of
    // a program with threads: no lock is taken and no memory allocated (an error without a text
    // needs none).
    unsafe {
        command.pre_exec(ask);
    }
}
