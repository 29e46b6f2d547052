//! Branches of runs with external programs, which are children of the program that branches.

use std::collections::BTreeSet;

use rustix::process::Signal;

use crate::support::programs::{as_program, driven_by};
use crate::support::sandbox::{signal, stop};
use crate::support::{PROTEAN, SOON, Sandbox, until, wait_for_tick};

/// Scenarios with built-in kinds as external programs, which declare nothing: with beliefs of a process that stays built in, with
/// several programs, and with requests to the optimiser and obstacles that appear.
fn scenarios() -> [String; 2] {
    let mut chase =
        include_str!("../../scenarios/chase.toml").replace("params = { assignment", "# ");
    for robot in ["police_2", "police_3", "police_4", "evader_2"] {
        let team = robot.split('_').next().unwrap();
        let lines = format!("[[robots]]\nname = \"{robot}\"\nteam = \"{team}\"\n");
        chase = chase.replace(&lines, "");
    }
    for kind in ["pursuer", "evader_potential"] {
        let lines = format!("name = \"own_{kind}\"\n{}\n", as_program(kind, "{}"));
        chase = chase.replace(&format!("kind = \"{kind}\"\n"), &lines);
    }
    let lp = "{ plan = { method = \"lp\" } }";
    let built_in = format!("kind = \"navigator\"\nrobots = [\"scout\"]\nparams = {lp}\n");
    let program = format!(
        "name = \"own\"\nrobots = [\"scout\"]\n{}\n",
        as_program("navigator", lp)
    );
    let popup = include_str!("../../scenarios/popup.toml").replace(&built_in, &program);
    [chase, popup]
}

/// Writes the scenario `own.toml`, in which `./planner` drives a robot for long, and records it.
fn record(sandbox: &Sandbox, more: &[&str]) {
    std::os::unix::fs::symlink(PROTEAN, sandbox.path().join("planner")).unwrap();
    let lines = as_program("evader_potential", "{}").replace(PROTEAN, "./planner");
    let own = driven_by("own", &lines);
    sandbox.file(
        "own.toml",
        own.replace("[rules]", "[run]\ndt = 0.001\n[rules]"),
    );
    let run = sandbox.protean(["run", "own.toml", "--allow-external", "--out", "a.mcap"]);
    let run = run.args(more.iter().copied()).run();
    assert_eq!(run.code, Some(0), "{run}");
}

/// Waits until the program of [`record`] steps in a run that is not `known`; returns its process id.
fn planner(sandbox: &Sandbox, known: &BTreeSet<String>) -> u32 {
    wait_for_tick(&sandbox.next_run(known), 5);
    let mut all = sandbox.processes().into_iter();
    let planner = all.find(|process| process.name == "./planner");
    planner.unwrap().pid
}

#[test]
fn a_run_with_external_programs_has_one_history_with_processes_in_one_thread_and_in_a_branch() {
    let sandbox = Sandbox::new();
    sandbox.file(
        "maps/city.toml",
        include_str!("../../scenarios/maps/city.toml"),
    );
    for scenario in scenarios() {
        sandbox.file("own.toml", scenario);
        let call = |words: &str| {
            let words = format!("{words} --allow-external --quiet");
            sandbox.protean(words.split(' ')).json()
        };
        let run = call("run own.toml --set rules.time_limit=6 --force --out a.mcap");
        let local = call("run own.toml --set rules.time_limit=6 --force --out b.mcap --in-process");
        assert_eq!(local["digest"], run["digest"]);
        assert_eq!(call("verify a.mcap --in-process")["same"], true);
        let nothing = call("branch a.mcap --at 3 --force --out b.mcap");
        assert_eq!(nothing["branch_digest"], run["digest"], "{nothing}");
        let robot = run["robots"][0]["name"].as_str().unwrap();
        for change in [
            "--set rules.time_limit=7".to_owned(),
            format!("--command {robot}=0.05,0.3"),
            "--reseed all".to_owned(),
        ] {
            let branch = call(&format!(
                "branch a.mcap --at 3 --force --out b.mcap {change}"
            ));
            assert_eq!(branch["same"], true, "{change}: {branch}");
            let verified = call("verify b.mcap");
            assert_eq!(verified["same"], true, "{change}: {verified}");
            assert_eq!(verified["digest"], branch["branch_digest"], "{change}");
        }
        sandbox.assert_nothing_left();
    }
}

