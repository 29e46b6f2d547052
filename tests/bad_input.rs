//! Whatever is wrong with what a person asks for is said with its file, line, field, value and what
//! was expected; nothing is started, nothing is written, and the exit code tells whose fault it was.

mod support;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use rustix::process::Signal;
use support::history::History;
use support::call::Outcome;
use support::{Sandbox, wait_for_tick};

/// The smallest scenario with two sides; `cop` is driven by a program of the user's own.
const GOOD: &str = r#"[run]
seed = 5

[world]
map = "builtin:hello"

[rules]
exits = [{ circle = { center = [3.5, 0.5], radius = 0.2 } }]
time_limit = 5.0

[[robots]]
name = "thief"
team = "evader"
start = { x = 0.5, y = 0.5, theta = 0.0 }

[[robots]]
name = "cop"
team = "police"
start = { x = 0.5, y = 2.5, theta = 0.0 }

[[processes]]
kind = "evader_potential"
robots = ["thief"]

[[processes]]
kind = "pursuer"
robots = ["cop"]
params = { knowledge = "exact", assignment = { knowledge = "exact" } }
"#;

/// The scenario with one thing changed.
fn changed(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from:?}");
    GOOD.replacen(from, to, 1)
}

/// The scenario with its police driven by a program of the user's own.
fn driven_by(command: &str) -> String {
    let text = changed(
        "kind = \"pursuer\"",
        &format!("name = \"liar\"\ncommand = {command}"),
    );
    text.lines()
        .filter(|l| !l.starts_with("params"))
        .map(|l| format!("{l}\n"))
        .collect()
}

/// Calls `run` (and `check`, which must agree) on a scenario that must be refused with these words,
/// in this order, before anything starts.
#[track_caller]
fn invalid(sandbox: &Sandbox, text: impl AsRef<[u8]>, words: &[&str]) {
    sandbox.file("small.toml", text);
    refused(sandbox, &["small.toml"], words);
}

#[track_caller]
fn refused(sandbox: &Sandbox, arguments: &[&str], words: &[&str]) {
    let before = sandbox.files();
    let call = |command| sandbox.protean(std::iter::once(command).chain(arguments.iter().copied()));
    let outcome = call("run").run();
    outcome.refused(2, words);
    assert!(outcome.stderr.starts_with("error: "), "{outcome}");
    assert_eq!(sandbox.files(), before, "nothing is written");
    assert!(sandbox.runs().is_empty(), "nothing is started");
    let checked = call("check").run();
    assert_eq!(
        (checked.code, &checked.stderr),
        (Some(2), &outcome.stderr),
        "{checked}"
    );
    assert_eq!(checked.stdout, "");
}

/// As [`refused`], for arguments that only `run` has.
#[track_caller]
fn refused_by_run(sandbox: &Sandbox, arguments: &[&str], words: &[&str]) -> Outcome {
    let before = sandbox.files();
    let outcome = sandbox
        .protean(std::iter::once("run").chain(arguments.iter().copied()))
        .run();
    outcome.refused(2, words);
    assert_eq!(sandbox.files(), before, "nothing is written");
    assert!(sandbox.runs().is_empty(), "nothing is started");
    outcome
}

#[test]
fn the_scenario_that_is_broken_below_is_good() {
    let sandbox = Sandbox::new();
    sandbox.file("small.toml", GOOD);
    let summary = sandbox.protean(["run", "small.toml"]).json();
    assert_eq!(summary["ticks"], 100);
    sandbox.assert_nothing_left();
}

#[test]
fn scenarios_that_are_not_there_or_not_toml() {
    let sandbox = Sandbox::new();
    let expected = "= expected: the path of a scenario, or the name of a built-in one: `chase`";
    let words = [
        "cannot read nope.toml: No such file",
        "= value: nope.toml",
        expected,
    ];
    refused(&sandbox, &["nope.toml"], &words);
    refused(
        &sandbox,
        &["chaze"],
        &["cannot read chaze", "did you mean `chase`?"],
    );
    refused(&sandbox, &["."], &["error: "]);
    invalid(
        &sandbox,
        changed("seed = 5", "seed = "),
        &["not valid TOML", "--> small.toml:2:", "2 | seed = "],
    );
    invalid(&sandbox, [0xff, 0xfe, 0x00], &["small.toml"]);
    invalid(&sandbox, "", &["error: "]);
}

