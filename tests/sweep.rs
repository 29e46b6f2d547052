//! Experiments from the command to the table: with any faults on the way, however many missions
//! run at once and however they are shared out, the table is the same.

mod engines;
mod failures;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

use crate::support::call::Outcome;
use crate::support::{SOON, Sandbox, until};
use rustix::process::Signal;
use serde_json::Value as Json;

/// Two cases, two values, three seeds: twelve short missions.
const SMALL: &str = r#"
scenario = "builtin:hello"
seeds = { first = 1, count = 3 }

[[cases]]
name = "plain"
set.run.pin = "one_core"

[[cases]]
name = "shy"
set.defaults.robot.start_jitter = { x = 0.1, y = 0.1 }

[parameters.limit]
title = "time limit [s]"
set = "rules.time_limit"

[grid]
limit = [1.5, 3]
"#;

const MISSIONS: usize = 12;

fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.file("small.toml", SMALL);
    sandbox
}

/// `protean sweep small.toml --out OUT …`.
#[track_caller]
fn sweep(sandbox: &Sandbox, out: &str, more: &[&str]) -> Outcome {
    let words = ["sweep", "small.toml", "--out", out];
    sandbox
        .protean(words.into_iter().chain(more.iter().copied()))
        .run()
}

#[track_caller]
fn sweep_json(sandbox: &Sandbox, out: &str, more: &[&str], code: i32) -> Json {
    let more: Vec<&str> = more.iter().copied().chain(["--json", "--quiet"]).collect();
    let outcome = sweep(sandbox, out, &more);
    assert_eq!(outcome.code, Some(code), "{outcome}");
    outcome.json()
}

#[track_caller]
fn table(sandbox: &Sandbox, out: &str) -> String {
    std::fs::read_to_string(sandbox.path().join(out).join("results.csv")).unwrap()
}

/// Lines of the journal that are complete.
fn recorded(path: &Path) -> usize {
    std::fs::read(path.join("journal.jsonl")).map_or(0, |bytes| {
        let lines = bytes.split_inclusive(|&b| b == b'\n');
        lines.filter(|line| line.ends_with(b"\n")).count()
    })
}

/// The table of a sweep that nothing happened to: with processes, one mission after the other.
#[track_caller]
fn undisturbed() -> &'static str {
    static TABLE: OnceLock<String> = OnceLock::new();
    TABLE.get_or_init(|| {
        let sandbox = sandbox();
        let summary = sweep_json(&sandbox, "undisturbed", &["--jobs", "1"], 0);
        assert_eq!(summary["carried_out"], MISSIONS);
        sandbox.assert_nothing_left();
        table(&sandbox, "undisturbed")
    })
}

