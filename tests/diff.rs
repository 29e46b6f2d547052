//! `protean diff`: runs with processes and in one thread are equal; a changed scenario is named.

use crate::support::Sandbox;

#[test]
fn a_log_of_processes_equals_that_of_one_thread_and_a_changed_key_is_named() {
    let sandbox = Sandbox::new();
    let words = "run chase --quiet --out a.mcap --set rules.time_limit=2";
    let run = sandbox.protean(words.split(' ')).run();
    assert_eq!(run.code, Some(0), "{run}");
    let same = "diff a.mcap chase --set rules.time_limit=2";
    let same = sandbox.protean(same.split(' ')).run();
    assert_eq!(same.code, Some(0), "{same}");
    assert!(same.stdout.ends_with("histories  equal\n"), "{same}");

    let changed = "diff a.mcap chase --json --set rules.time_limit=2 --set-b processes.perception.params.filter.particles=90";
    let changed = sandbox.protean(changed.split(' ')).run();
    assert_eq!(changed.code, Some(1), "{changed}");
    let report = changed.json();
    let keys = report["scenario"].as_array().unwrap();
    let keys: Vec<_> = keys
        .iter()
        .map(|change| change["key"].as_str().unwrap())
        .collect();
    assert_eq!(keys, ["processes.perception.params.filter.particles"]);
    let causes = report["first"]["causes"].as_array().unwrap();
    assert!(
        causes.iter().all(|cause| cause["process"] == "perception"),
        "{changed}"
    );
    assert_eq!(causes[0]["topic"], "perception/belief");
}

#[test]
fn scenario_files_seeds_and_the_scenario_of_a_log_are_sides() {
    let sandbox = Sandbox::new();
    for (file, speed) in [("city.toml", "0.3"), ("other.toml", "0.05")] {
        let printed = sandbox
            .protean(["check", "chase", "--print"])
            .set("rules.time_limit=1")
            .set(&format!("teams.evader.limits.v_max={speed}"))
            .run();
        assert_eq!(printed.code, Some(0), "{printed}");
        sandbox.file(file, &printed.stdout);
    }
    let run = "run city.toml --in-process --quiet --out a.mcap --seed 1";
    assert_eq!(sandbox.protean(run.split(' ')).run().code, Some(0));
    for (words, key) in [
        (
            "diff city.toml other.toml --json",
            "robots.evader_1.limits.v_max",
        ),
        ("diff city.toml --seed-b 2 --json", "run.seed"),
        ("diff a.mcap --seed-b 2 --json", "run.seed"),
        (
            "diff a.mcap --set-b teams.evader.limits.v_max=0.1 --json",
            "robots.evader_1.limits.v_max",
        ),
    ] {
        let changed = sandbox.protean(words.split(' ')).run();
        assert_eq!(changed.code, Some(1), "{changed}");
        let report = changed.json();
        let keys = report["scenario"].as_array().unwrap();
        assert_eq!(keys[0]["key"], key, "{changed}");
        let causes = report["first"]["causes"].as_array().unwrap();
        assert!(!causes.is_empty(), "{changed}");
        let metrics = report["results"].as_array().unwrap();
        assert!(!metrics.is_empty(), "{changed}");
    }
    let same = sandbox.protean("diff a.mcap --seed-b 1".split(' ')).run();
    assert_eq!(same.code, Some(0), "{same}");
}

#[test]
fn sides_that_cannot_be_compared_are_refused() {
    let sandbox = Sandbox::new();
    let words = "run hello --quiet --out a.mcap --set rules.time_limit=1";
    assert_eq!(sandbox.protean(words.split(' ')).run().code, Some(0));
    for (words, expected) in [
        ("diff a.mcap a.mcap --seed 2", "a.mcap is a log"),
        ("diff a.mcap --set-b rules.time_limit=1", "changes nothing"),
        ("diff a.mcap chse", "did you mean `chase`"),
        ("diff chase --set rules.timelimit=1", "time_limit"),
    ] {
        let refused = sandbox.protean(words.split(' ')).run();
        assert_eq!(refused.code, Some(2), "{refused}");
        assert!(refused.stderr.contains(expected), "{refused}");
    }
}
