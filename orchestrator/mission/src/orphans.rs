//! Processes that outlive the process that started them: found by their environment or their parent, and
//! killed.
//!
//! Every process of a run is told the place of its configuration by an environment variable, which
//! whatever it starts inherits: it names the run, also when the orchestrator is gone. An external program can
//! besides start processes with another environment. The orchestrator is therefore a "child subreaper": it
//! becomes the parent of every process below it whose own parent ends, and kills its last children when its
//! last run ends.

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

/// Environment variable that tells every process of a run where its configuration lies.
pub const CONFIG_VARIABLE: &str = "PROTEAN_CONFIG";

/// Most searches for processes that still live.
const SEARCHES: u32 = 16;
/// Time for processes that were killed to be gone. What the system does not end by then (a process of
/// another user, one in the middle of a broken device) is not waited for.
const GONE_WITHIN: Duration = Duration::from_secs(2);

/// The runs of this process, and whether it is the parent of their orphans.
struct Runs {
    /// Runs that may have processes.
    running: u32,
    /// Children that this process had when it became a subreaper; absent before that. They are not killed.
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

/// Makes this process the parent of all orphans below it. Call before an external program is started.
///
/// # Errors
/// What the system says.
pub(super) fn adopt() -> std::io::Result<()> {
    let mut runs = runs();
    if runs.before.is_none() {
        set_child_subreaper(Some(getpid()))?;
        runs.before = Some(children());
    }
    Ok(())
}

/// Kills what external programs of a run have left behind, once the processes of the run have ended.
pub(super) fn end_run(root: &Path) {
    let mut runs = runs();
    runs.running = runs.running.saturating_sub(1);
    let Some(before) = &runs.before else {
        return;
    };
    kill_run(root);
    // Children without the variable can be any run's. The lock keeps others from starting some meanwhile.
    if runs.running == 0 {
        let deadline = Instant::now() + GONE_WITHIN;
        kill_until_none(deadline, || {
            let mut children = children();
            children.retain(|pid| !before.contains(pid));
            children
        });
    }
}

/// Kills every process of a run that still lives; their ids.
pub(super) fn kill_run(root: &Path) -> Vec<u32> {
    kill_all(|config| config.parent() == Some(root))
}

/// Kills every process that was given the configuration with this path.
pub(super) fn kill_with_config(config: &Path) {
    kill_all(|its| its == config);
}

/// Kills every process whose configuration is one of these; their ids, sorted.
fn kill_all(is_wanted: impl Fn(&Path) -> bool) -> Vec<u32> {
    let is_wanted = |pid: i32| {
        proc::variable(pid, CONFIG_VARIABLE).is_some_and(|its| is_wanted(&PathBuf::from(its)))
    };
    let mut killed = Vec::new();
    // One that was just starting another may have escaped the first search.
    for _ in 0..SEARCHES {
        let found: Vec<i32> = proc::all()
            .map(|stat| stat.pid)
            .filter(|pid| !killed.contains(pid) && is_wanted(*pid))
            .collect();
        if found.is_empty() {
            break;
        }
        let mut ends = Vec::new();
        for pid in found {
            // Asked once more now that its number cannot become another's.
            if let Some(end) = open(pid).filter(|_| is_wanted(pid))
                && pidfd_send_signal(&end, Signal::KILL).is_ok()
            {
                killed.push(pid);
                ends.push(end);
            }
        }
        await_ends(&ends, Instant::now() + GONE_WITHIN);
    }
    let mut killed: Vec<u32> = killed.into_iter().map(i32::unsigned_abs).collect();
    killed.sort_unstable();
    killed
}

/// Kills processes until none is found: the children of one that was killed are found next.
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

/// Waits until processes that were killed are gone, and reaps those that are children of this process.
fn await_ends(ends: &[OwnedFd], deadline: Instant) {
    for end in ends {
        let left = deadline.saturating_duration_since(Instant::now());
        let left = Timespec::try_from(left).unwrap_or_default();
        // A signal only shortens this.
        let _ = poll(&mut [PollFd::new(end, PollFlags::IN)], Some(&left));
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG;
        let _ = waitid(WaitId::PidFd(end.as_fd()), options);
    }
}

/// The children of this process, those that have ended included.
fn children() -> Vec<i32> {
    let this = getpid().as_raw_nonzero().get();
    let all = proc::all();
    all.filter(|stat| stat.parent == this)
        .map(|stat| stat.pid)
        .collect()
}
