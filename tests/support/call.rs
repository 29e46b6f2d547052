//! Calling the real program, with a limit on its time.

use std::io::Read;
use std::os::fd::OwnedFd;
use std::os::unix::process::CommandExt as _;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags};
use rustix::process::{Pid, PidfdFlags, Signal};
use serde_json::Value as Json;

use super::sandbox::{Sandbox, signal};

/// Longest that any call may take.
const LIMIT: Duration = Duration::from_secs(900);

/// A hang timeout for slow machines: without optimisation, a first plan may take longer than the default of
/// ten seconds.
pub const PATIENCE: &str = "run.hang_timeout_s=200";

/// The program about to be called.
pub struct Call<'a> {
    sandbox: &'a Sandbox,
    command: Command,
    one_core: bool,
}

impl<'a> Call<'a> {
    pub(super) fn new(sandbox: &'a Sandbox, program: &Path) -> Self {
        let mut command = Command::new(program);
        command
            .current_dir(sandbox.path())
            .env("XDG_RUNTIME_DIR", sandbox.runtime_dir())
            .env_remove("PROTEAN_LOG")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .process_group(0);
        Self {
            sandbox,
            command,
            one_core: false,
        }
    }

    pub fn arg(mut self, word: impl AsRef<std::ffi::OsStr>) -> Self {
        self.command.arg(word);
        self
    }

    pub fn args<'w>(mut self, words: impl IntoIterator<Item = &'w str>) -> Self {
        self.command.args(words);
        self
    }

    /// `--set key=value`.
    pub fn set(self, change: &str) -> Self {
        self.arg("--set").arg(change)
    }

    /// With another runtime directory than the sandbox's.
    pub fn runtime_dir(mut self, path: &Path) -> Self {
        self.command.env("XDG_RUNTIME_DIR", path);
        self
    }

    /// With the folder of a program before all others in `PATH`.
    pub fn first_in_path(mut self, program: &Path) -> Self {
        let folder = program.parent().unwrap().display();
        let path = std::env::var("PATH").unwrap_or_default();
        self.command.env("PATH", format!("{folder}:{path}"));
        self
    }

    /// Limits the address space (KiB): larger allocations fail, and the program reports it.
    pub fn with_memory(self, kib: &str) -> Self {
        self.through("sh", &["-c", "ulimit -v \"$0\" && exec \"$@\"", kib])
    }

    /// Limits the number of open files: the soft limit (`-S`) or the hard limit (`-H`).
    pub fn with_open_files(self, kind: &str, count: &str) -> Self {
        let script = "ulimit -S -n \"$1\" && ulimit \"$0\" -n \"$1\" && shift && exec \"$@\"";
        self.through("sh", &["-c", script, kind, count])
    }

    /// With at most this much time of the processor (s), then it is killed.
    pub fn within_seconds(self, seconds: &str) -> Self {
        self.through("sh", &["-c", "ulimit -t \"$0\" && exec \"$@\"", seconds])
    }

    /// Started by another program, whose last arguments are the call.
    pub fn through(mut self, program: &str, words: &[&str]) -> Self {
        let mut command = Command::new(program);
        command
            .args(words)
            .arg(self.command.get_program())
            .args(self.command.get_args())
            .current_dir(self.sandbox.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .process_group(0);
        for (name, value) in self.command.get_envs() {
            match value {
                Some(value) => command.env(name, value),
                None => command.env_remove(name),
            };
        }
        self.command = command;
        self
    }

    /// As under `taskset -c 0`: the first processor that this test may use, and no other.
    pub fn on_one_core(mut self) -> Self {
        self.one_core = true;
        self
    }

    /// Runs it to its end.
    #[track_caller]
    pub fn run(self) -> Outcome {
        self.start().finish()
    }

    /// Runs it to its end, which must be a good one, with `--json`; returns the object.
    #[track_caller]
    pub fn json(self) -> Json {
        let is_run = self
            .command
            .get_args()
            .next()
            .is_some_and(|word| word == "run");
        let patient = if is_run { self.set(PATIENCE) } else { self };
        let outcome = patient.arg("--json").run();
        assert_eq!(outcome.code, Some(0), "{outcome}");
        outcome.json()
    }

    /// Starts it.
    pub fn start(mut self) -> Running<'a> {
        let mut child = if self.one_core {
            // A child inherits the processors of the thread that starts it.
            std::thread::scope(|scope| {
                let command = &mut self.command;
                scope
                    .spawn(move || {
                        let all = rustix::thread::sched_getaffinity(None).unwrap();
                        let first = (0..rustix::thread::CpuSet::MAX_CPU)
                            .find(|&cpu| all.is_set(cpu))
                            .unwrap();
                        let mut one = rustix::thread::CpuSet::new();
                        one.set(first);
                        rustix::thread::sched_setaffinity(None, &one).unwrap();
                        command.spawn().unwrap()
                    })
                    .join()
                    .unwrap()
            })
        } else {
            self.command.spawn().unwrap()
        };
        let pidfd =
            rustix::process::pidfd_open(Pid::from_child(&child), PidfdFlags::empty()).unwrap();
        let stdout = gather(child.stdout.take().unwrap());
        let stderr = gather(child.stderr.take().unwrap());
        Running {
            sandbox: self.sandbox,
            child,
            pidfd,
            output: Some((stdout, stderr)),
            deadline: Instant::now() + LIMIT,
        }
    }
}

