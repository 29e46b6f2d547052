//! External programs: their output, folder, parameters, failures and restarts.

use std::collections::BTreeSet;

use crate::chaos::{Fault, inject};
use crate::support::call::PATIENCE;
use crate::support::history::{History, State};
use crate::support::programs::{as_program, driven_by};
use crate::support::{PROTEAN, SOON, Sandbox, until, wait_for_tick};

/// Writes to stdout; its panic is followed by a long backtrace.
const PANICKING: &str = r#"
echo "in $(pwd)"
{ echo "thread 'main' panicked at src/main.rs:7:9:"; echo "no way out"; echo "stack backtrace:"; seq 100; } >&2
exit 101
"#;

#[test]
fn a_program_runs_beside_its_scenario_and_its_output_is_shown_with_its_panic() {
    let sandbox = Sandbox::new();
    sandbox.file("far/away/panicking.sh", PANICKING);
    let program = r#"command = ["/bin/sh", "away/panicking.sh"]"#;
    sandbox.file("far/own.toml", driven_by("own", program));
    let words = ["run", "far/own.toml", "--allow-external"];
    let outcome = sandbox.protean(words).run();
    let folder = format!("[own] in {}\n", sandbox.path().join("far").display());
    let error = "error: process own ended with exit code 101";
    let (panic, message) = ("\n    thread 'main' panicked at", "\n    no way out");
    outcome.refused(1, &[&folder, "[own] 100\n", error, panic, message]);
    let quiet = sandbox.protean(words).arg("--quiet").run();
    quiet.refused(1, &[error, panic, message, "\n    …\n", "\n    100"]);
    for outcome in [outcome, quiet] {
        assert_eq!(
            outcome.stderr.matches("\n    99").count() + outcome.stderr.matches("[own] 99").count(),
            1,
            "{outcome}"
        );
    }

    let program = r#"command = ["./panicking.sh"]
folder = "away""#;
    let path = sandbox.file("far/away/panicking.sh", format!("#!/bin/sh\n{PANICKING}"));
    let mode = std::os::unix::fs::PermissionsExt::from_mode(0o755);
    std::fs::set_permissions(path, mode).unwrap();
    sandbox.file("far/own.toml", driven_by("own", program));
    let outcome = sandbox.protean(words).run();
    let folder = format!("[own] in {}\n", sandbox.path().join("far/away").display());
    outcome.refused(1, &[&folder, error]);
    sandbox.assert_nothing_left();
}

#[test]
fn an_external_program_has_the_presets_of_its_planner() {
    let sandbox = Sandbox::new();
    let digest = |lines: &str| {
        sandbox.file("own.toml", driven_by("own", lines));
        let run = ["run", "own.toml", "--allow-external", "--force"];
        let summary = sandbox.protean(run).json();
        summary["digest"].as_str().unwrap().to_owned()
    };
    let params = r#"{ preset = "paper", feedback = { omega_cap = 0.5 } }"#;
    let kind = "evader_potential";
    let built_in = digest(&format!("kind = \"{kind}\"\nparams = {params}"));
    assert_eq!(digest(&as_program(kind, params)), built_in);
    assert_ne!(digest(&as_program(kind, "{}")), built_in);

    let unknown = as_program(kind, r#"{ preset = "papre" }"#);
    sandbox.file("own.toml", driven_by("own", &unknown));
    let outcome = sandbox
        .protean(["run", "own.toml", "--allow-external"])
        .run();
    let words = ["parameters of own", "no preset \"papre\"", "one of paper"];
    outcome.refused(1, &words);
    sandbox.assert_nothing_left();
}

#[test]
fn an_external_program_that_the_scenario_does_not_provide_for_ends_the_run_before_its_first_tick() {
    let sandbox = Sandbox::new();
    let optimiser = "\n[[processes]]\nkind = \"optimiser\"";
    for (kind, more, words) in [
        (
            "pursuer",
            "",
            [
                "reads perception/belief, but no process writes it",
                "a kind that writes it",
            ],
        ),
        (
            "evader_braitenberg",
            "",
            ["but robot `robot` has no range scanner", "`scan`"],
        ),
        (
            "navigator",
            "",
            [
                "reads answers of optimiser/plan, but no process",
                "a kind that writes it",
            ],
        ),
        (
            "navigator",
            optimiser,
            ["but robot `robot` has none", "`goal`"],
        ),
    ] {
        let lines = as_program(kind, "{}") + more;
        sandbox.file("own.toml", driven_by("own", &lines));
        let outcome = sandbox
            .protean(["run", "own.toml", "--allow-external"])
            .run();
        let process = format!("own (kind {kind})");
        outcome.refused(1, &["before it was ready", &process, words[0], words[1]]);
    }
    sandbox.assert_nothing_left();
}

/// Writes the scenario `own.toml`, in which `./planner` drives the robot to an exit.
fn prepare(sandbox: &Sandbox) {
    std::os::unix::fs::symlink(PROTEAN, sandbox.path().join("planner")).unwrap();
    let lines = as_program("evader_potential", "{}").replace(PROTEAN, "./planner");
    sandbox.file("own.toml", driven_by("own", &lines));
}

#[test]
fn an_external_program_that_is_killed_is_started_again_and_rejoins() {
    let sandbox = Sandbox::new();
    prepare(&sandbox);
    let words = [
        "run",
        "own.toml",
        "--allow-external",
        "--json",
        "--quiet",
        "--out",
        "run.mcap",
        "--real-time",
        "2",
    ];
    let running = sandbox
        .protean(words)
        .set("processes.own.on_failure=restart")
        .set(PATIENCE)
        .start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, 20);
    sandbox.kill_and_await_successor("./planner");
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    let summary = outcome.json();
    let told = &summary["processes"][0];
    assert_eq!(
        (&told["name"], &told["restarts"]),
        (&"own".into(), &1.into())
    );
    let outage = &told["outages"][0];
    assert_eq!(outage["reason"], "was ended by signal 9", "{told}");
    let tick = |key: &str| outage[key].as_u64().unwrap();
    let (left, back) = (tick("left_tick"), tick("back_tick"));
    assert!(left < back, "{outage}");

    // Its robot stands meanwhile, and is driven again once it is back.
    let history = History::read(&sandbox.path().join("run.mcap"));
    let stands = |state: &&State| state.robots[0].fail_safe;
    let first = history.states.iter().find(stands).unwrap();
    assert!((left..back).contains(&first.tick), "tick {}", first.tick);
    let moved = history.states.last().unwrap().robots[0].distance - first.robots[0].distance;
    assert!(moved > 0.1, "{moved} m");
    assert_eq!(history.counts["process/event"].0, 2, "left and back");
    sandbox.assert_nothing_left();
}

#[test]
fn an_external_program_may_be_treated_badly() {
    let sandbox = Sandbox::new();
    prepare(&sandbox);
    let words = ["run", "own.toml"];
    let refused = sandbox.protean(words).run();
    refused.refused(2, &["own.toml", "--allow-external", "own:"]);
    // So slow that it has not ended when the process is found.
    let call = || {
        sandbox
            .protean(words)
            .args(["--allow-external", "--pace", "2"])
    };
    let digest = call().arg("--quiet").json()["digest"].clone();
    let target = || {
        until("the planner", SOON, || {
            let mut all = sandbox.processes().into_iter();
            all.find(|process| process.name == "./planner")
                .map(|process| process.pid)
        })
    };
    for (fault, tick) in [(Fault::Pause, 20), (Fault::Kill, 20), (Fault::Kill, 0)] {
        inject(&sandbox, call(), (fault, "own", tick), target, &digest);
    }
}
