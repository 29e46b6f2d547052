//! One process of a run: starting, observing and killing it.

use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::os::fd::{AsFd as _, BorrowedFd};
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::ExitStatus;
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};

use platform::output_lines::{OutputLine, OutputLines};
use platform::program;
use platform::spawn::{self, Child, Program};
use runtime::config::CONFIG_VARIABLE;
use rustix::event::{PollFd, PollFlags, Timespec};
use rustix::pipe::{PipeFlags, pipe_with};
use rustix::process::{Signal, WaitId, WaitIdOptions, WaitOptions};

use super::orphans;

/// Maximum time for the system to end a killed process.
const KILL_TIMEOUT: Duration = Duration::from_secs(5);

/// Word of a command that stands for the running program, whatever `PATH` holds: `command = ["protean", "planner", …]`.
pub(crate) const OWN_NAME: &str = "protean";

/// Returns the path of the program that the first word of a command means.
pub(crate) fn program_file(word: &str) -> &str {
    if word == OWN_NAME {
        program::THIS
    } else {
        word
    }
}

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
    /// An external program, or this one as `protean`. The environment variable `PROTEAN_CONFIG` contains the path of its configuration.
    Command {
        /// Its path and arguments.
        words: Vec<String>,
        /// Its working directory.
        folder: String,
    },
}

/// One process of the run.
#[derive(Debug)]
pub struct RunningProcess {
    /// Name in the scenario.
    pub name: String,
    /// Index in the run.
    pub slot: usize,
    /// Its program, in words.
    pub(super) program: String,
    /// The child process. It detects the end of the orchestrator by the end of its stdin.
    child: Child,
    /// Configuration of an external program, which identifies the processes that it has started.
    external: Option<PathBuf>,
    output: OutputLines,
    /// Exit status, once the process has ended.
    pub exit: Option<ExitStatus>,
}

impl RunningProcess {
    /// Starts a process of the run with the configuration at `config`.
    ///
    /// With `echo`, its output appears on this program's stderr, each line after the name of the process. `lines`
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
        lines: Option<SyncSender<OutputLine>>,
    ) -> Result<Self, ChildError> {
        let failed = |what: &'static str| {
            let name = name.to_owned();
            move |source: std::io::Error| ChildError { name, what, source }
        };
        let own_name = OsString::from(format!("protean:{name}"));
        let (file, arguments, folder) = match executable {
            Executable::Kind(kind) => {
                let words = ["process", kind, "--config"].map(OsStr::new);
                let arguments = [&*own_name].into_iter().chain(words);
                let arguments = arguments.chain([config.as_os_str()]).collect();
                (OsStr::new(program::THIS), arguments, None)
            }
            Executable::Command { words, folder } => {
                orphans::become_subreaper().map_err(failed("cannot be observed"))?;
                let arguments: Vec<&OsStr> = words.iter().map(OsStr::new).collect();
                let word = words.first().map_or("", String::as_str);
                (
                    OsStr::new(program_file(word)),
                    arguments,
                    Some(OsStr::new(folder)),
                )
            }
        };
        let program = Program {
            file,
            arguments,
            variable: (CONFIG_VARIABLE, config.as_os_str()),
            folder,
        };
        let (reading, writing) =
            pipe_with(PipeFlags::CLOEXEC).map_err(|e| failed("cannot be observed")(e.into()))?;
        // Before the process exists: without a reader it would block when the pipe is full.
        let output = OutputLines::read(File::from(reading), name, slot, echo, lines)
            .map_err(failed("cannot be observed"))?;
        let child = spawn::spawn(&program, &writing).map_err(failed("cannot be started"))?;
        Ok(Self {
            name: name.to_owned(),
            slot,
            program: describe(executable),
            child,
            external: matches!(executable, Executable::Command { .. }).then(|| config.to_owned()),
            output,
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
        let pid = self.child.pid;
        let _ = rustix::process::kill_process_group(pid, Signal::KILL);
        match rustix::process::waitpid(Some(pid), WaitOptions::NOHANG) {
            Ok(Some((_, status))) => {
                self.exit = Some(ExitStatus::from_raw(status.as_raw()));
                if let Some(config) = &self.external {
                    // Includes processes outside the group.
                    if let Err(error) = orphans::kill_with_config(config) {
                        tracing::warn!("process {}: its own may remain: {error}", self.name);
                    }
                }
                self.output.finish();
                true
            }
            _ => false,
        }
    }

    /// Returns `true` if it has ended and is not reaped yet.
    fn has_ended(&self) -> bool {
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        // Unknown means alive: the next check asks again.
        rustix::process::waitid(WaitId::PidFd(self.child.pidfd.as_fd()), options)
            .is_ok_and(|status| status.is_some())
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

    /// Returns its process id.
    pub(super) fn pid(&self) -> i32 {
        self.child.pid.as_raw_nonzero().get()
    }

    /// Returns the last lines of its output.
    pub fn last_lines(&self) -> Vec<String> {
        self.output.last()
    }

    /// Returns the reason why a process that has ended executed no program. Returns it once.
    pub(super) fn start_error(&mut self) -> Option<std::io::Error> {
        self.child.start_error()
    }

    /// Returns a descriptor that is readable when the process has ended; `None` once the end is recorded.
    pub(super) fn end(&self) -> Option<BorrowedFd<'_>> {
        self.exit.is_none().then(|| self.child.pidfd.as_fd())
    }

    /// Sends the process a signal, unless its end is recorded.
    pub(super) fn signal(&self, signal: Signal) {
        if self.exit.is_some() {
            return;
        }
        let _ = rustix::process::pidfd_send_signal(&self.child.pidfd, signal);
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

/// Describes a program in words: its path, and the folder that a relative one refers to.
fn describe(executable: &Executable) -> String {
    match executable {
        Executable::Kind(kind) => format!("`process {kind}` of this program"),
        Executable::Command { words, folder } => {
            let file = words.first().map_or("", String::as_str);
            if file == OWN_NAME {
                return "this program".to_owned();
            }
            if !file.contains('/') {
                return format!("`{file}` in PATH");
            }
            Path::new(folder).join(file).display().to_string()
        }
    }
}

/// Describes an exit status in words.
pub(super) fn describe_exit(status: ExitStatus) -> String {
    match (status.code(), status.signal()) {
        (Some(code), _) => format!("ended with exit code {code}"),
        (None, Some(signal)) => format!("was ended by signal {signal}"),
        (None, None) => "ended".into(),
    }
}