fn gather(mut pipe: impl Read + Send + 'static) -> JoinHandle<String> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        let _ = pipe.read_to_end(&mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// The program at work; killed with everything it started if the test ends first.
pub struct Running<'a> {
    sandbox: &'a Sandbox,
    child: Child,
    pidfd: OwnedFd,
    output: Option<(JoinHandle<String>, JoinHandle<String>)>,
    deadline: Instant,
}

impl Running<'_> {
    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    pub fn signal(&self, signal: Signal) {
        rustix::process::pidfd_send_signal(&self.pidfd, signal).unwrap();
    }

    /// Returns `true` while it runs.
    pub fn is_alive(&mut self) -> bool {
        self.child.try_wait().unwrap().is_none()
    }

    /// Waits for its end.
    ///
    /// # Panics
    /// If that does not come in time; everything in the sandbox is killed then.
    #[track_caller]
    pub fn finish(mut self) -> Outcome {
        let ended = wait(&self.pidfd, self.deadline);
        if !ended {
            self.sandbox.kill_all();
        }
        let status = self.child.wait().unwrap();
        let (stdout, stderr) = self.output.take().unwrap();
        let outcome = Outcome {
            code: status.code(),
            status,
            stdout: stdout.join().unwrap(),
            stderr: stderr.join().unwrap(),
        };
        assert!(ended, "no end within {LIMIT:?}\n{outcome}");
        outcome
    }
}

impl Drop for Running<'_> {
    fn drop(&mut self) {
        if self.output.is_some() {
            signal(self.child.id(), Signal::KILL);
            let _ = self.child.wait();
            self.sandbox.kill_all();
        }
    }
}

/// Waits for the end of a process; `false` if the deadline passes first.
pub fn wait(pidfd: &OwnedFd, deadline: Instant) -> bool {
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        let timeout = rustix::thread::Timespec {
            tv_sec: left.as_secs() as i64,
            tv_nsec: i64::from(left.subsec_nanos()),
        };
        let mut fds = [PollFd::new(pidfd, PollFlags::IN)];
        match rustix::event::poll(&mut fds, Some(&timeout)) {
            Ok(0) => return false,
            Ok(_) => return true,
            Err(_) => {}
        }
    }
}

/// The result of a call.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Exit code; none if a signal ended it.
    pub code: Option<i32>,
    pub status: ExitStatus,
    pub stdout: String,
    pub stderr: String,
}

impl Outcome {
    /// The JSON object on stdout, and nothing else.
    #[track_caller]
    pub fn json(&self) -> Json {
        match serde_json::from_str(&self.stdout) {
            Ok(json) => json,
            Err(e) => panic!("{e}\n{self}"),
        }
    }

    /// Asserts the exit code, that stdout is empty, and that stderr contains these texts in order.
    #[track_caller]
    pub fn refused(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, Some(code), "{self}");
        assert_eq!(self.stdout, "", "{self}");
        let mut rest = &self.stderr[..];
        for word in words {
            match rest.find(word) {
                Some(at) => rest = &rest[at + word.len()..],
                None => panic!("{word:?} is missing, or not in this order:\n{self}"),
            }
        }
    }
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{}\n--- stdout\n{}\n--- stderr\n{}",
            self.status, self.stdout, self.stderr
        )
    }
}
