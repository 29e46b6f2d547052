//! `protean branch` and `protean decided`: what precedes a branch is its parent's history, with processes or in one thread.

use crate::support::Sandbox;

/// Scenarios of 6 s with beliefs, trees, requests to the optimiser, obstacles that appear, verdicts, laps and areas.
const SCENARIOS: [&str; 8] = [
    "chase",
    "chase_rrt_star",
    "chase_referee",
    "chase_popup",
    "popup",
    "patrol_square",
    "patrol_graph",
    "coverage_polygons",
];

#[test]
fn a_branch_without_a_change_equals_its_parent_and_others_do_up_to_their_moment() {
    let sandbox = Sandbox::new();
    let mut draw = 12_345_u64;
    for scenario in SCENARIOS {
        let run = format!(
            "run {scenario} --in-process --quiet --force --out a.mcap --set rules.time_limit=6"
        );
        let run = sandbox.protean(run.split(' ')).run();
        assert_eq!(run.code, Some(0), "{run}");
        let info = sandbox
            .protean("info a.mcap --json".split(' '))
            .run()
            .json();
        let end_s = info["end_s"].as_f64().unwrap();
        for change in ["", " --reseed all", " --reseed all --seed 2"] {
            draw = draw.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            // A multiple of every tick period.
            let at_s = (draw >> 33) % (end_s * 5.0 - 1.0) as u64;
            let at_s = at_s as f64 / 5.0;
            let words = format!("branch a.mcap --at {at_s} --force --out b.mcap --json{change}");
            let branch = sandbox.protean(words.split(' ')).run();
            assert_eq!(branch.code, Some(0), "{scenario} {words}: {branch}");
            let report = branch.json();
            assert_eq!(report["same"], true, "{scenario} {words}: {branch}");
            if change.is_empty() {
                assert_eq!(
                    report["branch_digest"], info["digest"],
                    "{scenario}: {branch}"
                );
            }
            let verified = sandbox.protean("verify b.mcap --quiet".split(' ')).run();
            assert_eq!(verified.code, Some(0), "{scenario} {words}: {verified}");
        }
    }
}

#[test]
fn a_command_changes_the_history_from_its_moment_on_and_not_before() {
    let sandbox = Sandbox::new();
    // A log of processes.
    let run = "run chase --quiet --out a.mcap --set rules.time_limit=6";
    let run = sandbox.protean(run.split(' ')).run();
    assert_eq!(run.code, Some(0), "{run}");
    let branch = "branch a.mcap --at 3 --command police_1=-0.1,1 --for 1";
    let branch = sandbox.protean(branch.split(' ')).run();
    assert_eq!(branch.code, Some(0), "{branch}");
    assert!(branch.stdout.contains("identical to a.mcap"), "{branch}");
    let difference = "diff a.mcap a-branch-3.00.mcap --json";
    let difference = sandbox.protean(difference.split(' ')).run();
    assert_eq!(difference.code, Some(1), "{difference}");
    let report = difference.json();
    let first = report["first"]["time_s"].as_f64().unwrap();
    assert!((3.0..3.5).contains(&first), "{difference}");
    assert_eq!(
        report["first"]["causes"][0]["process"], "simulator",
        "{difference}"
    );
    let info = sandbox.protean(["info", "a-branch-3.00.mcap"]).run();
    assert!(
        info.stdout.contains("branch      of a.mcap from 3.00 s on"),
        "{info}"
    );
    for words in [
        "branch a.mcap --at 3.01",
        "branch a.mcap --at 9",
        "branch a.mcap --at 3 --set run.seed=4",
        "branch a.mcap --at 3 --reseed unknown",
        "decided a.mcap --moments 0",
        "decided a.mcap --share 1",
    ] {
        sandbox
            .protean(words.split(' '))
            .run()
            .refused(2, &["expected"]);
    }
}

#[test]
fn outcomes_of_continuations_are_the_same_in_any_number_of_threads() {
    let sandbox = Sandbox::new();
    let run = "run chase_exact --in-process --quiet --out a.mcap --set rules.time_limit=6";
    let run = sandbox.protean(run.split(' ')).run();
    assert_eq!(run.code, Some(0), "{run}");
    let times = "branch a.mcap --at 4 --times 3 --json";
    let report = sandbox.protean(times.split(' ')).run().json();
    assert_eq!(report["robots"][4]["outcomes"][0]["count"], 3, "{report}");
    let decided = |jobs: &str| {
        let words = "decided a.mcap --moments 2 --times 2 --share 0.5 --json --force --csv shares.csv --jobs";
        let outcome = sandbox.protean(words.split(' ')).arg(jobs).run();
        assert_eq!(outcome.code, Some(0), "{outcome}");
        outcome.json()
    };
    let one = decided("1");
    assert_eq!(one, decided("3"));
    assert_eq!(one["decisions"][0]["outcome"], "timed_out", "{one}");
}
