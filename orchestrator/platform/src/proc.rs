//! Reader of `/proc`: processes, their parents, states and environments.

use std::ffi::{OsStr, OsString};
use std::io::{Error, Result};
use std::time::Duration;

use procfs::process::{Process, all_processes};
use procfs::{ProcError, ProcResult};
use rustix::io::Errno;

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
    /// Returns `true` if a signal or a debugger has stopped the process.
    pub fn is_stopped(&self) -> bool {
        matches!(self.state, 'T' | 't')
    }
}

/// Time on the processor, summed over the threads of a process.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct CpuTime {
    /// Time for which they ran.
    pub ran: Duration,
    /// Time for which they could have run and waited for a core.
    pub waited: Duration,
}

/// Returns the processor time of the process with this id, if it exists and the kernel measures it.
///
/// # Errors
/// The error of the system if it cannot be read.
pub fn cpu_time(pid: i32) -> Result<Option<CpuTime>> {
    let Some(threads) = existing(Process::new(pid).and_then(|process| process.tasks()))? else {
        return Ok(None);
    };
    let mut sum = CpuTime::default();
    for thread in threads {
        let times = existing(thread.and_then(|thread| thread.schedstat()))?;
        if let Some(times) = times {
            sum.ran += Duration::from_nanos(times.sum_exec_runtime);
            sum.waited += Duration::from_nanos(times.run_delay);
        }
    }
    Ok(Some(sum))
}

/// Returns all processes of the machine, without those that end meanwhile.
///
/// # Errors
/// The error of the system if a process cannot be read: a list without it would be wrong.
pub fn all() -> Result<Vec<Stat>> {
    let mut all = Vec::new();
    for process in all_processes().map_err(error)? {
        all.extend(existing(process.and_then(|process| stat_of(&process)))?);
    }
    Ok(all)
}

/// Returns the process with this id, if it exists.
///
/// # Errors
/// The error of the system if it cannot be read.
pub fn stat(pid: i32) -> Result<Option<Stat>> {
    existing(Process::new(pid).and_then(|process| stat_of(&process)))
}

/// Returns a variable of the environment that a process was started with; `None` if the process has ended or
/// belongs to another user.
///
/// # Errors
/// The error of the system if the environment cannot be read.
pub fn variable(pid: i32, name: &str) -> Result<Option<OsString>> {
    let environment = Process::new(pid).and_then(|process| process.environ());
    Ok(existing(environment)?.and_then(|mut all| all.remove(OsStr::new(name))))
}

/// Returns the number of threads of this process.
///
/// # Errors
/// The error of the system if it cannot be read.
pub fn own_threads() -> Result<i64> {
    let stat = Process::myself().and_then(|process| process.stat());
    stat.map(|stat| stat.num_threads).map_err(error)
}

fn stat_of(process: &Process) -> ProcResult<Stat> {
    let stat = process.stat()?;
    Ok(Stat {
        pid: stat.pid,
        parent: stat.ppid,
        state: stat.state,
    })
}

/// Returns what was read, or `None` if the process has ended or forbids it.
fn existing<T>(read: ProcResult<T>) -> Result<Option<T>> {
    match read {
        Ok(found) => Ok(Some(found)),
        Err(ProcError::NotFound(_) | ProcError::PermissionDenied(_)) => Ok(None),
        Err(ProcError::Io(error, _)) if Errno::from_io_error(&error) == Some(Errno::SRCH) => {
            Ok(None)
        }
        Err(other) => Err(error(other)),
    }
}

fn error(of: ProcError) -> Error {
    match of {
        ProcError::Io(error, _) => error,
        other => Error::other(other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use std::process::{Command, Stdio};

    use rustix::process::{Pid, Signal, kill_process};

    use super::*;

    #[test]
    fn a_process_that_computes_gains_processor_time_and_one_that_sleeps_gains_none() {
        let child =
            |program: &str, args: &[&str]| Command::new(program).args(args).spawn().unwrap();
        let mut children = [
            child("sh", &["-c", "while :; do :; done"]),
            child("sleep", &["60"]),
        ];
        let spent = |child: &std::process::Child| {
            let time = cpu_time(i32::try_from(child.id()).unwrap())
                .unwrap()
                .unwrap();
            time.ran + time.waited
        };
        let second = Duration::from_secs(1);
        while spent(&children[0]) < second / 5 {
            std::thread::yield_now();
        }
        assert!(spent(&children[1]) < second / 5);
        for child in &mut children {
            child.kill().unwrap();
            child.wait().unwrap();
            assert_eq!(cpu_time(i32::try_from(child.id()).unwrap()).unwrap(), None);
        }
    }

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
        let found = all().unwrap();
        let found = found.iter().find(|stat| stat.pid == pid).unwrap();
        assert_eq!(found.parent, parent);
        // Between fork and exec the child still has the environment of its parent.
        while variable(pid, "PROC_TEST").unwrap().is_none() {
            std::thread::yield_now();
        }
        let value = |name| variable(pid, name).unwrap();
        assert_eq!(value("PROC_TEST").unwrap(), "a value");
        assert_eq!(value("PROC_TES"), None);
        kill_process(Pid::from_child(&child), Signal::STOP).unwrap();
        let now = || stat(pid).unwrap();
        while !now().unwrap().is_stopped() {
            std::thread::yield_now();
        }
        kill_process(Pid::from_child(&child), Signal::KILL).unwrap();
        while now().unwrap().state != 'Z' {
            std::thread::yield_now();
        }
        child.wait().unwrap();
        assert_eq!(now(), None);
    }
}
