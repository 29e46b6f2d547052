//! Missions one after the other in one orchestrator: nothing of it grows, and nothing is left.

use crate::support::{SOON, Sandbox, until};

/// Missions, and those of them for warming up.
const MISSIONS: usize = 200;
const WARM_UP: usize = 50;

/// Resident memory of its own in kilobytes, and open descriptors of a process.
fn held(pid: u32) -> Option<(u64, u64)> {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    let memory = status.lines().find_map(|l| l.strip_prefix("RssAnon:"))?;
    let memory = memory.split_whitespace().next()?.parse().ok()?;
    let descriptors = std::fs::read_dir(format!("/proc/{pid}/fd")).ok()?.count();
    Some((memory, descriptors as u64))
}

/// The middle one of the values.
fn median(values: impl Iterator<Item = u64>) -> u64 {
    let mut values: Vec<u64> = values.collect();
    values.sort_unstable();
    values[values.len() / 2]
}

#[test]
#[ignore = "20 s alone, minutes on a busy machine: docs/how-to/faults.md says how to run it"]
fn an_orchestrator_of_many_missions_does_not_grow() {
    let sandbox = Sandbox::new();
    let experiment =
        format!("scenario = \"builtin:hello\"\nseeds = {{ first = 1, count = {MISSIONS} }}\n");
    sandbox.file("many.toml", experiment);
    let words = ["sweep", "many.toml", "--jobs", "1", "--keep-logs", "all"];
    let running = sandbox.protean(words).arg("--out").arg("swept").start();
    let journal = sandbox.path().join("swept/journal.jsonl");
    let mut seen = Vec::new();
    while seen.len() < MISSIONS {
        let sample = until("the next mission", SOON, || {
            let done = std::fs::read_to_string(&journal).unwrap_or_default();
            let is_next = done.lines().count() > seen.len();
            is_next.then(|| held(running.pid()))
        });
        // After the last mission it may be gone.
        let Some(sample) = sample else { break };
        seen.push(sample);
    }
    assert_eq!(running.finish().code, Some(0));
    assert!(seen.len() + 1 >= MISSIONS, "{} missions", seen.len());

    let (early, late) = seen[WARM_UP..].split_at((seen.len() - WARM_UP) / 2);
    let memory = |part: &[(u64, u64)]| median(part.iter().map(|&(memory, _)| memory));
    let (before, after) = (memory(early), memory(late));
    assert!(
        after <= before + before / 10,
        "{before} KiB, then {after} KiB"
    );
    let descriptors = |part: &[(u64, u64)]| median(part.iter().map(|&(_, count)| count));
    assert_eq!(descriptors(early), descriptors(late), "descriptors");
    sandbox.assert_nothing_left();
}
