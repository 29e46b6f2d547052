//! Memory and CPU time of the processes of a run, from the kernel.

use std::path::PathBuf;

use procfs::process::{Process, Task};

/// One process of a run, from its command line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Member {
    /// Process id.
    pub pid: u32,
    /// Kind of the process.
    pub kind: String,
    /// Its configuration.
    pub config: PathBuf,
}

/// Returns the processes that a run's orchestrator has started.
pub fn members(orchestrator: u32) -> Vec<Member> {
    threads(orchestrator)
        .filter_map(|thread| thread.children().ok())
        .flatten()
        .filter_map(|pid| member(pid, &process(pid)?.cmdline().ok()?))
        .collect()
}

/// Parses `protean:NAME process KIND --config FILE`.
fn member(pid: u32, command_line: &[String]) -> Option<Member> {
    let [_, word, kind, option, config, ..] = command_line else {
        return None;
    };
    (word == "process" && option == "--config").then(|| Member {
        pid,
        kind: kind.clone(),
        config: config.into(),
    })
}

fn process(pid: u32) -> Option<Process> {
    Process::new(i32::try_from(pid).ok()?).ok()
}

/// Returns the living threads of a process; none after its end.
fn threads(pid: u32) -> impl Iterator<Item = Task> {
    let tasks = process(pid).and_then(|process| process.tasks().ok());
    tasks.into_iter().flatten().flatten()
}

/// Returns the CPU time of all living threads of a process (ns); 0 after its end.
pub fn cpu_ns(pid: u32) -> u64 {
    threads(pid).map(|thread| thread_cpu_ns(&thread)).sum()
}

/// Returns the CPU time (ns) of the living threads with this name.
pub fn named_thread_cpu_ns(pid: u32, name: &str) -> u64 {
    threads(pid)
        .filter(|thread| thread.stat().is_ok_and(|stat| stat.comm == name))
        .map(|thread| thread_cpu_ns(&thread))
        .sum()
}

fn thread_cpu_ns(thread: &Task) -> u64 {
    thread.schedstat().map_or(0, |times| times.sum_exec_runtime)
}

/// Memory of a process.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Memory {
    /// Resident set size (bytes).
    pub rss: u64,
    /// Proportional set size: shared pages divided by their users (bytes).
    pub pss: u64,
}

/// Returns the memory of a process; `None` after its end.
pub fn memory(pid: u32) -> Option<Memory> {
    let rollup = process(pid)?.smaps_rollup().ok()?.memory_map_rollup;
    let fields = &rollup.0.first()?.extension.map;
    Some(Memory {
        rss: *fields.get("Rss")?,
        pss: *fields.get("Pss")?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_member_is_recognised_by_its_command_line() {
        let line = "protean:police_1 process pursuer --config /tmp/r/process-3.json";
        let words: Vec<String> = line.split(' ').map(str::to_owned).collect();
        let found = member(7, &words).expect("a process of a run");
        assert_eq!((found.pid, found.kind.as_str()), (7, "pursuer"));
        assert_eq!(found.config, PathBuf::from("/tmp/r/process-3.json"));
        assert_eq!(member(7, &words[..3]), None);
        assert_eq!(member(7, &[]), None, "a zombie has no command line");
    }

    #[test]
    fn this_process_uses_cpu_time_and_memory() {
        let pid = std::process::id();
        assert!(cpu_ns(pid) > 0);
        let memory = memory(pid).expect("the memory of this process");
        assert!(memory.pss > 0 && memory.rss >= memory.pss);
        assert_eq!(cpu_ns(u32::MAX), 0);
    }
}
