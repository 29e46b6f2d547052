//! Missions back to back, watched from outside.

use serde_json::Value as Json;

use crate::support::Sandbox;
use crate::support::programs::driven_by;

#[test]
fn missions_come_again_and_again_and_nothing_is_left() {
    let sandbox = Sandbox::new();
    let call = sandbox
        .protean([
            "soak",
            "hello",
            "--minutes",
            "0.03",
            "--out",
            "soaked",
            "--json",
        ])
        .run();
    // Whether so short a soak is flat is not for a test to say; all else is.
    let report: Json = serde_json::from_str(&call.stdout).unwrap();
    let missions = report["missions"].as_u64().unwrap();
    assert!(missions >= 2, "{report}");
    assert_eq!(report["failures"], 0, "{report}");
    assert_eq!(report["leftovers"], 0, "{report}");
    assert_eq!(report["interrupted"], false);
    assert_eq!(
        call.code,
        Some(i32::from(report["flat"] != true)),
        "{report}"
    );

    let rows = std::fs::read_to_string(sandbox.path().join("soaked/soak.csv")).unwrap();
    let processes = |name: &str| rows.lines().filter(|l| l.contains(name)).count() as u64;
    assert_eq!(processes(",orchestrator,"), missions, "{rows}");
    assert!(processes(",simulator,") > 0, "{rows}");
    let svg = std::fs::read_to_string(sandbox.path().join("soaked/soak.svg")).unwrap();
    roxmltree::Document::parse(&svg).unwrap();
    assert!(sandbox.path().join("soaked/soak.svg").exists());
    assert!(!sandbox.path().join("logs").exists(), "logs are not kept");
}

#[test]
fn a_mission_that_fails_is_named() {
    let sandbox = Sandbox::new();
    let broken = driven_by("nobody", r#"command = ["false"]"#);
    sandbox.file("broken.toml", broken);
    let arguments = ["soak", "broken.toml", "--minutes", "0.001"];
    let refused = sandbox.protean(arguments).run();
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    assert!(
        refused.stderr.contains("--allow-external"),
        "{}",
        refused.stderr
    );
    let words = arguments.into_iter().chain(["--allow-external"]);
    let failed = sandbox.protean(words).run();
    assert_eq!(failed.code, Some(1), "{}", failed.stderr);
    assert!(failed.stdout.contains("1 failed"), "{}", failed.stdout);
    assert!(failed.stdout.contains("nobody"), "{}", failed.stdout);
}

#[test]
fn values_out_of_range_are_named() {
    let sandbox = Sandbox::new();
    for (flag, value) in [("--minutes", "nan"), ("--seeds", "0"), ("--real-time", "0")] {
        let call = sandbox.protean(["soak", "hello", flag, value]).run();
        assert_eq!(call.code, Some(2), "{}", call.stderr);
        assert!(call.stderr.contains(&format!("{flag} ")), "{}", call.stderr);
        assert!(call.stderr.contains("expected"), "{}", call.stderr);
    }
}

#[test]
fn what_was_seen_is_judged_again() {
    let sandbox = Sandbox::new();
    let row = |number: u32, bytes: u32| {
        format!("{number},chase,1,{number},1,orchestrator,1,{bytes},6,,,40,,\n")
    };
    let head = "mission,scenario,seed,begun_s,lasted_s,process,samples,memory_bytes,descriptors,\
                early_bytes,late_bytes,segments,leftovers,failure\n";
    let judged = |bytes: fn(u32) -> u32| {
        let rows: String = (0..40).map(|n| row(n, bytes(n))).collect();
        sandbox.file("soak.csv", format!("{head}{rows}"));
        sandbox.protean(["soak", "--read", "soak.csv"]).run()
    };
    let level = judged(|_| 10_000_000);
    assert_eq!(level.code, Some(0), "{level}");
    assert!(level.stdout.contains("40 missions"), "{level}");
    let leak = judged(|n| 10_000_000 + 100_000 * n);
    assert_eq!(leak.code, Some(1), "{leak}");
    assert!(leak.stdout.contains("GREW"), "{leak}");
    sandbox.file("soak.csv", format!("{head}0,chase,1,never\n"));
    let refused = sandbox.protean(["soak", "--read", "soak.csv"]).run();
    assert_eq!(refused.code, Some(2), "{refused}");
    assert!(refused.stderr.contains("soak.csv: "), "{refused}");
    assert!(refused.stderr.contains("line: 2"), "{refused}");
    // Nothing was seen: that is not flat.
    for nothing in [head, ""] {
        sandbox.file("soak.csv", nothing);
        let refused = sandbox.protean(["soak", "--read", "soak.csv"]).run();
        assert_eq!(refused.code, Some(2), "{refused}");
        assert!(
            refused.stderr.contains("soak.csv: no missions in it"),
            "{refused}"
        );
    }
}
