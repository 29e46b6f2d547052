//! The processes of a run: started, watched, ended.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read as _};
use std::os::fd::{AsFd as _, OwnedFd};
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, SyncSender};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use platform::eprintln;
use platform::{descriptors, proc, program};
use rustix::event::{PollFd, PollFlags};
use rustix::process::{Pid, PidfdFlags, Signal, WaitId, WaitIdOptions};

use super::orphans;

/// Environment variable that tells every process of a run where its configuration lies.
pub const CONFIG_VARIABLE: &str = "PROTEAN_CONFIG";

/// Lines of its stderr that are kept of every process, to be shown if it fails.
const KEPT_LINES: usize = 20;

/// Time for the last lines of a process that has ended to arrive.
const LAST_WORDS: Duration = Duration::from_millis(500);
/// Time for the system to end a process that was killed.
const KILL_WITHIN: Duration = Duration::from_secs(5);
/// Most bytes of a line that are kept, its end included.
const LINE_BYTES: u64 = 2048;
/// Most bytes of a line as it is handed on: what is not UTF-8 takes three bytes for one, and a mark says that
/// something was left out.
pub const TEXT_BYTES: usize = LINE_BYTES as usize * 3 + 64;

/// A line that a process wrote to stderr.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// Index of the process in the run.
    pub slot: usize,
    /// What it wrote, without the end of the line.
    pub text: String,
}

/// The next line; `None` at the end. Of one that is longer than [`LINE_BYTES`] the beginning is kept, and the
/// rest, however long, is read and left out. Bytes that are not UTF-8 are replaced.
fn next_line(from: &mut impl BufRead) -> Option<String> {
    let mut line = Vec::new();
    // A pipe that cannot be read is at its end.
    let length = from.take(LINE_BYTES).read_until(b'\n', &mut line).ok()?;
    if length == 0 {
        return None;
    }
    let is_whole = line.pop_if(|byte| *byte == b'\n').is_some();
    let mut text = String::from_utf8_lossy(&line).into_owned();
    if !is_whole && from.skip_until(b'\n').ok()? > 0 {
        text.push_str(" …");
    }
    Some(text)
}

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
    child: Child,
    pidfd: OwnedFd,
    /// Configuration of an external program, by which processes that it has started are found.
    external: Option<PathBuf>,
    /// The end of this pipe is what tells the process that the orchestrator is gone.
    stdin: Option<ChildStdin>,
    lines: Arc<Mutex<VecDeque<String>>>,
    /// Ends when everybody who could write to its stderr is gone.
    reader: Option<mpsc::Receiver<()>>,
    /// How it ended.
    pub exit: Option<ExitStatus>,
}

impl RunningProcess {
    /// Starts a process of the run.
    ///
    /// `echo` lets its stderr through to ours, each line with the process's name before it.
    ///
    /// # Errors
    /// [`ChildError`] names the process and the reason.
    pub fn start(
        name: &str,
        slot: usize,
        executable: &Executable,
        config: &Path,
        echo: bool,
    ) -> Result<Self, ChildError> {
        Self::start_heard(name, slot, executable, config, echo, None)
    }

