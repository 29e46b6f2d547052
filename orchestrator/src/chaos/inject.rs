//! Does what a fault says.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use ipc_types::clock::monotonic_ns;
use rustix::process::{Pid, Signal, kill_process};

use super::fault::{Fault, FaultKind};
use super::mission::Mission;
use super::posts::Posts;
use crate::census::{self, CensusError, Member};
use crate::descriptors;
use crate::mission::children::CONFIG_VARIABLE;

/// How long a process is stopped that is only paused: far less than what counts as hung.
const PAUSE: Duration = Duration::from_millis(200);

/// How often a slowed process is stopped, and for how long each time; it runs for a tenth of that.
const SLOWED: (u32, Duration) = (25, Duration::from_millis(18));

/// Longest time between two looks for a process that is not there yet.
const LOOK: Duration = Duration::from_millis(1);

/// A fault that was done.
#[derive(Debug)]
pub struct Injected {
    /// When.
    pub at: Instant,
    /// When, on the clock of the logs [ns].
    pub at_ns: u64,
    /// The process that it was done to.
    pub victim: Member,
    /// The second of its kind, if there is one.
    pub double: Option<Child>,
    /// How far the world was before an orchestrator was killed.
    pub(super) posts: Posts,
}

/// Waits for the moment and does it; `None` if the mission was over before.
///
/// # Errors
/// [`CensusError`] if the machine cannot be looked at.
pub(super) fn inject(
    mission: &mut Mission,
    fault: &Fault,
    moment: Duration,
) -> Result<Option<Injected>, CensusError> {
    let mut posts = Posts::default();
    while mission.start.elapsed() < moment {
        if mission.is_over() {
            return Ok(None);
        }
        if fault.kind == FaultKind::KillOrchestrator {
            posts.look(mission);
        }
        sleep((moment.saturating_sub(mission.start.elapsed())).min(Duration::from_millis(5)));
    }
    let Some(victim) = find(mission, fault)? else {
        return Ok(None);
    };
    let mut injected = Injected {
        at: Instant::now(),
        at_ns: monotonic_ns(),
        victim,
        double: None,
        posts,
    };
    let pid = injected.victim.pid;
    let done = match fault.kind {
        FaultKind::Kill | FaultKind::KillOrchestrator => send(pid, Signal::KILL),
        FaultKind::Terminate | FaultKind::TerminateOrchestrator => send(pid, Signal::TERM),
        FaultKind::Hang => send(pid, Signal::STOP),
        FaultKind::Pause | FaultKind::PauseOrchestrator => {
            let stopped = send(pid, Signal::STOP);
            sleep(PAUSE);
            stopped && send(pid, Signal::CONT)
        }
        FaultKind::Slow => {
            let (times, off) = SLOWED;
            for _ in 0..times {
                if !send(pid, Signal::STOP) {
                    break;
                }
                sleep(off);
                send(pid, Signal::CONT);
                sleep(off / 9);
            }
            true
        }
        FaultKind::Double => {
            injected.double = double(&injected.victim);
            injected.double.is_some()
        }
    };
    Ok(done.then_some(injected))
}

/// The process that the fault is for, as soon as it is there.
fn find(mission: &mut Mission, fault: &Fault) -> Result<Option<Member>, CensusError> {
    while !mission.is_over() {
        if fault.kind.hits_orchestrator() {
            match census::member(mission.pid()) {
                Ok(member) => return Ok(Some(member)),
                Err(_) => continue,
            }
        }
        // By its configuration: an external program can have any name.
        let is_target = |member: &Member| {
            let file = member.config.as_deref().and_then(Path::file_name);
            file.is_some_and(|file| file == mission.config_of(&fault.target).as_str())
        };
        let mut members = census::children(mission.pid())?.into_iter();
        if let Some(member) = members.find(is_target) {
            return Ok(Some(member));
        }
        sleep(LOOK);
    }
    Ok(None)
}

fn send(pid: i32, signal: Signal) -> bool {
    Pid::from_raw(pid).is_some_and(|pid| kill_process(pid, signal).is_ok())
}

/// Starts a process a second time, as it was started the first time.
fn double(victim: &Member) -> Option<Child> {
    let process = procfs::process::Process::new(victim.pid).ok()?;
    let arguments = process.cmdline().ok()?;
    let environment = process.environ().ok()?;
    let config = environment.get(std::ffi::OsStr::new(CONFIG_VARIABLE))?;
    let mut command = Command::new(process.exe().ok()?);
    command
        .args(arguments.get(1..)?)
        .env(CONFIG_VARIABLE, config)
        // Held open: its end would tell the process that its orchestrator is gone.
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    descriptors::leave_behind(&mut command);
    command.spawn().ok()
}
