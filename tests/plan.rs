//! Minimum-time plans from a file of instances to lines of JSON, and over many random instances.

use std::path::{Path, PathBuf};

use crate::support::Sandbox;
use crate::support::call::Outcome;
use serde_json::{Value as Json, json};

const SMALL: &str = "base_small.json";

fn instances(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../benchmarks/instances")
        .join(name)
}

/// A sandbox with the instances of the repository.
fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    let text = std::fs::read_to_string(instances(SMALL)).unwrap();
    sandbox.file(SMALL, &text);
    sandbox
}

#[track_caller]
fn lines(outcome: &Outcome) -> Vec<Json> {
    let lines = outcome.stdout.lines();
    lines.map(|l| serde_json::from_str(l).unwrap()).collect()
}

fn numbers(list: &Json) -> Vec<f64> {
    let list = list.as_array().unwrap().iter();
    list.map(|v| v.as_f64().unwrap()).collect()
}

#[test]
fn every_instance_gets_a_valid_plan_in_the_order_of_the_file() {
    let sandbox = sandbox();
    let file: Json =
        serde_json::from_str(&std::fs::read_to_string(instances(SMALL)).unwrap()).unwrap();
    for method in ["bspline", "lp", "vmc", "tangent"] {
        let words = [
            "plan",
            SMALL,
            "--method",
            method,
            "--json",
            "--samples",
            "--quiet",
        ];
        let outcome = sandbox.protean(words).run();
        assert_eq!(outcome.code, Some(0), "{outcome}");
        assert_eq!(outcome.stderr, "");
        let plans = lines(&outcome);
        assert_eq!(plans.len(), file.as_array().unwrap().len());
        for (plan, instance) in plans.iter().zip(file.as_array().unwrap()) {
            assert_eq!(plan["id"], instance["id"]);
            assert_eq!(plan["honest"], true, "{}", plan["error"]);
            for key in [
                "t_s",
                "lower_bound_s",
                "gap",
                "cpu_ms",
                "min_clearance",
                "length",
            ] {
                assert!(plan[key].is_number(), "{key} of {}", plan["id"]);
            }
            let (t, bound) = (
                plan["t_s"].as_f64().unwrap(),
                plan["lower_bound_s"].as_f64().unwrap(),
            );
            assert!(
                (1.0 - 1e-9..1.005).contains(&(t / bound)),
                "{}: {t} {bound}",
                plan["id"]
            );
            look_at(plan, instance);
        }
    }
}