#[test]
fn keys_and_kinds_that_do_not_exist() {
    let sandbox = Sandbox::new();
    invalid(
        &sandbox,
        changed("seed = 5", "sead = 5"),
        &[
            "unknown key `sead`",
            "--> small.toml:2:1 (run.sead)",
            "2 | sead = 5",
            "= value: 5",
            "= expected: one of the keys",
            "did you mean `seed`?",
        ],
    );
    invalid(
        &sandbox,
        changed("kind = \"pursuer\"", "kind = \"persuer\""),
        &[
            "unknown process kind `persuer`",
            "--> small.toml:26:8 (processes.persuer.kind)",
            "= value: \"persuer\"",
            "= expected: ",
            "did you mean `pursuer`?",
        ],
    );
    invalid(
        &sandbox,
        changed("knowledge = \"exact\", ", "knowlege = \"exact\", "),
        &[
            "unknown key `knowlege`",
            "small.toml:28:",
            "did you mean `knowledge`?",
        ],
    );
}

#[test]
fn robots_that_are_not_there_or_stand_where_they_cannot() {
    let sandbox = Sandbox::new();
    let none = &GOOD[..GOOD.find("[[robots]]").unwrap()];
    invalid(
        &sandbox,
        none,
        &["the scenario has no robots", "at least one [[robots]]"],
    );
    invalid(
        &sandbox,
        changed("x = 0.5, y = 2.5", "x = 0.6, y = 0.5"),
        &[
            "robots `thief` and `cop` start in one place: 0.100 m apart",
            "--> small.toml:19:9 (robots.cop.start)",
            "= value: ",
            "more than 0.210 m apart",
        ],
    );
    invalid(
        &sandbox,
        changed("x = 0.5, y = 2.5", "x = 2.0, y = 0.5"),
        &[
            "robot `cop` starts in a wall",
            "--> small.toml:19:9 (robots.cop.start)",
            "= value: x = 2, y = 0.5 [m]",
            "= expected: ",
            "at least 0.105 m from every wall",
        ],
    );
    invalid(
        &sandbox,
        changed("robots = [\"cop\"]", "robots = [\"copp\"]"),
        &[
            "no robot is called `copp`",
            "--> small.toml:27:11 (processes.pursuer.robots[0])",
            "= value: \"copp\"",
            "= expected: `thief` or `cop`",
            "did you mean `cop`?",
        ],
    );
}

#[test]
fn maps_that_are_missing_broken_or_enormous() {
    let sandbox = Sandbox::new();
    let with_map = |map: &str| changed("builtin:hello", map);
    invalid(
        &sandbox,
        with_map("nope.yaml"),
        &[
            "nope.yaml: No such file",
            "--> small.toml:5:7 (world.map)",
            "= value: \"nope.yaml\"",
        ],
    );
    let yaml = |image: &str| {
        format!(
            "image: {image}\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n\
             occupied_thresh: 0.65\nfree_thresh: 0.196\n"
        )
    };
    sandbox.file("room.yaml", yaml("room.pgm"));
    invalid(
        &sandbox,
        with_map("room.yaml"),
        &["room.pgm", "small.toml:5:7 (world.map)"],
    );
    sandbox.file("room.pgm", b"P5\n80 60\n255\n\xfe\xfe\xfe");
    invalid(
        &sandbox,
        with_map("room.yaml"),
        &[
            "room.pgm",
            "truncated: 3 pixels of 80 × 60 = 4800 promised by the header",
            "--> small.toml:5:7 (world.map)",
        ],
    );
    sandbox.file("room.pgm", b"P5\n31623 31623\n255\n");
    invalid(
        &sandbox,
        with_map("room.yaml"),
        &[
            "room.pgm",
            "31623 × 31623 pixels",
            "expected at most",
            "small.toml:5:7 (world.map)",
        ],
    );
    sandbox.file("room.pgm", b"GIF89a");
    invalid(
        &sandbox,
        with_map("room.yaml"),
        &["room.pgm", "expected P2 or P5"],
    );
    sandbox.file(
        "room.toml",
        "bounds = { min = [0, 0], max = [40000, 30000] }\nresolution = 0.01\n",
    );
    invalid(&sandbox, with_map("room.toml"), &["error: ", "expected"]);
}

#[test]
fn files_outside_the_scenarios_folder() {
    let sandbox = Sandbox::new();
    let hello = include_str!("../scenarios/maps/hello.toml");
    sandbox.file("map.toml", hello);
    let escaping = |path: &str| {
        sandbox.file("inner/small.toml", changed("builtin:hello", path));
        ["inner/small.toml"]
    };
    let arguments = escaping("../map.toml");
    let words = [
        "path leads out of the scenario's folder",
        "--> inner/small.toml:5:7 (world.map)",
        "= value: \"../map.toml\"",
        "= expected: a relative path without `..`",
    ];
    refused(&sandbox, &arguments, &words);
    let absolute = sandbox.path().join("map.toml");
    let arguments = escaping(absolute.to_str().unwrap());
    refused(
        &sandbox,
        &arguments,
        &["path leads out of the scenario's folder"],
    );
    let arguments = escaping("link.toml");
    std::os::unix::fs::symlink("../map.toml", sandbox.path().join("inner/link.toml")).unwrap();
    refused(
        &sandbox,
        &arguments,
        &["path leads out of the scenario's folder, to", "map.toml"],
    );
    let allowed = sandbox
        .protean(["check", "inner/small.toml", "--allow-outside"])
        .run();
    assert_eq!(allowed.code, Some(0), "{allowed}");
}

