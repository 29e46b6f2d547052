//! Does what a fault says.

use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use ipc_types::clock::monotonic_ns;
use rustix::process::{Pid, Signal, kill_process};

use super::fault::{Fault, FaultKind};
use super::mission::Mission;
use super::posts::Posts;
use crate::census::{self, CensusError, Member};

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
    let injected = Injected {
        at: Instant::now(),
        at_ns: monotonic_ns(),
        victim,
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