fn hypot(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// A look at the samples that shares nothing with the program: ends, speed, clearance.
#[track_caller]
fn look_at(plan: &Json, instance: &Json) {
    let samples: Vec<Vec<f64>> = plan["samples"]
        .as_array()
        .unwrap()
        .iter()
        .map(numbers)
        .collect();
    let (first, last) = (&samples[0], &samples[samples.len() - 1]);
    let at = |of: &str, key: &str| instance[of][key].as_f64().unwrap();
    assert!(hypot(first[1] - at("start", "x"), first[2] - at("start", "y")) < 1e-4);
    assert!(hypot(last[1] - at("goal", "x"), last[2] - at("goal", "y")) < 1e-4);
    assert!((last[0] - first[0] - plan["t_s"].as_f64().unwrap()).abs() < 1e-6);
    let v_max = instance["vmax_px_s"].as_f64().unwrap();
    for pair in samples.windows(2) {
        let way = hypot(pair[1][1] - pair[0][1], pair[1][2] - pair[0][2]);
        assert!(way <= v_max * 1.002 * (pair[1][0] - pair[0][0]) + 1e-9);
    }
    let buffer = instance["buffer_px"].as_f64().unwrap();
    for disc in instance["obstacles"].as_array().unwrap() {
        let [x, y, r] = ["x", "y", "r"].map(|key| disc[key].as_f64().unwrap());
        let least = samples
            .iter()
            .map(|s| hypot(s[1] - x, s[2] - y) - r - buffer);
        let least = least.fold(f64::INFINITY, f64::min);
        assert!(least >= -0.14, "{}: {least}", plan["id"]);
    }
}

#[test]
fn the_table_and_the_file_say_the_same_as_the_lines() {
    let sandbox = sandbox();
    let words = [
        "plan",
        SMALL,
        "--limit",
        "5",
        "--out",
        "plans/all.jsonl",
        "--jobs",
        "2",
    ];
    let outcome = sandbox.protean(words).run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
    assert!(outcome.stdout.contains("base_small"), "{outcome}");
    assert!(outcome.stdout.contains(" 5/5 "), "{outcome}");
    let text = std::fs::read_to_string(sandbox.path().join("plans/all.jsonl")).unwrap();
    assert_eq!(text.lines().count(), 5);
    let without_time = |text: &str| -> Vec<Json> {
        let values = text
            .lines()
            .map(|l| serde_json::from_str::<Json>(l).unwrap());
        values
            .map(|mut v| {
                v["cpu_ms"] = Json::Null;
                v
            })
            .collect()
    };
    // Plans do not depend on how many are made at once, or how often.
    let words = [
        "plan", SMALL, "--limit", "5", "--json", "--quiet", "--jobs", "1", "--repeat", "2",
    ];
    let again = sandbox.protean(words).run();
    assert_eq!(without_time(&again.stdout), without_time(&text));
    assert!(!text.contains("samples"));
    // What exists is kept, and what cannot be written leaves nothing half-written.
    sandbox.file("taken/x", "");
    let words = ["plan", SMALL, "--limit", "1", "--out", "taken", "--quiet"];
    let call = || sandbox.protean(words);
    call()
        .run()
        .refused(2, &["taken exists already", "--force"]);
    let forced = call().arg("--force").run();
    forced.refused(1, &["taken: cannot be written"]);
}

#[test]
fn the_parametrisation_asked_for_is_the_one_that_is_used() {
    let sandbox = sandbox();
    let words = [
        "plan",
        SMALL,
        "--limit",
        "3",
        "--json",
        "--quiet",
        "--method",
        "vmc",
        "--control-points",
        "9",
        "--degree",
        "4",
        "--nodes",
        "12",
        "--reference-point",
        "-1800,-1800",
        "--guess",
        "wavefront",
        "--constraints",
        "nodes",
        "--no-fallbacks",
    ];
    let outcome = sandbox.protean(words).run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
    for plan in lines(&outcome) {
        assert_eq!(plan["method"], "vmc");
        let status = plan["status"].as_str().unwrap();
        assert!(["planned", "not_honest"].contains(&status), "{plan}");
        if status == "planned" {
            assert_eq!(plan["control_points"], 9);
        }
    }
    for (words, expected) in [
        (["--degree", "99"], ["degree", "99"]),
        (["--nodes", "1"], ["nodes", "1"]),
        (["--control-points", "2"], ["control-points", "2"]),
        (
            ["--reference-point", "7"],
            ["reference-point", "-1800,-1800"],
        ),
        (["--method", "magic"], ["magic", "bspline"]),
        (["--repeat", "0"], ["repeat", "0"]),
    ] {
        let outcome = sandbox
            .protean(["plan", SMALL].into_iter().chain(words))
            .run();
        outcome.refused(2, &expected);
    }
}

#[test]
fn broken_files_are_refused_whole_and_invalid_instances_one_by_one() {
    let sandbox = sandbox();
    for (text, words) in [
        ("", ["b.json", "not JSON"]),
        ("{\"id\": 1}", ["b.json", "expected an array"]),
        ("[]", ["b.json", "empty array"]),
    ] {
        sandbox.file("b.json", text);
        let outcome = sandbox
            .protean(["plan", "b.json", "--out", "never.jsonl"])
            .run();
        outcome.refused(2, &words);
        assert!(!sandbox.path().join("never.jsonl").exists());
    }
    sandbox
        .protean(["plan", "no.json"])
        .run()
        .refused(2, &["no.json", "cannot be read"]);
    sandbox
        .protean(["plan", "."])
        .run()
        .refused(2, &["not a regular file"]);

    let file: Json =
        serde_json::from_str(&std::fs::read_to_string(instances(SMALL)).unwrap()).unwrap();
    let mut three = vec![file[0].clone(), file[1].clone(), file[2].clone()];
    three[0]["vmax_px_s"] = json!(-3);
    // A wall from one side to the other: there is no path, which is an answer.
    three[2]["obstacles"] =
        json!([{ "polygon": [[300, -20], [320, -20], [320, 500], [300, 500]] }]);
    sandbox.file("three.json", Json::from(three.clone()).to_string());
    let outcome = sandbox.protean(["plan", "three.json", "--json"]).run();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    let id = three[0]["id"].as_str().unwrap();
    let expected = format!("three.json: {id}: vmax_px_s = -3: expected a number > 0 (px/s)");
    assert!(outcome.stderr.contains(&expected), "{outcome}");
    let plans = lines(&outcome);
    let status = |i: usize| plans[i]["status"].as_str().unwrap();
    assert_eq!(
        [status(0), status(1), status(2)],
        ["invalid", "planned", "no_path"]
    );
    assert_eq!(plans[2]["t_s"], Json::Null);
    assert_eq!(plans[2]["honest"], Json::Null);
    assert!(plans[2]["error"].is_string());
    sandbox.file("wall.json", Json::from(vec![three[2].clone()]).to_string());
    let outcome = sandbox.protean(["plan", "wall.json"]).run();
    assert_eq!(outcome.code, Some(0), "no path is an answer: {outcome}");
}

#[test]
fn instances_follow_from_recipe_and_seed_and_can_be_planned() {
    let sandbox = Sandbox::new();
    let made = |words: &[&str]| {
        let words = ["plan", "generate"]
            .into_iter()
            .chain(words.iter().copied());
        let outcome = sandbox.protean(words).run();
        assert_eq!(outcome.code, Some(0), "{outcome}");
        outcome.stdout
    };
    let five = made(&["t4b", "--count", "5", "--seed", "3"]);
    assert_eq!(five, made(&["t4b", "--count", "5", "--seed", "3"]));
    let list: Json = serde_json::from_str(&five).unwrap();
    let one: Json = serde_json::from_str(&made(&["t4b", "--count", "1", "--seed", "7"])).unwrap();
    assert_eq!(list[4], one[0], "an instance follows from its own seed");
    assert_eq!(
        made(&["dense", "--count", "4", "--out", "i/dense.json"]),
        "i/dense.json\n"
    );
    let outcome = sandbox
        .protean(["plan", "i/dense.json", "--json", "--quiet"])
        .run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
    let file = std::fs::read_to_string(sandbox.path().join("i/dense.json")).unwrap();
    let file: Json = serde_json::from_str(&file).unwrap();
    for (plan, instance) in lines(&outcome).iter().zip(file.as_array().unwrap()) {
        let feasible = instance["reference"]["feasible"] == true;
        assert_eq!(plan["status"] == "no_path", !feasible);
        if feasible {
            assert_eq!(plan["lower_bound_s"], instance["reference"]["t_lb_s"]);
        }
    }
    let outcome = sandbox.protean(["plan", "generate", "nonsense"]).run();
    outcome.refused(2, &["nonsense", "base"]);
}

const SWEEP: &str = r#"
kind = "planning"
title = "Small"
seeds = { first = 1, count = 5 }
[[cases]]
name = "lp"
set.options = { method = "lp" }
[[cases]]
name = "vmc"
set.options = { method = "vmc", control_points = 8, fallbacks = false }
[parameters.discs]
levels.few = { instances.obstacles = [1, 10] }
levels.many = { instances.obstacles = [30, 40] }
[grid]
discs = ["few", "many"]
"#;

#[test]
fn a_sweep_of_plans_is_the_same_however_it_is_shared_out() {
    let sandbox = Sandbox::new();
    sandbox.file("plans.toml", SWEEP);
    let sweep = |words: &[&str]| {
        let words = ["sweep"].into_iter().chain(words.iter().copied());
        sandbox.protean(words).run()
    };
    let table =
        |out: &str| std::fs::read_to_string(sandbox.path().join(out).join("results.csv")).unwrap();
    let outcome = sweep(&[
        "plans.toml",
        "--jobs",
        "1",
        "--out",
        "whole",
        "--json",
        "--quiet",
    ]);
    assert_eq!(outcome.code, Some(0), "{outcome}");
    let summary = outcome.json();
    assert_eq!(
        (&summary["carried_out"], &summary["missing"]),
        (&20.into(), &0.into())
    );
    assert_eq!(summary["cells"][0]["plans"], 5);
    for shard in ["1/3", "2/3", "3/3"] {
        let outcome = sweep(&["plans.toml", "--shard", shard, "--quiet"]);
        assert_eq!(outcome.code, Some(0), "{outcome}");
    }
    let parts = ["1", "2", "3"].map(|i| format!("results/plans/shard-{i}-of-3"));
    let partial = sweep(&["merge", &parts[0], &parts[1], "--out", "some"]);
    assert_eq!(partial.code, Some(3), "{partial}");
    let merged = sweep(&["merge", &parts[0], &parts[1], &parts[2], "--out", "merged"]);
    assert_eq!(merged.code, Some(0), "{merged}");
    assert!(merged.stdout.contains("95 % interval"), "{merged}");
    assert_eq!(table("merged"), table("whole"));
    // What is done is not done again; the same tasks can be taken over.
    let again = sweep(&["plans.toml", "--out", "whole", "--json", "--quiet"]).json();
    assert_eq!(
        (&again["carried_out"], &again["known"]),
        (&0.into(), &20.into())
    );
    let reused = sweep(&[
        "plans.toml",
        "--out",
        "r",
        "--reuse",
        "whole",
        "--json",
        "--quiet",
    ])
    .json();
    assert_eq!(reused["carried_out"], 0);
    assert_eq!(table("r"), table("whole"));
    let dry = sweep(&["plans.toml", "--out", "new", "--dry-run", "--json"]).json();
    assert_eq!(dry["missions"].as_array().unwrap().len(), 20);
    assert!(!sandbox.path().join("new").exists());
    sweep(&["plans.toml", "--keep-logs", "all"]).refused(2, &["--keep-logs", "plans have no logs"]);
}
