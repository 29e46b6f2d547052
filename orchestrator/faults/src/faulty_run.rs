//! A mission in a separate process with a separate runtime directory, so that all its remains can
//! be found.

use std::fs::File;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use platform::{descriptors, proc, program};
use runtime::lockstep::TickBarrier;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value as Json;
use tempfile::TempDir;

use super::{ChaosError, FaultKind, Outcome};
use mission::child_process::describe_exit;
use runtime::config::CONFIG_VARIABLE;
use scenario::ResolvedScenario;
use scenario::spec::Mode;

/// Name of its log.
pub(super) const LOG: &str = "mission.mcap";
/// Duration of a pause: far below the time after which a process counts as hung.
const PAUSE: Duration = Duration::from_millis(200);
/// Interval between checks.
const POLL_INTERVAL: Duration = Duration::from_millis(5);

/// A mission without faults.
#[derive(Debug)]
pub(super) struct Baseline {
    /// Real time of the mission (s).
    pub(super) lasted_s: f64,
    /// Its digest, in lock-step.
    pub(super) digest: Option<Json>,
}

impl Baseline {
    /// Runs a mission without faults.
    pub(super) fn measure(scenario: &ResolvedScenario) -> Result<Self, ChaosError> {
        let mut mission = Mission::start(scenario)?;
        let ended = mission.end(Duration::from_secs(600));
        let lasted_s = mission.start.elapsed().as_secs_f64();
        let code = ended.status.and_then(|status| status.code());
        let is_real_time = scenario.run.mode == Mode::RealTime;
        // In real time a busy machine may lose messages.
        if code == Some(0) || (code == Some(3) && is_real_time) {
            let digest = ended.summary["digest"].clone();
            let digest = (!is_real_time).then_some(digest);
            return Ok(Self { lasted_s, digest });
        }
        let how = ended.status.map_or("did not end".to_owned(), describe_exit);
        let words = ended.stderr;
        Err(ChaosError::Baseline(format!("{how}: {words}")))
    }
}

/// A running mission.
#[derive(Debug)]
pub(super) struct Mission {
    child: Child,
    start: Instant,
    folder: TempDir,
    /// Numbers of posted ticks, and the times at which each was first read.
    posts: Vec<(u64, Instant)>,
}

/// A mission that has ended.
#[derive(Debug)]
pub(super) struct Ended {
    /// Exit status of the orchestrator; `None` if it did not exit and was killed.
    pub(super) status: Option<ExitStatus>,
    /// JSON that it printed; null without output.
    pub(super) summary: Json,
    /// Its stderr.
    pub(super) stderr: String,
}

pub(super) fn system(what: impl Into<String>) -> impl FnOnce(std::io::Error) -> ChaosError {
    let what = what.into();
    move |source| ChaosError::System { what, source }
}

impl Mission {
    /// Starts the orchestrator of a mission.
    pub(super) fn start(scenario: &ResolvedScenario) -> Result<Self, ChaosError> {
        // Short: the length of socket paths below it is limited.
        let folder = tempfile::Builder::new()
            .prefix("pc")
            .tempdir_in("/tmp")
            .map_err(system("cannot create a temporary directory"))?;
        let file = |name: &str| {
            let path = folder.path().join(name);
            File::create(&path).map_err(system(path.display().to_string()))
        };
        let runtime_dir = folder.path().join("rt");
        std::fs::create_dir(&runtime_dir).map_err(system(runtime_dir.display().to_string()))?;
        let path = folder.path().join("mission.toml");
        std::fs::write(&path, scenario.to_toml()).map_err(system(path.display().to_string()))?;
        let mut command = command(folder.path(), "run");
        command.arg(&path).args(["--json", "--quiet", "--out"]);
        command.arg(folder.path().join(LOG));
        if scenario.uses_external_commands() {
            command.arg("--allow-external");
        }
        // In a separate process group: Ctrl-C goes to `chaos`, which then ends in order.
        let child = command
            .process_group(0)
            .stdout(file("stdout")?)
            .stderr(file("stderr")?)
            .spawn()
            .map_err(system("this program cannot be started"))?;
        Ok(Self {
            child,
            start: Instant::now(),
            folder,
            posts: Vec::new(),
        })
    }

    /// Keeps its directory when it is dropped.
    pub(super) fn keep(&mut self) {
        self.folder.disable_cleanup(true);
    }

    /// Path of its directory.
    pub(super) fn path(&self) -> &Path {
        self.folder.path()
    }

    fn is_over(&mut self) -> bool {
        !matches!(self.child.try_wait(), Ok(None))
    }

    /// Injects a fault when the mission has this age. Returns the time of the injection, or `None`
    /// if the mission had ended before.
    pub(super) fn inject(&mut self, fault: &Outcome, moment: Duration) -> Option<Instant> {
        while self.start.elapsed() < moment {
            if self.is_over() {
                return None;
            }
            self.look_at_ticks();
            sleep(POLL_INTERVAL.min(moment.saturating_sub(self.start.elapsed())));
        }
        let pid = loop {
            match self.find(fault) {
                Some(pid) => break Pid::from_raw(pid)?,
                None if self.is_over() => return None,
                None => sleep(POLL_INTERVAL),
            }
        };
        let at = Instant::now();
        let send = |signal| kill_process(pid, signal).is_ok();
        let is_done = match fault.kind {
            FaultKind::Kill | FaultKind::KillOrchestrator => send(Signal::KILL),
            FaultKind::Hang => send(Signal::STOP),
            FaultKind::Pause => {
                let is_stopped = send(Signal::STOP);
                sleep(PAUSE);
                is_stopped && send(Signal::CONT)
            }
        };
        is_done.then_some(at)
    }

