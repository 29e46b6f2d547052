//! Invalid input: the error names file, line, field, value and expectation; no process starts, no file is
//! written, and the exit code distinguishes bad input from a failed run.

mod failing_runs;
mod routes;

use crate::support::Sandbox;
use crate::support::call::Outcome;

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
    let params = text.find("params").unwrap();
    text[..params].to_owned()
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
    let expected = "= expected: the path of a scenario, or a built-in scenario: one of `chase`";
    let words = [
        "nope.toml: cannot be read: No such file",
        "= value: nope.toml",
        expected,
    ];
    refused(&sandbox, &["nope.toml"], &words);
    refused(
        &sandbox,
        &["chaze"],
        &["chaze: cannot be read", "did you mean `chase`?"],
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
            "= expected: one of `",
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
            "= value: x = 2, y = 0.5 (m)",
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
            "= expected: one of `thief`, `cop`",
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
            "nope.yaml: cannot be read: No such file",
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
            "truncated: 3 pixels of 80 × 60 = 4800 declared in the header",
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
            "robots.unknown.radius=1",
            ["unknown", "--set", "= expected: "],
        ),
        (
            "run.dt=7",
            [
                "`run.dt` is out of range",
                "--set (run.dt)",
                "between 0.0001 and 1 (s)",
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
        .protean(["new", "mine.toml", "--from", "chaze"])
        .run()
        .refused(2, &["\"chaze\"", "chase"]);
}

#[test]
fn programs_of_the_scenarios_own_need_permission() {
    let sandbox = Sandbox::new();
    sandbox.file("own.toml", driven_by("[\"/bin/touch\", \"was_here\"]"));
    let words = [
        "own.toml starts external programs",
        "--allow-external",
        "liar: /bin/touch was_here",
    ];
    refused_by_run(&sandbox, &["own.toml"], &words);
}

#[test]
fn a_new_scenario_runs_and_is_not_overwritten_unasked() {
    let sandbox = Sandbox::new();
    for name in scenario::builtin::SCENARIOS.map(|built_in| built_in.name) {
        let file = format!("own/{name}.toml");
        let made = sandbox.protean(["new", &file, "--from", name]).run();
        assert_eq!(made.code, Some(0), "{made}");
        assert!(made.stderr.contains(&format!(" run {file}")), "{made}");
        for written in made.stdout.lines() {
            assert!(sandbox.path().join(written).is_file(), "{written}");
        }
        let checked = sandbox.protean(["check", &file]).run();
        assert_eq!(checked.code, Some(0), "{checked}");
    }
    sandbox.file("own/hello.toml", "mine");
    let again = ["new", "own/hello.toml", "--from", "hello"];
    let refused = sandbox.protean(again).run();
    refused.refused(2, &["own/hello.toml", "--force"]);
    let kept = std::fs::read_to_string(sandbox.path().join("own/hello.toml")).unwrap();
    assert_eq!(kept, "mine");
    let forced = sandbox.protean(again).arg("--force").run();
    assert_eq!(forced.code, Some(0), "{forced}");
    let checked = sandbox.protean(["check", "own/hello.toml"]).run();
    assert_eq!(checked.code, Some(0), "{checked}");
    let refused = sandbox.protean(["new", "own"]).run();
    refused.refused(2, &["own", ".toml"]);
}
