//! Causes of a difference: the processes that answered the same inputs otherwise.

use std::collections::BTreeSet;

use recorder::RunInfo;

/// Returns the processes, among those whose messages differ in the first tick with a difference, that received the same
/// inputs in both runs.
///
/// All messages before that tick are equal. In it, a process has received the messages of the orchestrator, of the
/// simulator, and of the processes that it waits for; other messages of the tick count from the next one on.
pub fn causes(run: &RunInfo, differing: &BTreeSet<String>) -> BTreeSet<String> {
    let name = |index: u32| {
        let mut processes = run.processes.iter();
        processes.find(|process| process.index == index)
    };
    let is_cause = |process: &String| {
        let mut processes = run.processes.iter();
        let Some(info) = processes.find(|info| info.name == *process) else {
            return true;
        };
        let upstream = info.upstream.iter().filter_map(|&index| name(index));
        let before = run.processes.iter().filter(|other| {
            other.kind == "orchestrator" || other.kind == "simulator" && info.kind != "orchestrator"
        });
        let mut inputs = upstream
            .chain(before)
            .filter(|other| other.name != *process);
        !inputs.any(|other| differing.contains(&other.name))
    };
    differing
        .iter()
        .filter(|process| is_cause(process))
        .cloned()
        .collect()
}

#[cfg(test)]
mod tests {
    use recorder::ProcessInfo;

    use super::*;

    #[test]
    fn a_process_with_other_inputs_is_no_cause() {
        let kinds: [(&str, &[u32]); 6] = [
            ("simulator", &[]),
            ("perception", &[]),
            ("pursuer", &[1]),
            ("tracker", &[2]),
            ("evader", &[]),
            ("orchestrator", &[]),
        ];
        let run = RunInfo {
            processes: (0..)
                .zip(kinds)
                .map(|(index, (kind, upstream))| ProcessInfo {
                    index,
                    name: format!("the_{kind}"),
                    kind: kind.to_owned(),
                    upstream: upstream.to_vec(),
                })
                .collect(),
            ..RunInfo::default()
        };
        let causes_of = |differing: &[&str]| {
            let differing = differing.iter().map(|kind| format!("the_{kind}")).collect();
            let causes = causes(&run, &differing);
            causes
                .iter()
                .map(|name| name["the_".len()..].to_owned())
                .collect::<Vec<_>>()
        };
        assert_eq!(
            causes_of(&["perception", "pursuer", "tracker"]),
            ["perception"]
        );
        assert_eq!(causes_of(&["tracker", "evader"]), ["evader", "tracker"]);
        assert_eq!(
            causes_of(&["simulator", "evader", "perception"]),
            ["simulator"]
        );
        assert_eq!(causes_of(&["simulator", "orchestrator"]), ["orchestrator"]);
        assert_eq!(causes_of(&["unknown", "pursuer"]), ["pursuer", "unknown"]);
    }
}
