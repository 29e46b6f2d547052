//! Orphans: processes that outlive their parent. They are identified by their environment or their parent, and
//! killed.
//!
//! Every process of a run has an environment variable with the path of its configuration, and all its descendants
//! inherit it. The variable identifies the run, also after the end of the orchestrator. An external program can start
//! processes with another environment. The orchestrator is therefore a "child subreaper": it becomes the parent of
//! every descendant whose own parent ends, and kills its last children when its last run ends.

use std::io::{Error, ErrorKind, Result};
use std::os::fd::{AsFd as _, OwnedFd};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use platform::proc;
use runtime::config::CONFIG_VARIABLE;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use rustix::process::{
    Pid, PidfdFlags, Signal, WaitId, WaitIdOptions, getpid, pidfd_open, pidfd_send_signal,
    set_child_subreaper, waitid,
};

/// Maximum number of searches for living processes.
const MAX_SEARCHES: u32 = 16;
/// Maximum time until killed processes are gone. The system ends a process in an operation of a broken device later.
const EXIT_TIMEOUT: Duration = Duration::from_secs(2);

/// Runs of this process, and its children if it is a subreaper.
struct Runs {
    /// Runs that may have processes.
    running: u32,
    /// Children that this process had when it became a subreaper; `None` before that. They are not killed.
    before: Option<Vec<i32>>,
}

static RUNS: Mutex<Runs> = Mutex::new(Runs {
    running: 0,
    before: None,
});

fn runs() -> MutexGuard<'static, Runs> {
    RUNS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Counts a run that may start processes; [`end_run`] ends it.
pub(super) fn begin_run() {
    runs().running += 1;
}

/// Makes this process the parent of all orphans below it. Must be called before an external program is started.
///
/// # Errors
/// The error of the system.
pub(super) fn become_subreaper() -> Result<()> {
    let mut runs = runs();
    if runs.before.is_none() {
        // First: a child that is not known would be killed.
        runs.before = Some(children()?);
    }
    // Also in a copy of a process that is one.
    Ok(set_child_subreaper(Some(getpid()))?)
}

/// Kills the orphans of a run's external programs, after the processes of the run have ended.
///
/// # Errors
/// The error of the system if they cannot be found.
pub(super) fn end_run(root: &Path) -> Result<()> {
    let mut runs = runs();
    runs.running = runs.running.saturating_sub(1);
    let Some(before) = &runs.before else {
        return Ok(());
    };
    kill_run(root)?;
    // Children without the variable may belong to any run. The lock prevents other runs from starting meanwhile.
    if runs.running > 0 {
        return Ok(());
    }
    let deadline = Instant::now() + EXIT_TIMEOUT;
    kill_until_none(deadline, || {
        let mut children = children()?;
        children.retain(|pid| !before.contains(pid));
        Ok(children)
    })
}

/// Kills every living process of a run and returns their ids.
///
/// # Errors
/// The error of the system if they cannot be found or ended: some may live.
pub(super) fn kill_run(root: &Path) -> Result<Vec<u32>> {
    kill_all(|config| config.parent() == Some(root))
}

/// Kills every process with this configuration.
///
/// # Errors
/// The error of the system if they cannot be found or ended: some may live.
pub(super) fn kill_with_config(config: &Path) -> Result<()> {
    kill_all(|its| its == config).map(drop)
}

/// Kills every process whose configuration satisfies `is_wanted`; returns their ids, sorted.
fn kill_all(is_wanted: impl Fn(&Path) -> bool) -> Result<Vec<u32>> {
    let is_wanted = |pid: i32| -> Result<bool> {
        let config = proc::variable(pid, CONFIG_VARIABLE)?;
        Ok(config.is_some_and(|config| is_wanted(Path::new(&config))))
    };
    let mut killed = Vec::new();
    // A process that is starting another may have hidden it from the first search.
    for _ in 0..MAX_SEARCHES {
        let mut ends = Vec::new();
        for pid in proc::all()?.into_iter().map(|stat| stat.pid) {
            if killed.contains(&pid) || !is_wanted(pid)? {
                continue;
            }
            // Checked again: the descriptor prevents the reuse of the id.
            if let Some(end) = open(pid)?
                && is_wanted(pid)?
            {
                kill(&end)?;
                killed.push(pid);
                ends.push(end);
            }
        }
        if ends.is_empty() {
            break;
        }
        if !await_ends(&ends, Instant::now() + EXIT_TIMEOUT) {
            let text = format!("processes {killed:?} were killed and have not ended");
            return Err(Error::new(ErrorKind::TimedOut, text));
        }
    }
    let mut killed: Vec<u32> = killed.into_iter().map(i32::unsigned_abs).collect();
    killed.sort_unstable();
    Ok(killed)
}

/// Kills processes until none is found: each search finds the children of the killed processes.
fn kill_until_none(deadline: Instant, find: impl Fn() -> Result<Vec<i32>>) -> Result<()> {
    loop {
        let mut ends = Vec::new();
        for pid in find()? {
            ends.extend(open(pid)?);
        }
        if ends.is_empty() || Instant::now() >= deadline {
            return Ok(());
        }
        for end in &ends {
            // One of another user is only waited for.
            let _ = kill(end);
        }
        await_ends(&ends, deadline);
    }
}

/// Returns a descriptor of a process, or `None` if it does not exist.
fn open(pid: i32) -> Result<Option<OwnedFd>> {
    let Some(pid) = Pid::from_raw(pid) else {
        return Ok(None);
    };
    match pidfd_open(pid, PidfdFlags::empty()) {
        Ok(process) => Ok(Some(process)),
        Err(Errno::SRCH) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// Kills a process, unless it has ended.
fn kill(process: &OwnedFd) -> Result<()> {
    match pidfd_send_signal(process, Signal::KILL) {
        Ok(()) | Err(Errno::SRCH) => Ok(()),
        Err(error) => Err(error.into()),
    }
}

/// Waits until killed processes have ended, and reaps the children of this process among them. Returns `false` if one
/// has not ended by the deadline.
fn await_ends(ends: &[OwnedFd], deadline: Instant) -> bool {
    let mut have_ended = true;
    for end in ends {
        let has_ended = loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let timeout = Timespec::try_from(left).unwrap_or_default();
            match poll(&mut [PollFd::new(end, PollFlags::IN)], Some(&timeout)) {
                // A signal of this process shortens the wait.
                Err(Errno::INTR) if !left.is_zero() => {}
                ready => break ready.is_ok_and(|count| count > 0),
            }
        };
        have_ended &= has_ended;
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG;
        let _ = waitid(WaitId::PidFd(end.as_fd()), options);
    }
    have_ended
}

/// Returns the children of this process, including those that have ended.
fn children() -> Result<Vec<i32>> {
    let this = getpid().as_raw_nonzero().get();
    let all = proc::all()?.into_iter();
    Ok(all
        .filter(|stat| stat.parent == this)
        .map(|stat| stat.pid)
        .collect())
}