#[test]
fn overrides_and_options_that_make_no_sense() {
    let sandbox = Sandbox::new();
    for (change, words) in [
        (
            "rules.time_limt=3",
            [
                "unknown key `time_limt`",
                "--> --set",
                "did you mean `time_limit`?",
            ],
        ),
        (
            "robots.nobody.radius=1",
            ["nobody", "--set", "= expected: "],
        ),
        (
            "run.dt=7",
            [
                "`run.dt` is out of range",
                "--set (run.dt)",
                "from 0.0001 to 1 [s]",
            ],
        ),
        (
            "run.dt",
            ["override without `=`", "--set", "key=value, for example"],
        ),
        ("run.dt=", ["error: ", "--set", "expected"]),
    ] {
        refused(&sandbox, &["hello", "--set", change], &words);
    }
    refused(&sandbox, &["hello", "--seed", "five"], &["five", "--seed"]);
    for factor in ["0", "-1", "nan", "inf", "100000"] {
        let option = format!("--real-time={factor}");
        let words = ["--real-time", "expected a factor from 0.001 to 1000"];
        refused_by_run(&sandbox, &["hello", &option], &words);
    }
    refused_by_run(
        &sandbox,
        &["hello", "--real-time=fast"],
        &["fast", "--real-time"],
    );
    refused_by_run(
        &sandbox,
        &["hello", "--log-level", "loud"],
        &["--log-level", "loud", "trace"],
    );
    let broken = sandbox
        .protean(["check", "hello", "--json", "--set", "run.dt=7"])
        .run();
    assert_eq!((broken.code, &*broken.stderr), (Some(2), ""), "{broken}");
    assert_eq!(broken.json()["ok"], false);
    let outcome = sandbox.protean(["rum"]).run();
    outcome.refused(2, &["rum", "Usage"]);
    sandbox
        .protean(["list", "--show", "chaze"])
        .run()
        .refused(2, &["\"chaze\"", "chase"]);
}

#[test]
fn programs_of_the_scenarios_own_need_permission() {
    let sandbox = Sandbox::new();
    sandbox.file("own.toml", driven_by("[\"/bin/touch\", \"was_here\"]"));
    let words = [
        "own.toml starts programs",
        "--allow-external",
        "liar: /bin/touch was_here",
    ];
    refused_by_run(&sandbox, &["own.toml"], &words);
}

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
            "said last",
            "no such planner",
        ],
    );
    assert_no_log(&sandbox);
}

#[test]
fn a_program_that_does_not_exist_is_named() {
    let sandbox = Sandbox::new();
    sandbox.file("own.toml", driven_by("[\"./no_such_planner\"]"));
    let outcome = sandbox
        .protean(["run", "own.toml", "--allow-external"])
        .run();
    outcome.refused(1, &["error: process liar: cannot be started: No such file"]);
    assert_no_log(&sandbox);
}

#[test]
fn logs_that_cannot_be_written() {
    let sandbox = Sandbox::new();
    let out = |path: &str| sandbox.protean(["run", "hello", "--out"]).arg(path).run();
    let before = sandbox.files();
    out("no/such/x.mcap").refused(1, &["cannot create the log no/such/x.mcap: No such file"]);
    assert_eq!(sandbox.files(), before);
    let folder = sandbox.path().join("folder.mcap");
    std::fs::create_dir(&folder).unwrap();
    out("folder.mcap").refused(1, &["folder.mcap is not a regular file"]);
    out("/dev/null").refused(1, &["/dev/null is not a regular file"]);

    let precious = sandbox.file("precious.mcap", "not to be lost");
    out("precious.mcap").refused(1, &["precious.mcap exists already", "overwritten"]);
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
    // Some 100 000 ticks: long enough to be in the air until it is told to land.
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
    let in_use = ["shared.mcap is being written by another run"];
    sandbox.protean(second).run().refused(1, &in_use);
    sandbox
        .protean(second)
        .arg("--force")
        .run()
        .refused(1, &in_use);
    assert!(first.is_alive());
    first.signal(Signal::INT);
    let outcome = first.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    History::read(&path);
    sandbox.assert_nothing_left();
}

#[test]
fn two_orchestrators_in_one_directory_do_not_disturb_each_other() {
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
