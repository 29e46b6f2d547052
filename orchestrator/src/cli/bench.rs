//! `protean bench`.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::{EXIT_FAILED, EXIT_PARTIAL, print, print_json};
use crate::bench::{self, Item, Options};
use crate::signals;

/// What `--help` says after the options.
pub const HELP: &str = "\
Items (all of them without a name):
  chase       real-time factor of the scenario `chase`, recorder on, several seeds, on all processors
              and pinned to one (baseline: real time at 20 Hz); latency of every hop; CPU time per
              tick of every process
  start       time to the first tick and its parts; memory of every process (PSS, RSS); log written
              per simulated second
  ticks       lock-step ticks/s of 8 trivial planner processes over the kit (baseline: the same
              exchange on bare iceoryx2 and a futex page), on all processors and pinned to one
  hop         one message of 64 B to 1 MiB from one polling process to another (baseline: the same
              bytes on bare iceoryx2), p50 and p99
  in-process  games/s of one core with `run --in-process` in a sweep, CPU per tick (baseline: the same
              games with processes, one at a time)
  recorder    the messages of a chase written into a log, MB per second of CPU (baseline: the same
              messages by the mcap crate alone, compressed alike); CPU per tick of a chase in one
              process with a log (baseline: without), and the log's share of it
  world, visibility, filter, turn, publish, recorder-parts
              print the command of the Criterion bench that measures them inside one process

The table has a line per figure: the median with the extremes of the repetitions, the baseline
measured in the same run, the ratio to it (median over pairs measured back to back), the goal.
With --json, one object: version, machine, load, interrupted, figures: [{item, name, value, min, max,
unit, baseline: {name, value} or null, ratio, goal, met}], errors: [{item, error}], commands.
Progress goes to stderr. Exit code: 0 measured (whether or not goals are met), 1 an item failed,
3 interrupted. Figures are of this machine with whatever else it is doing: look at the load.";

/// What is measured elsewhere: item and command.
const ELSEWHERE: [(&str, &str); 6] = [
    ("world", "cargo bench -p benchmarks --bench world"),
    ("visibility", "cargo bench -p benchmarks --bench visibility"),
    (
        "filter",
        "cargo bench -p benchmarks --bench particle_filter",
    ),
    ("turn", "cargo bench -p benchmarks --bench turn"),
    ("publish", "cargo bench -p benchmarks --bench publish"),
    (
        "recorder-parts",
        "cargo bench -p benchmarks --bench recorder",
    ),
];

/// The names that the command line takes.
pub fn names() -> Vec<&'static str> {
    Item::ALL
        .iter()
        .map(|item| item.name())
        .chain(ELSEWHERE.iter().map(|(name, _)| *name))
        .collect()
}

/// Measures the named items, or all of them.
pub fn bench(names: &[String], quick: bool, as_json: bool) -> ExitCode {
    let wanted = |name: &str| names.is_empty() || names.iter().any(|n| n == name);
    let items: Vec<Item> = Item::ALL
        .into_iter()
        .filter(|item| wanted(item.name()))
        .collect();
    let commands: Vec<_> = ELSEWHERE.iter().filter(|(name, _)| wanted(name)).collect();
    let interrupted = Arc::new(AtomicBool::new(false));
    // Without a handler a signal ends the bench at once; what it leaves, `protean clean` removes.
    let _ = signals::interrupt(&interrupted);
    ipc_types::bus::quiet_transport();
    let options = Options { quick, interrupted };
    let report = bench::run(&items, &options, |what| eprintln!("measuring {what}"));
    if as_json {
        let mut json = report.json();
        json["commands"] = commands
            .iter()
            .map(|(name, command)| serde_json::json!({ "item": name, "command": command }))
            .collect();
        print_json(&json);
    } else {
        let mut text = String::new();
        if !items.is_empty() {
            text += &report.text();
        }
        if !commands.is_empty() {
            text += "\nMeasured inside one process, with their baselines, in the source tree:";
            for (name, command) in commands {
                text += &format!("\n  {name:14} {command}");
            }
        }
        print(text.trim_start());
    }
    if report.interrupted {
        ExitCode::from(EXIT_PARTIAL)
    } else if report.errors.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(EXIT_FAILED)
    }
}
