//! Processes that have outlived their run: found by what they were told, and killed.
//!
//! Every process of a run is told the place of its configuration by an environment variable, which
//! whatever it starts inherits. Ids alone would not do: they are used again, and nobody has listed the
//! processes of processes; nor would command lines: programs of the user's own have any.

use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStrExt as _;
use std::path::Path;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::{Pid, PidfdFlags, Signal, pidfd_open, pidfd_send_signal};

use super::children::CONFIG_VARIABLE;
use super::warden;

/// How often it is looked for processes that still live, at most.
const LOOKS: u32 = 16;
/// Time for wardens to end what is below them, some of which only they can find.
const WARDENS_WITHIN: Duration = Duration::from_secs(5);
/// Time for those that were killed to be gone.
const GONE_WITHIN: Duration = Duration::from_secs(2);
/// Time between two looks for them.
const LOOK: Duration = Duration::from_millis(5);

/// Kills every process of a run that still lives; their ids. Wardens, whose orchestrator must be gone,
/// are first left to their work.
pub(super) fn kill_all_of(root: &Path) -> Vec<u32> {
    let mut needle = needle(root);
    needle.push(b'/');
    let is_told = |pid: &u32| environment_of(*pid).is_some_and(|told| tells(&told, &needle, false));
    let deadline = Instant::now() + WARDENS_WITHIN;
    while processes().any(|pid| is_told(&pid) && is_warden(pid)) && Instant::now() < deadline {
        std::thread::park_timeout(LOOK);
    }
    kill(is_told)
}

/// Kills every process that was given the configuration with this path.
pub(super) fn kill_those_of(config: &Path) -> Vec<u32> {
    let needle = needle(config);
    kill(|pid| environment_of(*pid).is_some_and(|told| tells(&told, &needle, true)))
}

fn kill(is_wanted: impl Fn(&u32) -> bool) -> Vec<u32> {
    let mut killed = Vec::new();
    let mut ends = Vec::new();
    // One that was just starting another may have escaped the first look.
    for _ in 0..LOOKS {
        let found: Vec<u32> = processes()
            .filter(|pid| !killed.contains(pid) && is_wanted(pid))
            .collect();
        if found.is_empty() {
            break;
        }
        for id in found {
            let pid = i32::try_from(id).ok().and_then(Pid::from_raw);
            let end = pid.and_then(|pid| pidfd_open(pid, PidfdFlags::empty()).ok());
            // Looked at once more now that its number cannot become somebody else's.
            if let Some(end) = end.filter(|_| is_wanted(&id))
                && pidfd_send_signal(&end, Signal::KILL).is_ok()
            {
                killed.push(id);
                ends.push(end);
            }
        }
    }
    await_ends(&ends);
    killed.sort_unstable();
    killed
}

/// Waits until those that were killed are gone, which takes the system a moment.
fn await_ends(ends: &[OwnedFd]) {
    let deadline = Instant::now() + GONE_WITHIN;
    for end in ends {
        let left = deadline.saturating_duration_since(Instant::now());
        let left = Timespec::try_from(left).unwrap_or_default();
        // A signal only shortens this.
        let _ = poll(&mut [PollFd::new(end, PollFlags::IN)], Some(&left));
    }
}

/// The beginning of an entry of the environment that names this path.
fn needle(path: &Path) -> Vec<u8> {
    let mut needle = format!("{CONFIG_VARIABLE}=").into_bytes();
    needle.extend_from_slice(path.as_os_str().as_bytes());
    needle
}

/// The ids of all processes that there are.
fn processes() -> impl Iterator<Item = u32> {
    let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok())
}

/// The environment of a process. (Those of other users cannot be read, and whoever has ended has
/// none.)
fn environment_of(pid: u32) -> Option<Vec<u8>> {
    std::fs::read(format!("/proc/{pid}/environ")).ok()
}

/// Whether an environment has an entry that begins so, or that is the whole of it.
fn tells(environment: &[u8], needle: &[u8], whole: bool) -> bool {
    environment
        .split(|&byte| byte == 0)
        .any(|entry| entry.starts_with(needle) && (!whole || entry.len() == needle.len()))
}

fn is_warden(pid: u32) -> bool {
    std::fs::read(format!("/proc/{pid}/cmdline"))
        .is_ok_and(|line| line.starts_with(warden::TITLE.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_configuration_is_not_taken_for_another_that_begins_like_it() {
        let told = b"HOME=/root\0PROTEAN_CONFIG=/run/r1/process-12.json\0PATH=/bin\0";
        let tells = |path: &str, whole| tells(told, &needle(Path::new(path)), whole);
        assert!(tells("/run/r1/process-12.json", true));
        assert!(!tells("/run/r1/process-1", true));
        assert!(!tells("/run/r1/process-2.json", true));
        assert!(tells("/run/r1/", false));
        assert!(!tells("/run/r/", false));
    }
}
