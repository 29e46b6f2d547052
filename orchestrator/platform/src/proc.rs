//! Reader of `/proc`: processes, their parents, states and environments.

use std::ffi::{OsStr, OsString};

use procfs::process::{Process, all_processes};

/// Contents of `/proc/PID/stat`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stat {
    /// Process id.
    pub pid: i32,
    /// Process id of its parent.
    pub parent: i32,
    /// State, for example `'R'` (running), `'T'` (stopped by a signal) or `'Z'` (ended, not yet reaped).
    pub state: char,
}

impl Stat {
    fn of(process: &Process) -> Option<Self> {
        let stat = process.stat().ok()?;
        Some(Self {
            pid: stat.pid,
            parent: stat.ppid,
            state: stat.state,
        })
    }

    /// Returns `true` if a signal or a debugger has stopped the process.
    pub fn is_stopped(&self) -> bool {
        matches!(self.state, 'T' | 't')
    }
}

/// Returns all processes of the machine, without those that end meanwhile.
pub fn all() -> impl Iterator<Item = Stat> {
    let processes = all_processes().into_iter().flatten().flatten();
    processes.filter_map(|process| Stat::of(&process))
}

/// Returns the process with this id, if it exists.
pub fn stat(pid: i32) -> Option<Stat> {
    Stat::of(&Process::new(pid).ok()?)
}

/// Returns a variable of the environment that a process was started with; `None` if the process has ended or
/// belongs to another user.
pub fn variable(pid: i32, name: &str) -> Option<OsString> {
    let environment = Process::new(pid).ok()?.environ().ok()?;
    environment.get(OsStr::new(name)).cloned()
}

#[cfg(test)]
mod tests {
    use std::process::{Command, Stdio};

    use rustix::process::{Pid, Signal, kill_process};

    use super::*;

    #[test]
    fn a_child_is_found_with_its_parent_state_and_environment() {
        let mut child = Command::new("sleep")
            .arg("60")
            .env("PROC_TEST", "a value")
            .stdin(Stdio::null())
            .spawn()
            .unwrap();
        let pid = i32::try_from(child.id()).unwrap();
        let parent = i32::try_from(std::process::id()).unwrap();
        let found = all().find(|stat| stat.pid == pid).unwrap();
        assert_eq!(found.parent, parent);
        // Between fork and exec the child still has the environment of its parent.
        while variable(pid, "PROC_TEST").is_none() {
            std::thread::yield_now();
        }
        assert_eq!(variable(pid, "PROC_TEST").unwrap(), "a value");
        assert_eq!(variable(pid, "PROC_TES"), None);
        kill_process(Pid::from_child(&child), Signal::STOP).unwrap();
        while !stat(pid).unwrap().is_stopped() {
            std::thread::yield_now();
        }
        kill_process(Pid::from_child(&child), Signal::KILL).unwrap();
        while stat(pid).unwrap().state != 'Z' {
            std::thread::yield_now();
        }
        child.wait().unwrap();
        assert_eq!(stat(pid), None);
    }
}
