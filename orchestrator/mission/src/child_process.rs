//! One process of a run: starting, observing and killing it.

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

/// Maximum time for the system to end a killed process.
const KILL_TIMEOUT: Duration = Duration::from_secs(5);

/// Error of starting or observing a process.
#[derive(Debug, thiserror::Error)]
#[error("process {name}: {what}: {source}")]
pub struct ChildError {
    /// Name of the process.
    pub name: String,
    /// Failed operation.
    pub what: &'static str,
    /// Error of the system.
    pub source: std::io::Error,
}

impl ChildError {
    /// Returns the message without the name of the process.
    pub(super) fn reason(&self) -> String {
        format!("{}: {}", self.what, self.source)
    }
}

/// Program that a process executes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Executable {
    /// One of Protean's own kinds: this program executes itself.
    Kind(String),
    /// An external program with its arguments. The environment variable `PROTEAN_CONFIG` contains the path of
    /// its configuration.
    Command(Vec<String>),
}

/// One process of the run.
#[derive(Debug)]
pub struct RunningProcess {
    /// Name in the scenario.
    pub name: String,
    /// Index in the run.
    pub slot: usize,
    /// The child process. It detects the end of the orchestrator by the end of its stdin.
    child: Child,
    pidfd: OwnedFd,
    /// Configuration of an external program, which identifies the processes that it has started.
    external: Option<PathBuf>,
    stderr: Option<StderrLines>,
    /// Exit status, once the process has ended.
    pub exit: Option<ExitStatus>,
}

impl RunningProcess {
    /// Starts a process of the run with the configuration at `config`.
    ///
    /// With `echo`, its stderr appears on this program's stderr, each line after the name of the process. `lines`
    /// receives every line while it has room.
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
                orphans::become_subreaper().map_err(failed("cannot be observed"))?;
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
            // In a terminal, Ctrl-C goes to the orchestrator only, which then ends the run in order.
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
                return Err(failed("cannot be observed")(error.into()));
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

    /// Records the end of the process. Returns `true` the first time after it has ended.
    pub fn check_exit(&mut self) -> bool {
        if self.exit.is_some() {
            return false;
        }
        if !self.has_ended() {
            return false;
        }
        // Must run before the process is reaped: until then no other process can have its group. The kill ends
        // all processes that it started.
        let _ = rustix::process::kill_process_group(Pid::from_child(&self.child), Signal::KILL);
        match self.child.try_wait() {
            Ok(Some(status)) => {
                self.exit = Some(status);
                if let Some(config) = &self.external {
                    // Includes processes outside the group.
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

    /// Returns `true` if it has ended and is not reaped yet.
    fn has_ended(&self) -> bool {
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        match rustix::process::waitid(WaitId::PidFd(self.pidfd.as_fd()), options) {
            Ok(status) => status.is_some(),
            // `try_wait` determines the actual state.
            Err(_) => true,
        }
    }

    /// Kills the process, also when it is stopped. Returns `true` if this call recorded its end (see
    /// [`RunningProcess::check_exit`]).
    pub fn kill(&mut self) -> bool {
        self.signal(Signal::KILL);
        let deadline = Instant::now() + KILL_TIMEOUT;
        while self.exit.is_none() && Instant::now() < deadline {
            if self.check_exit() {
                return true;
            }
            sleep_until_readable(self.end(), Duration::from_millis(50));
        }
        false
    }

    /// Returns `true` if SIGSTOP or a debugger has stopped it.
    pub fn is_stopped(&self) -> bool {
        proc::stat(self.child.id().cast_signed()).is_some_and(|stat| stat.is_stopped())
    }

    /// Returns the last lines that it wrote to stderr.
    pub fn last_lines(&self) -> Vec<String> {
        self.stderr
            .as_ref()
            .map(StderrLines::last)
            .unwrap_or_default()
    }

    /// Returns a descriptor that is readable when the process has ended; `None` once the end is recorded.
    pub(super) fn end(&self) -> Option<BorrowedFd<'_>> {
        self.exit.is_none().then(|| self.pidfd.as_fd())
    }

    /// Sends the process a signal, unless its end is recorded.
    pub(super) fn signal(&self, signal: Signal) {
        if self.exit.is_some() {
            return;
        }
        let _ = rustix::process::pidfd_send_signal(&self.pidfd, signal);
    }
}

/// Sleeps until one of these is readable, for `timeout` at most.
pub(super) fn sleep_until_readable<'a>(
    fds: impl IntoIterator<Item = BorrowedFd<'a>>,
    timeout: Duration,
) {
    let fds = fds.into_iter();
    let mut fds: Vec<_> = fds
        .map(|fd| PollFd::from_borrowed_fd(fd, PollFlags::IN))
        .collect();
    let timeout = Timespec::try_from(timeout).unwrap_or_default();
    // After a signal or an error, the caller checks the processes in any case.
    let _ = rustix::event::poll(&mut fds, Some(&timeout));
}

/// Describes an exit status in words.
pub fn describe_exit(status: ExitStatus) -> String {
    match (status.code(), status.signal()) {
        (Some(code), _) => format!("ended with exit code {code}"),
        (None, Some(signal)) => format!("was ended by signal {signal}"),
        (None, None) => "ended".into(),
    }
}

/// Makes the system kill a process, also a stopped one, as soon as the thread that started it ends for any reason.
#[expect(
    unsafe_code,
    reason = "the child must request it between fork and exec"
)]
fn die_with_this_thread(command: &mut Command) {
    let parent = rustix::process::getpid();
    let ask = move || {
        rustix::process::set_parent_process_death_signal(Some(Signal::KILL))?;
        // The parent may have ended before the request.
        if rustix::process::getppid() == Some(parent) {
            Ok(())
        } else {
            Err(std::io::Error::from(std::io::ErrorKind::BrokenPipe))
        }
    };
    // SAFETY: between fork and exec only two system calls are made. Both are safe after a fork of a program
    // with threads: they take no lock and allocate no memory (an error without a text needs none).
    unsafe {
        command.pre_exec(ask);
    }
}
