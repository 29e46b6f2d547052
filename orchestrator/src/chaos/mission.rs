//! A mission as its own program, with its own runtime directory, so that whatever it leaves is its
//! own.

use std::fs::{DirBuilder, File};
use std::io::Read as _;
use std::os::unix::fs::DirBuilderExt as _;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags};
use rustix::process::{Pid, PidfdFlags};
use serde::Serialize;
use serde_json::Value as Json;
use tempfile::TempDir;

use super::fault::Policy;
use super::{ChaosError, ChaosOptions};
use crate::scenario::{OnFailure, ResolvedScenario};
use crate::{descriptors, program};

/// Real time without an answer after which a process counts as hung when its mission is left alone
/// [s].
const PATIENCE_S: f64 = 60.0;

/// Bounds of that time in missions to which something is done [s].
const HANG_TIMEOUT_S: (f64, f64) = (5.0, 30.0);

/// Times of an untouched mission that it is in between. The machine may have become busier since.
const HANG_TIMEOUT: f64 = 5.0;

/// Real time that a process has to become ready [s].
const READY_TIMEOUT_S: f64 = 15.0;

/// Name of its log.
pub(super) const LOG: &str = "mission.mcap";

/// How a mission's time goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Course {
    /// As fast as everybody answers.
    LockStep,
    /// By the clock.
    RealTime,
}

/// A mission that is left alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Baseline {
    /// Real time that it takes [s].
    pub lasted_s: f64,
    /// Its digest, in lock-step.
    pub digest: Option<String>,
}

impl Baseline {
    /// Real time without an answer after which a process counts as hung [s]: beyond what a busy
    /// machine makes of a living one, which is never silent for as long as all of this took.
    pub(super) fn hang_timeout_s(&self) -> f64 {
        let (least, most) = HANG_TIMEOUT_S;
        (HANG_TIMEOUT * self.lasted_s).clamp(least, most)
    }
}

/// A mission that runs.
#[derive(Debug)]
pub struct Mission {
    /// The orchestrator.
    pub child: Child,
    /// When it was started.
    pub start: Instant,
    folder: TempDir,
    /// Names of its processes behind the simulator.
    names: Vec<String>,
}

/// A mission that is over.
#[derive(Debug)]
pub struct Ended {
    /// How the orchestrator ended; `None` if it did not and was killed.
    pub status: Option<ExitStatus>,
    /// What it printed, if that is an object.
    pub summary: Option<Json>,
    /// What it said.
    pub stderr: String,
}

fn system(what: impl Into<String>) -> impl FnOnce(std::io::Error) -> ChaosError {
    let what = what.into();
    move |source| ChaosError::System { what, source }
}

impl Mission {
    /// Starts the orchestrator of a mission; who is silent for so long counts as hung [s].
    pub(super) fn start(
        options: &ChaosOptions,
        course: Course,
        policy: Policy,
        hang_timeout_s: f64,
    ) -> Result<Self, ChaosError> {
        // Short: names of sockets below it are limited.
        let folder = tempfile::Builder::new()
            .prefix("pc")
            .tempdir_in("/tmp")
            .and_then(|folder| {
                DirBuilder::new().mode(0o700).create(runtime_dir(&folder))?;
                Ok(folder)
            })
            .map_err(system("cannot make a temporary folder"))?;
        let scenario = folder.path().join("mission.toml");
        let prepared = prepared(&options.scenario, policy, hang_timeout_s);
        std::fs::write(&scenario, prepared.to_toml())
            .map_err(system(scenario.display().to_string()))?;
        let mut mission_command = command(&folder, "run");
        mission_command
            .arg(&scenario)
            .args(["--json", "--quiet", "--out"])
            .arg(folder.path().join(LOG));
        if options.scenario.uses_external_commands() {
            mission_command.arg("--allow-external");
        }
        if course == Course::RealTime {
            mission_command.args(["--real-time", &options.real_time.to_string()]);
        }
        let out = |name: &str| {
            let path = folder.path().join(name);
            File::create(&path).map_err(system(path.display().to_string()))
        };
        // In a group of its own: Ctrl-C is for chaos, which then ends in order.
        let child = mission_command
            .process_group(0)
            .stdout(out("stdout")?)
            .stderr(out("stderr")?)
            .spawn()
            .map_err(system("this program cannot be started"))?;
        Ok(Self {
            child,
            start: Instant::now(),
            folder,
            names: options
                .scenario
                .processes
                .iter()
                .map(|process| process.name.clone())
                .collect(),
        })
    }

    /// Its process id.
    pub fn pid(&self) -> i32 {
        self.child.id() as i32
    }

    /// Its log.
    pub fn log(&self) -> PathBuf {
        self.path().join(LOG)
    }

    /// File name of the configuration of a process with this name.
    pub(super) fn config_of(&self, name: &str) -> String {
        let position = self.names.iter().position(|other| other == name);
        format!("process-{}.json", position.map_or(0, |at| at + 1))
    }