#[test]
fn the_table_does_not_depend_on_how_many_missions_run_at_once() {
    let sandbox = sandbox();
    let table_of_one = undisturbed();
    let summary = sweep_json(&sandbox, "three", &["--jobs", "3"], 0);
    assert_eq!(table(&sandbox, "three"), table_of_one);
    assert_eq!(table_of_one.lines().count(), 1 + MISSIONS);
    assert!(table_of_one.starts_with("case,limit,seed,outcome,evaders,escaped,caught,held_out,"));
    assert!(
        table_of_one.contains("\nplain,1.5,1,time_limit,1,0,0,1,1.5,"),
        "{table_of_one}"
    );
    let cells = summary["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 4);
    assert_eq!(cells[0]["games"], 3);
    assert_eq!(cells[0]["wilson_95"][0], 0.0);
    // A finished mission is never carried out again.
    let again = sweep_json(&sandbox, "three", &[], 0);
    assert_eq!(
        (&again["carried_out"], &again["known"]),
        (&0.into(), &MISSIONS.into())
    );
    sandbox.assert_nothing_left();
}

#[test]
fn a_row_is_what_the_same_mission_alone_results_in() {
    let sandbox = sandbox();
    let outcome = sweep(&sandbox, "out", &["--seeds", "2..2"]);
    assert_eq!(outcome.code, Some(0), "{outcome}");
    let text = table(&sandbox, "out");
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    let last = reader.records().last().unwrap().unwrap();
    let field = |name: &str| {
        let column = header.iter().position(|h| h == name).unwrap();
        last[column].to_owned()
    };
    assert_eq!(
        (field("case"), field("limit"), field("seed")),
        ("shy".into(), "3.0".into(), "2".into())
    );
    let words = [
        "run",
        "hello",
        "--set",
        "defaults.robot.start_jitter={ x = 0.1, y = 0.1 }",
        "--set",
        "rules.time_limit=3",
        "--seed",
        "2",
        "--quiet",
    ];
    let alone = sandbox.protean(words).json();
    assert_eq!(alone["digest"], field("digest"));
    assert_eq!(alone["ticks"].to_string(), field("ticks"));
    let path = sandbox.path().join("out/robots.csv");
    let mut robots = csv::Reader::from_path(path).unwrap();
    let robots = robots.deserialize().map(Result::unwrap);
    let last: BTreeMap<String, String> = robots.last().unwrap();
    let joined = ["case", "limit", "seed"].map(|name| last[name].clone());
    assert_eq!(joined, ["shy", "3.0", "2"]);
    let robot = &alone["robots"][0];
    assert_eq!(robot["name"], last["robot"]);
    assert_eq!(robot["outcome"], last["outcome"]);
    assert_eq!(robot["distance_m"].to_string(), last["distance_m"]);
    assert_eq!(robot["contacts"].to_string(), last["contacts"]);
}

#[test]
fn a_killed_sweep_goes_on_where_it_was() {
    let sandbox = sandbox();
    let whole = undisturbed();
    let out = sandbox.path().join("killed");
    let words = [
        "sweep",
        "small.toml",
        "--out",
        "killed",
        "--jobs",
        "2",
        "--quiet",
    ];
    let running = sandbox.protean(words).start();
    until("some missions", SOON, || {
        (recorded(&out) >= 3).then_some(())
    });
    running.signal(Signal::KILL);
    assert_eq!(running.finish().code, None);
    let done = recorded(&out);
    assert!((3..MISSIONS).contains(&done), "{done}");
    // The machine may have failed in the middle of a line.
    let journal = out.join("journal.jsonl");
    let mut bytes = std::fs::read(&journal).unwrap();
    bytes.extend_from_slice(b"{\"cell\":0,\"se");
    std::fs::write(&journal, bytes).unwrap();
    let outcome = sweep(&sandbox, "killed", &["--json"]);
    assert_eq!(outcome.code, Some(0), "{outcome}");
    assert!(
        outcome
            .stderr
            .contains("the line was incomplete or changed"),
        "{outcome}"
    );
    assert_eq!(outcome.json()["known"], done);
    assert_eq!(outcome.json()["carried_out"], MISSIONS - done);
    assert_eq!(table(&sandbox, "killed"), whole);
    sandbox.assert_nothing_left();
}

#[test]
fn ctrl_c_keeps_what_is_done() {
    let sandbox = sandbox();
    let out = sandbox.path().join("stopped");
    let words = [
        "sweep",
        "small.toml",
        "--out",
        "stopped",
        "--jobs",
        "1",
        "--quiet",
        "--json",
    ];
    let running = sandbox.protean(words).start();
    until("a mission", SOON, || (recorded(&out) >= 1).then_some(()));
    running.signal(Signal::INT);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    let summary = outcome.json();
    assert_eq!(summary["interrupted"], true);
    let done = recorded(&out);
    assert_eq!(summary["carried_out"], done);
    assert!((1..MISSIONS).contains(&done), "{done}");
    // One mission of every cell comes before the second of any: no cell has two games more than another.
    let games = |cell: &Json| cell["games"].as_u64().unwrap();
    let games: Vec<u64> = summary["cells"]
        .as_array()
        .unwrap()
        .iter()
        .map(games)
        .collect();
    assert!(games[0] - games[3] <= 1, "{games:?}");
    assert_eq!(
        summary["missing"].as_array().unwrap().len(),
        MISSIONS - done
    );
    assert_eq!(table(&sandbox, "stopped").lines().count(), 1 + done);
    sandbox.assert_nothing_left();
    sweep_json(&sandbox, "stopped", &["--in-process"], 0);
    assert_eq!(table(&sandbox, "stopped"), undisturbed());
}

#[test]
fn shards_merge_to_the_table_of_the_whole() {
    let sandbox = sandbox();
    let whole = undisturbed();
    let take = |shard: &[&str]| {
        let words = ["sweep", "small.toml", "--in-process", "--quiet", "--shard"];
        let words = words.into_iter().chain(shard.iter().copied());
        sandbox.protean(words).run()
    };
    for shard in ["1/3", "3/3"] {
        let outcome = take(&[shard, "--json"]);
        assert_eq!(outcome.code, Some(0), "{outcome}");
        assert_eq!(outcome.json()["carried_out"], MISSIONS / 3);
    }
    let part = |n: u32| format!("results/small/shard-{n}-of-3");
    let (one, two, three) = (part(1), part(2), part(3));
    let merge = |parts: &[&str]| {
        let words = ["sweep", "merge"].into_iter().chain(parts.iter().copied());
        sandbox.protean(words.chain(["--out", "merged"])).run()
    };
    let outcome = merge(&[&three, &one]);
    assert_eq!(outcome.code, Some(3), "{outcome}");
    assert!(
        outcome.stdout.contains("4 missions are missing"),
        "{outcome}"
    );
    assert!(
        outcome.stdout.contains("case plain, limit = 1.5: seeds 2"),
        "{outcome}"
    );
    assert_eq!(take(&["2/3"]).code, Some(0));
    let outcome = merge(&[&two]);
    assert_eq!(outcome.code, Some(0), "{outcome}");
    assert_eq!(table(&sandbox, "merged"), whole);
    let summary = sweep_json(&sandbox, "at_once", &["--in-process"], 0);
    assert_eq!(summary["carried_out"], MISSIONS);
    for name in ["results", "robots", "predictions", "adversaries"] {
        for extension in ["csv", "parquet"] {
            let of = |out: &str| {
                let path = sandbox.path().join(out).join(format!("{name}.{extension}"));
                std::fs::read(path).unwrap()
            };
            assert!(of("merged") == of("at_once"), "{name}.{extension}");
        }
    }
    assert_eq!(merge(&[&one]).code, Some(0));
    // What was merged can be gone on with.
    let summary = sweep_json(&sandbox, "merged", &["--seeds", "1..4", "--in-process"], 0);
    assert_eq!(summary["carried_out"], MISSIONS / 3);
}

#[test]
fn results_of_another_experiment_are_refused_and_kept() {
    let sandbox = sandbox();
    sweep_json(&sandbox, "out", &["--seeds", "1"], 0);
    let before = table(&sandbox, "out");
    sandbox.file("small.toml", SMALL.replace("[1.5, 3]", "[1.5, 4]"));
    sweep(&sandbox, "out", &[]).refused(
        2,
        &[
            "error: out contains the results of another experiment",
            "compare its experiment.toml",
            "choose another --out",
        ],
    );
    assert_eq!(table(&sandbox, "out"), before);
}

#[test]
fn a_wrong_call_is_refused_before_anything_runs() {
    let sandbox = sandbox();
    for (more, words) in [
        (
            &["--seeds", "3..1"][..],
            "--seeds: \"3..1\" is not a range of seeds",
        ),
        (&["--shard", "4/3"], "--shard: \"4/3\" is not a shard"),
        (
            &["--set", "rules.time_limit=9"],
            "--set sets `rules.time_limit`, which parameter `limit` sets too",
        ),
        (
            &["--set", "rules.time_limt=9"],
            "did you mean `time_limit`?",
        ),
    ] {
        sweep(&sandbox, "out", more).refused(2, &[words]);
    }
    sandbox
        .protean(["sweep"])
        .run()
        .refused(2, &["<EXPERIMENT>"]);
    sandbox
        .protean(["sweep", "nowhere.toml"])
        .run()
        .refused(2, &["nowhere.toml"]);
    sandbox
        .protean(["sweep", "merge", "nowhere", "--out", "out"])
        .run()
        .refused(2, &["nowhere is not a directory of results"]);
    assert_eq!(sandbox.files(), [sandbox.path().join("small.toml")]);
}

#[test]
fn a_dry_run_lists_the_missions_and_runs_none() {
    let sandbox = sandbox();
    let outcome = sweep(&sandbox, "out", &["--dry-run", "--shard", "2/6"]);
    assert_eq!(outcome.code, Some(0), "{outcome}");
    assert_eq!(
        outcome.stdout,
        "case plain, limit = 1.5, seed 2\ncase shy, limit = 1.5, seed 2\n"
    );
    let json = sweep(&sandbox, "out", &["--dry-run", "--json"]).json();
    assert_eq!(json["missions"].as_array().unwrap().len(), MISSIONS);
    assert_eq!(json["missions"][11]["set"][2], "rules.time_limit=3");
    assert!(!sandbox.path().join("out").exists());
}

#[test]
fn two_sweeps_do_not_share_a_directory() {
    let sandbox = sandbox();
    let running = sandbox.sweep_in_order().start();
    until("the first sweep", Duration::from_secs(20), || {
        sandbox
            .path()
            .join("out/journal.jsonl")
            .exists()
            .then_some(())
    });
    sweep(&sandbox, "out", &[]).refused(2, &["out: another sweep uses the directory"]);
    running.signal(Signal::INT);
    assert_eq!(running.finish().code, Some(3));
}
