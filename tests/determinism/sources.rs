//! Sources of what steers: no clock, no thread, no random numbers of the system, no question about the processor.
//!
//! Clippy cannot forbid these in some crates only: the orchestrator needs clocks and threads.

use std::path::{Path, PathBuf};

/// Folders of code that steers.
const FOLDERS: [&str; 3] = ["algorithms", "processes", "sim_backend"];

/// Words that bring something into a history that scenario and seed do not determine.
const WORDS: [&str; 19] = [
    "Instant",
    "SystemTime",
    "clock_gettime",
    "monotonic_ns",
    "thread::",
    "thread_local",
    "mpsc",
    "rayon",
    "par_iter",
    "RandomState",
    "thread_rng",
    "rand::rng",
    "from_os_rng",
    "OsRng",
    "getrandom",
    "is_x86_feature_detected",
    "target_feature",
    "available_parallelism",
    "env::var",
];

/// Files and folders that may, and the reason why no history in lock-step depends on it.
const ALLOWED: [(&str, &str); 13] = [
    (
        "algorithms/navigation/src/tangent_graph/search.rs",
        "buffers of a search, emptied at its start",
    ),
    (
        "processes/library_planner/src/library.rs",
        "whether this program can load libraries",
    ),
    (
        "processes/library_planner/src/entry.rs",
        "the path of its configuration, or the question for its declaration",
    ),
    (
        "processes/optimiser/src/service/",
        "threads that each plan alone; deadlines of requests in real time; CPU time in the log",
    ),
    (
        "processes/planner/src/main_function.rs",
        "the path of its configuration",
    ),
    (
        "processes/ros2_bridge/src/",
        "deadlines of the nodes of ROS 2: a late command ends the run; the thread of the participant",
    ),
    (
        "processes/runtime/src/guard.rs",
        "the end of a process whose run has ended",
    ),
    (
        "processes/runtime/src/life.rs",
        "latencies; the cores of a process",
    ),
    (
        "processes/runtime/src/lockstep/",
        "waits for turns, which end a run or nothing",
    ),
    ("processes/runtime/src/logging.rs", "the level of log lines"),
    (
        "processes/runtime/src/service_client.rs",
        "the warning of a long wait",
    ),
    ("processes/runtime/src/status.rs", "the time of heartbeats"),
    (
        "processes/simulator/src/process/loops.rs",
        "the pace of a run and latencies; real time",
    ),
];

/// Returns the lines (from 1) of a source, without its comments and the tests at its end, that have a word, with the text.
fn findings(source: &str) -> Vec<(usize, &str)> {
    let code = source
        .split("#[cfg(test)]\nmod ")
        .next()
        .unwrap_or_default();
    let lines = (1..).zip(code.lines().map(str::trim));
    let has_word = |line: &str| {
        WORDS.iter().any(|word| {
            line.match_indices(word).any(|(at, _)| {
                let before = line[..at].chars().next_back();
                !before.is_some_and(|c| c.is_alphanumeric() || c == '_')
            })
        })
    };
    lines
        .filter(|(_, line)| !line.starts_with("//") && has_word(line))
        .collect()
}

fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            if !["target", "tests", "benches", "examples"].contains(&name.as_str()) {
                sources(&path, into);
            }
        } else if path.extension().is_some_and(|end| end == "rs") && name != "tests.rs" {
            into.push(path);
        }
    }
}

#[test]
fn nothing_that_steers_asks_the_machine() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let root = root.canonicalize().unwrap();
    let mut files = Vec::new();
    for folder in FOLDERS {
        sources(&root.join(folder), &mut files);
    }
    files.sort();
    assert!(files.len() > 200, "{} files", files.len());
    let (mut faults, mut used) = (Vec::new(), Vec::new());
    for path in files {
        let name = path.strip_prefix(&root).unwrap().to_str().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        for (line, text) in findings(&text) {
            let mut allowed = ALLOWED.iter();
            match allowed.position(|(file, _)| name.starts_with(file)) {
                Some(entry) => used.push(entry),
                None => faults.push(format!("{name}:{line}: {text}")),
            }
        }
    }
    assert!(
        faults.is_empty(),
        "scenario and seed do not determine this (docs/reference/determinism.md):\n{}",
        faults.join("\n")
    );
    for (entry, (file, _)) in ALLOWED.iter().enumerate() {
        assert!(used.contains(&entry), "take it off the list: {file}");
    }
}

#[test]
fn each_word_is_found_in_a_planted_source() {
    for word in WORDS {
        let planted = format!("fn steer() {{\n    let x = std::{word}();\n}}\n");
        assert_eq!(findings(&planted).len(), 1, "{planted}");
        assert_eq!(findings(&format!("// {word}\n")), [], "{word}");
        let test = format!("#[cfg(test)]\nmod tests {{\n    use {word};\n}}\n");
        assert_eq!(findings(&test), [], "{test}");
    }
    assert_eq!(findings("let an_Instant = read_thread::x;\n"), []);
}