    /// Its directory.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Whether it is over.
    pub fn is_over(&mut self) -> bool {
        !matches!(self.child.try_wait(), Ok(None))
    }

    /// Waits until it is over; kills it if it is not by then.
    pub(super) fn end(&mut self, patience: Duration) -> Ended {
        Ended {
            status: end(&mut self.child, patience),
            summary: serde_json::from_str(&self.text("stdout")).ok(),
            stderr: self.text("stderr"),
        }
    }

    /// Removes what a killed orchestrator left, as its user would.
    pub(super) fn clean(&self) -> Result<(), ChaosError> {
        command(&self.folder, "clean")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status()
            .map_err(system("this program cannot be started"))
            .map(drop)
    }

    /// What is left in the directory of its runs.
    pub(super) fn left_in_runtime_dir(&self) -> Vec<String> {
        let entries = std::fs::read_dir(runtime_dir(&self.folder).join("protean"));
        entries
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path().display().to_string())
            .collect()
    }

    /// The directories of its runs: one, or none yet.
    pub fn roots(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(runtime_dir(&self.folder).join("protean"));
        entries
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path())
            .filter(|path| path.is_dir())
            .collect()
    }

    fn text(&self, name: &str) -> String {
        let mut bytes = Vec::new();
        if let Ok(file) = File::open(self.path().join(name)) {
            let _ = file.take(1 << 20).read_to_end(&mut bytes);
        }
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

impl Drop for Mission {
    fn drop(&mut self) {
        // Nothing is left, whatever was done to it.
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = self.clean();
    }
}

/// Waits until a process has ended; `None` if it has not by then, and was killed.
pub(super) fn end(child: &mut Child, patience: Duration) -> Option<ExitStatus> {
    let deadline = Instant::now() + patience;
    let pidfd = rustix::process::pidfd_open(Pid::from_child(child), PidfdFlags::empty());
    loop {
        if let Ok(Some(status)) = child.try_wait() {
            return Some(status);
        }
        let left = deadline.saturating_duration_since(Instant::now());
        let (Ok(pidfd), false) = (&pidfd, left.is_zero()) else {
            let _ = child.kill();
            let _ = child.wait();
            return None;
        };
        let timeout = rustix::time::Timespec {
            tv_sec: left.as_secs() as i64,
            tv_nsec: i64::from(left.subsec_nanos()),
        };
        // Woken early or failed: looked at anyway.
        let _ = rustix::event::poll(&mut [PollFd::new(pidfd, PollFlags::IN)], Some(&timeout));
    }
}

/// Name of the process that is not in the scenario.
pub const SIMULATOR: &str = "simulator";

/// The scenario as it is broken: failures are noticed soon, and dealt with as the policy says.
fn prepared(scenario: &ResolvedScenario, policy: Policy, hang_timeout_s: f64) -> ResolvedScenario {
    let mut scenario = scenario.clone();
    scenario.run.hang_timeout_s = hang_timeout_s;
    scenario.run.ready_timeout_s = READY_TIMEOUT_S;
    for process in &mut scenario.processes {
        process.supervision.ready_timeout_s = READY_TIMEOUT_S;
        if policy == Policy::Restart {
            process.supervision.on_failure = OnFailure::Restart;
        }
    }
    scenario
}

/// The runtime directory of a mission, in its folder.
fn runtime_dir(folder: &TempDir) -> PathBuf {
    folder.path().join("rt")
}

/// This program, with the mission's runtime directory. (The folder that it works in is ours, from which
/// the programs of scenarios have their paths.)
fn command(folder: &TempDir, verb: &str) -> Command {
    let mut command = Command::new(program::THIS);
    command
        .arg(verb)
        .env("XDG_RUNTIME_DIR", runtime_dir(folder))
        .stdin(Stdio::null());
    descriptors::leave_behind(&mut command);
    command
}

/// A mission that nothing is done to.
pub(super) fn baseline(
    options: &ChaosOptions,
    (course, policy): (Course, Policy),
) -> Result<Baseline, ChaosError> {
    let mut mission = Mission::start(options, course, policy, PATIENCE_S)?;
    let ended = mission.end(Duration::from_secs(600));
    let lasted_s = mission.start.elapsed().as_secs_f64();
    let fine = ended.status.and_then(|s| s.code()).is_some_and(|code| {
        // By the clock a busy machine may lose messages.
        code == 0 || (code == 3 && course == Course::RealTime)
    });
    let Some(summary) = ended.summary.filter(|_| fine) else {
        return Err(ChaosError::Baseline {
            scenario: options.scenario.name.clone(),
            what: match ended.status {
                Some(status) => crate::mission::report::exit_words(status),
                None => "did not end".to_owned(),
            },
            stderr: ended.stderr,
        });
    };
    let digest = summary.get("digest").and_then(Json::as_str);
    Ok(Baseline {
        lasted_s,
        digest: digest
            .filter(|_| course == Course::LockStep)
            .map(str::to_owned),
    })
}