#[test]
fn continuations_with_external_programs_are_branches_from_the_start() {
    let sandbox = Sandbox::new();
    let [chase, _] = scenarios();
    sandbox.file(
        "maps/city.toml",
        include_str!("../../scenarios/maps/city.toml"),
    );
    sandbox.file("own.toml", chase);
    let call = |words: &str| {
        let words = format!("{words} --allow-external --quiet");
        sandbox.protean(words.split(' ')).json()
    };
    call("run own.toml --set rules.time_limit=2 --out a.mcap");
    call("branch a.mcap --at 1 --times 2 --keep-logs kept");
    for seed in ["1", "2"] {
        let branch = call(&format!(
            "branch a.mcap --at 1 --reseed all --seed {seed} --force --out b.mcap"
        ));
        let kept = format!("kept/{seed}.mcap");
        let kept = sandbox.protean(["info", &kept]).json();
        assert_eq!(kept["digest"], branch["branch_digest"], "{seed}");
    }
    let before = sandbox.runs().len();
    call("branch a.mcap --at 1 --reseed all --force --out b.mcap");
    let per_run = sandbox.runs().len() - before;
    let before = sandbox.runs().len();
    let report = call("decided a.mcap --moments 1 --times 4 --share 0.5");
    let moments = report["moments"].as_array().unwrap();
    assert_eq!(moments[0]["continuations"], 4, "{report}");
    // The verified run and the continuations have names of their own, although copies of a process draw the same random numbers:
    // what removes an ended run must not meet a later one.
    let runs = 1 + report["continuations"].as_u64().unwrap() as usize;
    assert_eq!(sandbox.runs().len() - before, runs * per_run);
    sandbox.assert_nothing_left();
}

#[test]
fn an_external_program_that_dies_or_hangs_in_a_branch_is_named_and_nothing_is_left() {
    let sandbox = Sandbox::new();
    record(&sandbox, &["--set", "run.hang_timeout_s=1"]);
    let branch = || {
        let known = sandbox.runs();
        let words = "branch a.mcap --at 1 --force --out b.mcap --allow-external";
        (sandbox.protean(words.split(' ')).start(), known)
    };
    let (running, known) = branch();
    signal(planner(&sandbox, &known), Signal::KILL);
    running
        .finish()
        .refused(1, &["process own was ended by signal 9"]);
    sandbox.assert_nothing_left();
    let (running, known) = branch();
    stop(planner(&sandbox, &known));
    running
        .finish()
        .refused(1, &["process own did not answer for 1s"]);
    sandbox.assert_nothing_left();
    for (signal, code) in [(Signal::INT, Some(3)), (Signal::KILL, None)] {
        let (running, known) = branch();
        planner(&sandbox, &known);
        running.signal(signal);
        let outcome = running.finish();
        assert_eq!(outcome.code, code, "{outcome}");
        until("the end of the planner", SOON, || {
            sandbox.processes().is_empty().then_some(())
        });
        sandbox.protean(["clean"]).run();
        sandbox.assert_nothing_left();
    }
    std::fs::remove_file(sandbox.path().join("planner")).unwrap();
    std::fs::remove_file(sandbox.path().join("b.mcap")).unwrap();
    branch()
        .0
        .finish()
        .refused(1, &["process own", "not found"]);
    assert!(!sandbox.path().join("b.mcap").exists());
    sandbox.assert_nothing_left();
}

#[test]
fn continuations_with_external_programs_that_are_interrupted_leave_nothing() {
    let sandbox = Sandbox::new();
    record(&sandbox, &[]);
    let known = sandbox.runs();
    let words = "branch a.mcap --at 1 --times 1000 --jobs 2 --allow-external";
    let running = sandbox.protean(words.split(' ')).start();
    // The run that verifies the log, and two continuations.
    planner(&sandbox, &known);
    planner(&sandbox, &sandbox.runs());
    running.signal(Signal::INT);
    running.finish().refused(3, &["interrupted"]);
    sandbox.assert_nothing_left();
}
