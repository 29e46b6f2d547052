//! Faults that a check of the scenario cannot find: programs and files that fail when the run starts.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use rustix::process::Signal;

use super::driven_by;
use crate::support::history::History;
use crate::support::{Sandbox, wait_for_tick};

/// Asserts that nothing is left, not even a log: a run that never began has none.
#[track_caller]
fn assert_no_log(sandbox: &Sandbox) {
    let logs: Vec<PathBuf> = sandbox
        .files()
        .into_iter()
        .filter(|path| path.extension().is_some_and(|e| e == "mcap"))
        .collect();
    assert_eq!(logs, [] as [PathBuf; 0]);
    sandbox.assert_nothing_left();
}

#[test]
fn a_process_that_ends_at_once_is_named() {
    let sandbox = Sandbox::new();
    sandbox.file("own.toml", driven_by("[\"/bin/false\"]"));
    let outcome = sandbox
        .protean(["run", "own.toml", "--allow-external", "--json"])
        .run();
    outcome.refused(
        1,
        &["error: process liar ended with exit code 1 before it was ready"],
    );
    assert_no_log(&sandbox);

    let talkative = "[\"/bin/sh\", \"-c\", \"echo no such planner >&2; exit 7\"]";
    sandbox.file("own.toml", driven_by(talkative));
    let words = ["run", "own.toml", "--allow-external", "--out", "own.mcap"];
    let outcome = sandbox.protean(words).run();
    outcome.refused(
        1,
        &[
            "process liar ended with exit code 7",
            "last output",
            "no such planner",
        ],
    );
    assert_no_log(&sandbox);
}

#[test]
fn a_program_that_does_not_exist_is_named() {
    let sandbox = Sandbox::new();
    sandbox.file("own.toml", driven_by("[\"./no_such_planner\"]"));
    sandbox.file("text.txt", "no program");
    for (program, words) in [
        (
            "./no_such_planner",
            ["/./no_such_planner: No such", "program"],
        ),
        (
            "no_such_planner",
            ["`no_such_planner` in PATH: No such", "program"],
        ),
        (
            "./text.txt",
            ["/./text.txt: Permission denied", "executable"],
        ),
    ] {
        sandbox.file("own.toml", driven_by(&format!("[\"{program}\"]")));
        let outcome = sandbox
            .protean(["run", "own.toml", "--allow-external"])
            .run();
        // Nothing was started.
        outcome.refused(
            2,
            &[
                "error: process liar cannot be started: ",
                words[0],
                words[1],
            ],
        );
        assert_no_log(&sandbox);
    }
}

#[test]
fn a_limit_of_the_shell_is_named_with_the_failure() {
    let sandbox = Sandbox::new();
    // As a process ends whose allocation fails.
    let aborts = driven_by("[\"/bin/sh\", \"-c\", \"kill -ABRT $$\"]");
    sandbox.file("aborts.toml", aborts);
    for (scenario, limit, value, failure) in [
        ("hello", "-f", "10", "error: "),
        ("hello", "-v", "300000", "error: "),
        ("aborts.toml", "-v", "9000000", "was ended by signal 6"),
    ] {
        let script = "ulimit \"$0\" \"$1\" && shift && exec \"$@\"";
        let call = sandbox.protean(["run", scenario, "--allow-external"]);
        let outcome = call.through("sh", &["-c", script, limit, value]).run();
        let named = format!("`ulimit {limit}`");
        outcome.refused(1, &[failure, "note: the shell limits the size of", &named]);
    }
    sandbox.assert_nothing_left();
}

#[test]
fn logs_that_cannot_be_written() {
    let sandbox = Sandbox::new();
    let out = |path: &str| sandbox.protean(["run", "hello", "--out"]).arg(path).run();
    let before = sandbox.files();
    out("no/such/x.mcap").refused(2, &["no/such/x.mcap: cannot be created: No such file"]);
    assert_eq!(sandbox.files(), before);
    let folder = sandbox.path().join("folder.mcap");
    std::fs::create_dir(&folder).unwrap();
    out("folder.mcap").refused(2, &["folder.mcap is not a regular file"]);
    out("/dev/null").refused(2, &["/dev/null is not a regular file"]);

    let precious = sandbox.file("precious.mcap", "not to be lost");
    out("precious.mcap").refused(2, &["precious.mcap exists already", "--force"]);
    assert_eq!(std::fs::read(&precious).unwrap(), b"not to be lost");
    let forced = sandbox
        .protean(["run", "hello", "--out", "precious.mcap", "--force"])
        .run();
    assert_eq!(forced.code, Some(0), "{forced}");
    assert!(!History::read(&precious).states.is_empty());
    sandbox.assert_nothing_left();
}

#[test]
fn a_runtime_directory_that_is_not_there_is_named() {
    let sandbox = Sandbox::new();
    let missing = sandbox.path().join("none");
    let outcome = sandbox
        .protean(["run", "hello"])
        .runtime_dir(&missing)
        .run();
    outcome.refused(
        1,
        &["run directory: ", missing.to_str().unwrap(), "No such file"],
    );
    assert!(!sandbox.path().join("logs").exists());
}

#[test]
fn a_log_that_another_run_is_writing_is_left_alone() {
    let sandbox = Sandbox::new();
    // About 100 000 ticks: the run lasts until the test ends it.
    let words = [
        "run",
        "hello",
        "--set",
        "run.dt=0.0002",
        "--out",
        "shared.mcap",
    ];
    let mut first = sandbox.protean(words).start();
    let path = sandbox.path().join("shared.mcap");
    wait_for_tick(&sandbox.next_run(&BTreeSet::new()), 5);
    let second = ["run", "hello", "--out", "shared.mcap"];
    let exists = ["shared.mcap exists already"];
    sandbox.protean(second).run().refused(2, &exists);
    let in_use = ["shared.mcap is being written by another run"];
    sandbox
        .protean(second)
        .arg("--force")
        .run()
        .refused(2, &in_use);
    assert!(first.is_alive());
    first.signal(Signal::INT);
    let outcome = first.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    History::read(&path);
    sandbox.assert_nothing_left();
}

#[test]
fn two_orchestrators_in_one_directory_run_independently() {
    let sandbox = Sandbox::new();
    let call = || {
        sandbox
            .protean(["run", "hello", "--json", "--quiet"])
            .start()
    };
    let runs = [call(), call(), call()];
    let summaries = runs.map(|run| {
        let outcome = run.finish();
        assert_eq!(outcome.code, Some(0), "{outcome}");
        outcome.json()
    });
    let mut logs: Vec<&str> = summaries
        .iter()
        .map(|s| s["log"].as_str().unwrap())
        .collect();
    logs.sort_unstable();
    assert_eq!(
        logs,
        [
            "logs/hello-1-2.mcap",
            "logs/hello-1-3.mcap",
            "logs/hello-1.mcap"
        ]
    );
    let states = |log: &str| History::read(&sandbox.path().join(Path::new(log))).states;
    assert_eq!(states(logs[0]), states(logs[1]));
    assert_eq!(states(logs[1]), states(logs[2]));
    assert_eq!(sandbox.runs().len(), 3);
    sandbox.assert_nothing_left();
}