    /// Returns the process id of the target of a fault, found by its configuration file; `None` if
    /// it does not run.
    fn find(&self, fault: &Outcome) -> Option<i32> {
        let orchestrator = i32::try_from(self.child.id()).ok()?;
        if fault.kind == FaultKind::KillOrchestrator {
            return Some(orchestrator);
        }
        let file = format!("process-{}.json", fault.index);
        let is_target = |pid| {
            let config = proc::variable(pid, CONFIG_VARIABLE).ok().flatten();
            config.is_some_and(|config| Path::new(&config).ends_with(&file))
        };
        let all = proc::all().unwrap_or_default();
        all.into_iter()
            .filter(|stat| stat.parent == orchestrator && stat.state != 'Z')
            .map(|stat| stat.pid)
            .find(|&pid| is_target(pid))
    }

    /// Returns the configurations of the living processes of the mission, whatever their parents.
    ///
    /// # Errors
    /// The error of the system if a process cannot be read.
    pub(super) fn living(&self) -> std::io::Result<Vec<PathBuf>> {
        let mut living = Vec::new();
        for stat in proc::all()?.iter().filter(|stat| stat.state != 'Z') {
            let config = proc::variable(stat.pid, CONFIG_VARIABLE)?.map(PathBuf::from);
            living.extend(config.filter(|config| config.starts_with(self.path())));
        }
        Ok(living)
    }

    fn look_at_ticks(&mut self) {
        let runs = self.runs().unwrap_or_default();
        let mut prefixes = runs.iter().map(|run| prefix(run));
        // The page is removed with the run.
        let page = prefixes.find_map(|prefix| TickBarrier::open(&prefix).ok());
        let ticks = page.map_or(0, |page| page.ticks_posted());
        let known = self.posts.last().map_or(0, |&(ticks, _)| ticks);
        if ticks > known {
            self.posts.push((ticks, Instant::now()));
        }
    }

    /// Returns the age, at this moment, of the first tick beyond `ticks` (s); 0 if there was none.
    pub(super) fn age_beyond(&self, ticks: u64, now: Instant) -> f64 {
        let beyond = self.posts.iter().find(|&&(seen, _)| seen > ticks);
        beyond.map_or(0.0, |&(_, at)| {
            now.saturating_duration_since(at).as_secs_f64()
        })
    }

    /// Waits for the end; kills the mission at the time limit.
    pub(super) fn end(&mut self, patience: Duration) -> Ended {
        let deadline = Instant::now() + patience;
        let status = loop {
            match self.child.try_wait() {
                Ok(Some(status)) => break Some(status),
                Ok(None) if Instant::now() < deadline => sleep(POLL_INTERVAL),
                _ => {
                    let _ = self.child.kill();
                    let _ = self.child.wait();
                    break None;
                }
            }
        };
        Ended {
            status,
            summary: serde_json::from_str(&self.text("stdout")).unwrap_or_default(),
            stderr: self.text("stderr"),
        }
    }

    /// Runs `clean`, as a user would after a killed orchestrator.
    pub(super) fn clean(&self) {
        let clean = command(self.path(), "clean")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        if let Err(error) = clean {
            tracing::warn!("this program cannot be started: {error}");
        }
    }

    /// Returns the names of its run directories: one during a run.
    ///
    /// # Errors
    /// The error of the system if they cannot be listed.
    pub(super) fn runs(&self) -> std::io::Result<Vec<String>> {
        names(&self.path().join("rt/protean"), "r")
    }

    fn text(&self, name: &str) -> String {
        let bytes = std::fs::read(self.path().join(name)).unwrap_or_default();
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

impl Drop for Mission {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        self.clean();
    }
}

/// Returns the names in a directory that begin with `beginning`; none if it does not exist.
///
/// # Errors
/// The error of the system if they cannot be listed.
pub(super) fn names(directory: &Path, beginning: &str) -> std::io::Result<Vec<String>> {
    let entries = match std::fs::read_dir(directory) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    let mut names = Vec::new();
    for entry in entries {
        let name = entry?.file_name().to_string_lossy().into_owned();
        names.extend(name.starts_with(beginning).then_some(name));
    }
    Ok(names)
}

/// Returns the prefix of the names of a run's shared memory.
pub(super) fn prefix(run: &str) -> String {
    format!("protean_{run}_")
}

/// Returns a command of this program with the mission's runtime directory. (The working directory
/// is unchanged: the paths of external programs in scenarios depend on it.)
fn command(folder: &Path, verb: &str) -> Command {
    let mut command = Command::new(program::THIS);
    command
        .arg(verb)
        .env("XDG_RUNTIME_DIR", folder.join("rt"))
        .stdin(Stdio::null());
    descriptors::inherit_only_standard_streams(&mut command);
    command
}
