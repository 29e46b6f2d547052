//! Orphans: processes that outlive their parent. They are identified by their environment or their parent, and
//! killed.
//!
//! Every process of a run has an environment variable with the path of its configuration, and all its descendants
//! inherit it. The variable identifies the run, also after the end of the orchestrator. An external program can start
//! processes with another environment. The orchestrator is therefore a "child subreaper": it becomes the parent of
//! every descendant whose own parent ends, and kills its last children when its last run ends.

use std::os::fd::{AsFd as _, OwnedFd};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use platform::proc;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::{
    Pid, PidfdFlags, Signal, WaitId, WaitIdOptions, getpid, pidfd_open, pidfd_send_signal,
    set_child_subreaper, waitid,
};

/// Environment variable with the path of a process's configuration.
pub const CONFIG_VARIABLE: &str = "PROTEAN_CONFIG";

/// Maximum number of searches for living processes.
const MAX_SEARCHES: u32 = 16;
/// Maximum time until killed processes are gone. A process that the system does not end by then (of another user,
/// or in an operation of a broken device) is ignored.
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
pub(super) fn become_subreaper() -> std::io::Result<()> {
    let mut runs = runs();
    if runs.before.is_none() {
        set_child_subreaper(Some(getpid()))?;
        runs.before = Some(children());
    }
    Ok(())
}

/// Kills the orphans of a run's external programs, after the processes of the run have ended.
pub(super) fn end_run(root: &Path) {
    let mut runs = runs();
    runs.running = runs.running.saturating_sub(1);
    let Some(before) = &runs.before else {
        return;
    };
    kill_run(root);
    // Children without the variable may belong to any run. The lock prevents other runs from starting meanwhile.
    if runs.running == 0 {
        let deadline = Instant::now() + EXIT_TIMEOUT;
        kill_until_none(deadline, || {
            let mut children = children();
            children.retain(|pid| !before.contains(pid));
            children
        });
    }
}

/// Kills every living process of a run and returns their ids.
pub(super) fn kill_run(root: &Path) -> Vec<u32> {
    kill_all(|config| config.parent() == Some(root))
}

/// Kills every process with this configuration.
pub(super) fn kill_with_config(config: &Path) {
    kill_all(|its| its == config);
}

/// Kills every process whose configuration satisfies `is_wanted`; returns their ids, sorted.
fn kill_all(is_wanted: impl Fn(&Path) -> bool) -> Vec<u32> {
    let is_wanted = |pid: i32| {
        proc::variable(pid, CONFIG_VARIABLE).is_some_and(|its| is_wanted(&PathBuf::from(its)))
    };
    let mut killed = Vec::new();
    // A process that is starting another may have hidden it from the first search.
    for _ in 0..MAX_SEARCHES {
        let found: Vec<i32> = proc::all()
            .map(|stat| stat.pid)
            .filter(|pid| !killed.contains(pid) && is_wanted(*pid))
            .collect();
        if found.is_empty() {
            break;
        }
        let mut ends = Vec::new();
        for pid in found {
            // Checked again: the descriptor prevents the reuse of the id.
            if let Some(end) = open(pid).filter(|_| is_wanted(pid))
                && pidfd_send_signal(&end, Signal::KILL).is_ok()
            {
                killed.push(pid);
                ends.push(end);
            }
        }
        await_ends(&ends, Instant::now() + EXIT_TIMEOUT);
    }
    let mut killed: Vec<u32> = killed.into_iter().map(i32::unsigned_abs).collect();
    killed.sort_unstable();
    killed
}

/// Kills processes until none is found: each search finds the children of the killed processes.
fn kill_until_none(deadline: Instant, find: impl Fn() -> Vec<i32>) {
    loop {
        let ends: Vec<OwnedFd> = find().into_iter().filter_map(open).collect();
        if ends.is_empty() || Instant::now() >= deadline {
            return;
        }
        for end in &ends {
            let _ = pidfd_send_signal(end, Signal::KILL);
        }
        await_ends(&ends, deadline);
    }
}

fn open(pid: i32) -> Option<OwnedFd> {
    pidfd_open(Pid::from_raw(pid)?, PidfdFlags::empty()).ok()
}

/// Waits until killed processes have ended, and reaps the children of this process among them.
fn await_ends(ends: &[OwnedFd], deadline: Instant) {
    for end in ends {
        let left = deadline.saturating_duration_since(Instant::now());
        let left = Timespec::try_from(left).unwrap_or_default();
        // A signal only shortens the wait.
        let _ = poll(&mut [PollFd::new(end, PollFlags::IN)], Some(&left));
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG;
        let _ = waitid(WaitId::PidFd(end.as_fd()), options);
    }
}

/// Returns the children of this process, including those that have ended.
fn children() -> Vec<i32> {
    let this = getpid().as_raw_nonzero().get();
    let all = proc::all();
    all.filter(|stat| stat.parent == this)
        .map(|stat| stat.pid)
        .collect()
}