    /// As [`RunningProcess::start`]; every line of its stderr goes to `ear`, as long as that has
    /// room: who writes without end must not stop anybody.
    ///
    /// # Errors
    /// As [`RunningProcess::start`].
    pub fn start_heard(
        name: &str,
        slot: usize,
        executable: &Executable,
        config: &Path,
        echo: bool,
        ear: Option<SyncSender<Line>>,
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
        descriptors::leave_behind(&mut command);
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
        let lines = Arc::new(Mutex::new(VecDeque::new()));
        let reader = child.stderr.take().and_then(|stderr| {
            let (lines, name) = (Arc::clone(&lines), name.to_owned());
            let (reading, reader) = mpsc::channel();
            std::thread::Builder::new()
                .name(format!("stderr-{slot}"))
                .spawn(move || {
                    let _reading = reading;
                    let mut stderr = BufReader::new(stderr);
                    while let Some(line) = next_line(&mut stderr) {
                        if echo {
                            eprintln!("[{name}] {line}");
                        }
                        if let Some(ear) = &ear {
                            let text = line.clone();
                            let _ = ear.try_send(Line { slot, text });
                        }
                        if let Ok(mut kept) = lines.lock() {
                            if kept.len() == KEPT_LINES {
                                kept.pop_front();
                            }
                            kept.push_back(line);
                        }
                    }
                })
                .ok()
                .map(|_| reader)
        });
        let stdin = child.stdin.take();
        Ok(Self {
            name: name.to_owned(),
            slot,
            child,
            pidfd,
            external: matches!(executable, Executable::Command(_)).then(|| config.to_owned()),
            stdin,
            lines,
            reader,
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
                // What it wrote last is worth waiting for: its end of the pipe is closed now. One
                // that it has handed to somebody outside its group may stay open.
                if let Some(reader) = self.reader.take() {
                    let _ = reader.recv_timeout(LAST_WORDS);
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
            sleep_until_exit(std::slice::from_ref(self), None, Duration::from_millis(50));
        }
        false
    }

    /// Whether it stands still by SIGSTOP or under a debugger.
    pub fn is_stopped(&self) -> bool {
        proc::stat(self.child.id().cast_signed()).is_some_and(|stat| stat.is_stopped())
    }

    /// The last lines it wrote to stderr.
    pub fn last_words(&self) -> Vec<String> {
        self.lines
            .lock()
            .map(|lines| lines.iter().cloned().collect())
            .unwrap_or_default()
    }

    fn signal(&self, signal: Signal) {
        if self.exit.is_some() {
            return;
        }
        let _ = rustix::process::pidfd_send_signal(&self.pidfd, signal);
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

/// Sleeps until one of the processes has ended or `wake` is readable, at most for `timeout`.
pub fn sleep_until_exit(processes: &[RunningProcess], wake: Option<&OwnedFd>, timeout: Duration) {
    let mut fds: Vec<PollFd<'_>> = processes
        .iter()
        .filter(|p| p.exit.is_none())
        .map(|p| PollFd::from_borrowed_fd(p.pidfd.as_fd(), PollFlags::IN))
        .collect();
    fds.extend(wake.map(|fd| PollFd::from_borrowed_fd(fd.as_fd(), PollFlags::IN)));
    let timeout = rustix::thread::Timespec {
        tv_sec: i64::try_from(timeout.as_secs()).unwrap_or(i64::MAX),
        tv_nsec: i64::from(timeout.subsec_nanos()),
    };
    // Woken by a signal or failed: the caller looks anyway.
    let _ = rustix::event::poll(&mut fds, Some(&timeout));
}

/// Ends all processes: waits `patience` for them to end by themselves, then asks with SIGTERM, then
/// kills. Returns the names of those that had to be killed.
pub fn end_all(processes: &mut [RunningProcess], patience: Duration) -> Vec<String> {
    let mut killed = Vec::new();
    for (signal, time) in [
        (None, patience),
        (Some(Signal::TERM), Duration::from_secs(1)),
        (Some(Signal::KILL), Duration::from_secs(3)),
    ] {
        let deadline = Instant::now() + time;
        for process in processes.iter_mut() {
            process.check_exit();
            if let Some(signal) = signal
                && process.exit.is_none()
            {
                process.signal(signal);
                if signal == Signal::KILL {
                    killed.push(process.name.clone());
                }
            }
        }
        loop {
            for process in processes.iter_mut() {
                process.check_exit();
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() || processes.iter().all(|p| p.exit.is_some()) {
                break;
            }
            sleep_until_exit(processes, None, left);
        }
    }
    for process in processes {
        // Closed last: while it is open the process knows that somebody is there.
        process.stdin.take();
    }
    killed
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn lines(mut text: &[u8]) -> Vec<String> {
        std::iter::from_fn(|| next_line(&mut text)).collect()
    }

    #[test]
    fn lines_are_what_stands_between_their_ends() {
        assert_eq!(lines(b""), [] as [&str; 0]);
        assert_eq!(lines(b"\n"), [""]);
        assert_eq!(lines(b"one\n\ntwo"), ["one", "", "two"]);
        assert_eq!(lines(b"caf\xc3\xa9 \xff\xfe\n"), ["café \u{fffd}\u{fffd}"]);
    }

    #[test]
    fn of_a_long_line_the_beginning_is_kept() {
        let most = LINE_BYTES as usize;
        let mut text = vec![b'x'; most - 1];
        text.push(b'\n');
        assert_eq!(lines(&text), ["x".repeat(most - 1)]);
        text.pop();
        text.push(b'y');
        text.extend(vec![0xff; 10 << 20]);
        text.extend(b"\nnext\n");
        let cut = format!("{}y …", "x".repeat(most - 1));
        assert_eq!(lines(&text), [&*cut, "next"]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]
        #[test]
        fn every_line_fits_and_none_is_lost(
            text in prop::collection::vec(
                prop_oneof![8 => any::<u8>(), 1 => Just(b'\n')], 0..3 * LINE_BYTES as usize
            ),
        ) {
            let found = lines(&text);
            let expected = text.split_inclusive(|&byte| byte == b'\n').count();
            prop_assert_eq!(found.len(), expected);
            prop_assert!(found.iter().all(|line| line.len() <= TEXT_BYTES));
        }
    }
}
