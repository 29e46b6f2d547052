//! What the kernel tells about the processes of a run, read from `/proc`.

use std::path::{Path, PathBuf};

/// One process of a run, as its command line names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Member {
    /// Process id.
    pub pid: u32,
    /// Kind of the process.
    pub kind: String,
    /// Directory of the run.
    pub root: PathBuf,
}

/// The processes that a run's orchestrator has started.
pub fn members(orchestrator: u32) -> Vec<Member> {
    threads(orchestrator)
        .filter_map(|task| std::fs::read_to_string(task.join("children")).ok())
        .flat_map(|text| parse_pids(&text))
        .filter_map(|pid| parse_member(pid, &std::fs::read(format!("/proc/{pid}/cmdline")).ok()?))
        .collect()
}

fn threads(pid: u32) -> impl Iterator<Item = PathBuf> {
    std::fs::read_dir(format!("/proc/{pid}/task"))
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
}

fn parse_pids(text: &str) -> Vec<u32> {
    text.split_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect()
}

/// `protean:NAME process KIND --config ROOT/process-N.json`.
fn parse_member(pid: u32, command_line: &[u8]) -> Option<Member> {
    let words: Vec<&[u8]> = command_line.split(|&b| b == 0).collect();
    let [_, b"process", kind, b"--config", config, ..] = words[..] else {
        return None;
    };
    Some(Member {
        pid,
        kind: String::from_utf8_lossy(kind).into_owned(),
        root: Path::new(&*String::from_utf8_lossy(config))
            .parent()?
            .to_owned(),
    })
}

/// CPU time that a process has used [ns], all its living threads together; 0 when it is gone.
pub fn cpu_ns(pid: u32) -> u64 {
    threads(pid).map(|task| thread_cpu_ns(&task)).sum()
}

/// CPU time [ns] of the living threads with this name.
pub fn named_thread_cpu_ns(pid: u32, name: &str) -> u64 {
    threads(pid)
        .filter(|task| {
            std::fs::read_to_string(task.join("comm")).is_ok_and(|comm| comm.trim_end() == name)
        })
        .map(|task| thread_cpu_ns(&task))
        .sum()
}

fn thread_cpu_ns(task: &Path) -> u64 {
    std::fs::read_to_string(task.join("schedstat"))
        .ok()
        .and_then(|text| text.split_whitespace().next()?.parse().ok())
        .unwrap_or(0)
}

/// Memory of a process.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Memory {
    /// Resident [1024 bytes].
    pub rss: u64,
    /// Resident, shared pages divided by their users [1024 bytes].
    pub pss: u64,
}

/// Memory of a process; `None` when it is gone.
pub fn memory(pid: u32) -> Option<Memory> {
    parse_memory(&std::fs::read_to_string(format!("/proc/{pid}/smaps_rollup")).ok()?)
}

fn parse_memory(text: &str) -> Option<Memory> {
    let field = |name: &str| {
        text.lines().find_map(|line| {
            let rest = line.strip_prefix(name)?.strip_prefix(':')?;
            rest.split_whitespace().next()?.parse::<u64>().ok()
        })
    };
    Some(Memory {
        rss: field("Rss")?,
        pss: field("Pss")?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_member_is_recognised_by_its_command_line() {
        let line =
            b"protean:police_1\0process\0pursuer\0--config\0/tmp/protean-0/rX/process-3.json\0";
        let member = parse_member(7, line).unwrap();
        assert_eq!((member.pid, member.kind.as_str()), (7, "pursuer"));
        assert_eq!(member.root, Path::new("/tmp/protean-0/rX"));
        assert_eq!(parse_member(7, b"sh\0-c\0true\0"), None);
        assert_eq!(parse_member(7, b""), None, "a zombie has no command line");
    }

    #[test]
    fn memory_is_read_by_whole_names() {
        let text = "Rss:   1768 kB\nPss:    320 kB\nPss_Dirty:   9 kB\nPss_Anon:        100 kB\n";
        let memory = parse_memory(text).unwrap();
        assert_eq!((memory.rss, memory.pss), (1768, 320));
        assert_eq!(parse_memory("Rss: 3 kB\n"), None);
    }

    #[test]
    fn this_very_process_uses_processor_and_memory() {
        let pid = std::process::id();
        assert!(cpu_ns(pid) > 0);
        assert!(memory(pid).unwrap().pss > 0);
        assert_eq!(cpu_ns(u32::MAX), 0);
    }
}
