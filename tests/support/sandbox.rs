//! A place on this machine where runs of the real program cannot meet those of other tests.

use std::collections::BTreeSet;
use std::mem::MaybeUninit;
use std::os::fd::OwnedFd;
use std::os::unix::fs::DirBuilderExt as _;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use rustix::fs::inotify;
use rustix::process::{Pid, Signal};
use serde_json::Value as Json;

use super::call::Call;
use super::{PROTEAN, SOON, until};

/// A working directory and a runtime directory. Whatever runs leave behind there goes when the
/// sandbox is dropped, also by a failing test.
pub struct Sandbox {
    directory: tempfile::TempDir,
    /// Tells of every run directory that ever appeared.
    watch: OwnedFd,
    runs: Mutex<BTreeSet<String>>,
}

/// A process that lives in a sandbox.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Process {
    pub pid: u32,
    /// First word of its command line, e.g. `protean:pursuer_police_1`.
    pub name: String,
}

impl Sandbox {
    pub fn new() -> Self {
        // Short: names of Unix sockets below it are limited to 107 bytes.
        let directory = tempfile::Builder::new()
            .prefix("pt")
            .rand_bytes(6)
            .tempdir_in("/tmp")
            .unwrap();
        let base = directory.path().join("rt/protean");
        std::fs::DirBuilder::new()
            .recursive(true)
            .mode(0o700)
            .create(&base)
            .unwrap();
        let watch =
            inotify::init(inotify::CreateFlags::NONBLOCK | inotify::CreateFlags::CLOEXEC).unwrap();
        // A run's directory gets its name when it is complete.
        let wanted = inotify::WatchFlags::MOVED_TO | inotify::WatchFlags::ONLYDIR;
        inotify::add_watch(&watch, &base, wanted).unwrap();
        Self {
            directory,
            watch,
            runs: Mutex::default(),
        }
    }

    /// The working directory of what is called here.
    pub fn path(&self) -> &Path {
        self.directory.path()
    }

    pub fn runtime_dir(&self) -> PathBuf {
        self.path().join("rt")
    }

    /// Writes a file, with the folders above it.
    pub fn file(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, content).unwrap();
        path
    }

    /// Every file and folder below the working directory, but for the runtime directory.
    pub fn files(&self) -> Vec<PathBuf> {
        fn gather(folder: &Path, found: &mut Vec<PathBuf>) {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    gather(&path, found);
                }
                found.push(path);
            }
        }
        let mut found = Vec::new();
        gather(self.path(), &mut found);
        found.retain(|path| !path.starts_with(self.runtime_dir()));
        found.sort();
        found
    }

    /// A call of the program.
    pub fn protean<'a>(&'a self, words: impl IntoIterator<Item = &'a str>) -> Call<'a> {
        self.call(PROTEAN.as_ref()).args(words)
    }

    /// A call of another program with the same commands.
    pub fn call(&self, program: &Path) -> Call<'_> {
        Call::new(self, program)
    }

    /// A call that runs the missions of `small.toml` one after the other, with results in `out`.
    pub fn sweep_in_order(&self) -> Call<'_> {
        let words = ["sweep", "small.toml", "--out", "out", "--jobs", "1"];
        self.protean(words).arg("--quiet")
    }

    /// A short run of a scenario with the log `run.mcap`; its summary.
    pub fn record(&self, scenario: &str) -> Json {
        self.protean(["run", scenario, "--seed", "3", "--out", "run.mcap"])
            .set("rules.time_limit=1.5")
            .json()
    }

    /// A short run in real time, but faster, with a log.
    #[track_caller]
    pub fn record_in_real_time(&self, log: &str) {
        let words = ["run", "chase_exact", "--real-time", "50", "--quiet"];
        let run = self
            .protean(words)
            .arg("--out")
            .arg(log)
            .set("rules.time_limit=1")
            .run();
        // Whether a message is lost depends on the machine.
        assert!(run.code.is_some_and(|code| code != 1 && code != 2), "{run}");
    }

    /// Names of all runs so far.
    pub fn runs(&self) -> BTreeSet<String> {
        let mut runs = self.runs.lock().unwrap();
        let mut buffer = [MaybeUninit::uninit(); 4096];
        let mut reader = inotify::Reader::new(&self.watch, &mut buffer);
        while let Ok(event) = reader.next() {
            if let Some(name) = event.file_name()
                && event.events().contains(inotify::ReadFlags::ISDIR)
            {
                runs.insert(name.to_string_lossy().into_owned());
            }
        }
        runs.clone()
    }

    /// Waits for the first run, or the one that comes after those known; returns its name.
    pub fn next_run(&self, known: &BTreeSet<String>) -> String {
        until("a run directory", SOON, || {
            self.runs().difference(known).next().cloned()
        })
    }

    /// The prefix in shared memory of the run with this name.
    pub fn prefix(run: &str) -> String {
        format!("protean_{run}_")
    }

    /// Directories of runs that are there now.
    pub fn runtime_files(&self) -> Vec<PathBuf> {
        std::fs::read_dir(self.runtime_dir().join("protean"))
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .collect()
    }

    /// Files in shared memory of the runs of this sandbox.
    pub fn shared_memory(&self) -> Vec<PathBuf> {
        let runs = self.runs();
        std::fs::read_dir("/dev/shm")
            .unwrap()
            .flatten()
            .map(|entry| entry.path())
            .filter(|path| {
                let name = path.file_name().unwrap().to_string_lossy().into_owned();
                runs.iter().any(|run| name.contains(run))
            })
            .collect()
    }

    /// The processes that live in this sandbox.
    pub fn processes(&self) -> Vec<Process> {
        processes_with(&self.runtime_dir())
    }

    /// The process of a run with this name in the scenario, once it is there.
    pub fn process(&self, name: &str) -> Process {
        let wanted = format!("protean:{name}");
        until(&wanted, SOON, || {
            self.processes().into_iter().find(|p| p.name == wanted)
        })
    }

    /// Kills the program with this in its name, and waits for the program that takes its place.
    pub fn kill_and_await_successor(&self, part_of_name: &str) {
        let find = || {
            let mut all = self.processes().into_iter();
            all.find(|process| process.name.contains(part_of_name))
                .map(|process| process.pid)
        };
        let first = find().unwrap();
        signal(first, Signal::KILL);
        until("its successor", SOON, || find().filter(|&pid| pid != first));
    }

    /// Asserts that nothing but logs is left of the runs, of which there was at least one.
    #[track_caller]
    pub fn assert_nothing_left(&self) {
        assert!(!self.runs().is_empty(), "no run was ever started here");
        self.assert_empty();
    }

    /// Does the same where a run may not have started.
    #[track_caller]
    pub fn assert_empty(&self) {
        assert_eq!(self.processes(), [], "processes");
        assert_eq!(self.runtime_files(), [] as [PathBuf; 0], "runtime files");
        assert_eq!(self.shared_memory(), [] as [PathBuf; 0], "shared memory");
    }

    /// Kills every process that lives in this sandbox.
    pub fn kill_all(&self) {
        for process in self.processes() {
            signal(process.pid, Signal::KILL);
        }
    }
}

impl Drop for Sandbox {
    fn drop(&mut self) {
        self.kill_all();
        for path in self.shared_memory() {
            let _ = std::fs::remove_file(path);
        }
    }
}

/// The processes that have this runtime directory.
pub fn processes_with(runtime_dir: &Path) -> Vec<Process> {
    let wanted = format!("XDG_RUNTIME_DIR={}\0", runtime_dir.display()).into_bytes();
    let mut found: Vec<Process> = std::fs::read_dir("/proc")
        .unwrap()
        .flatten()
        .filter_map(|entry| {
            let pid: u32 = entry.file_name().to_str()?.parse().ok()?;
            let environment = std::fs::read(entry.path().join("environ")).ok()?;
            if environment.is_empty() {
                // It is a thread of the kernel, or has ended, or is about to: its files are closed, and its locks
                // released, after its memory is given back.
                until("the end of a process", SOON, || {
                    (!is_exiting(&entry.path())).then_some(())
                });
            }
            environment
                .windows(wanted.len())
                .any(|part| part == wanted)
                .then_some(())?;
            let line = std::fs::read(entry.path().join("cmdline")).ok()?;
            let word = line.split(|&b| b == 0).next()?;
            let name = String::from_utf8_lossy(word).into_owned();
            Some(Process { pid, name })
        })
        .collect();
    found.sort();
    found
}

/// Returns `true` if a thread of the process in this directory of `/proc` has begun to exit, and has not ended.
fn is_exiting(process: &Path) -> bool {
    /// `PF_EXITING` of the kernel's `sched.h`.
    const EXITING: u32 = 4;
    let Ok(threads) = std::fs::read_dir(process.join("task")) else {
        return false;
    };
    threads.flatten().any(|thread| {
        let Ok(stat) = std::fs::read_to_string(thread.path().join("stat")) else {
            return false;
        };
        // The name in brackets may contain blanks: state and flags are the 1st and 7th word after it.
        let mut words = stat.rsplit(')').next().unwrap().split_whitespace();
        let has_ended = matches!(words.next(), Some("Z" | "X"));
        let flags = words.nth(5).and_then(|word| word.parse::<u32>().ok());
        !has_ended && flags.is_some_and(|flags| flags & EXITING != 0)
    })
}

/// Sends a signal to a process, which may have ended.
pub fn signal(pid: u32, signal: Signal) {
    if let Some(pid) = i32::try_from(pid).ok().and_then(Pid::from_raw) {
        let _ = rustix::process::kill_process(pid, signal);
    }
}

/// Stops a process, and waits until it does not do anything any more.
pub fn stop(pid: u32) {
    signal(pid, Signal::STOP);
    until("its standstill", SOON, || {
        let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap();
        let state = stat.rsplit(") ").next().unwrap();
        state.starts_with('T').then_some(())
    });
}

/// The processes called `sleep` with this argument, wherever they are: of those that have forgotten
/// their environment, nothing else is known.
fn sleepers(time: &str) -> Vec<u32> {
    let line = format!("sleep\0{time}\0").into_bytes();
    let entries = std::fs::read_dir("/proc").unwrap().flatten();
    entries
        .filter_map(|entry| entry.file_name().to_str()?.parse().ok())
        .filter(|pid: &u32| std::fs::read(format!("/proc/{pid}/cmdline")).is_ok_and(|l| l == line))
        .collect()
}

/// Number of `sleep` processes with this argument.
pub fn sleeping(time: &str) -> usize {
    sleepers(time).len()
}

/// Ends them.
pub fn end_sleeping(time: &str) {
    for pid in sleepers(time) {
        signal(pid, Signal::KILL);
    }
}
