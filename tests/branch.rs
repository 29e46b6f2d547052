//! `protean branch` and `protean decided`: what precedes a branch is its parent's history, with processes or in one thread.

mod external_programs;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::{Duration, Instant};

use rustix::process::Signal;
use serde_json::{Value as Json, json};

use crate::package;
use crate::support::browser::browse;
use crate::support::sandbox::signal;
use crate::support::{SOON, Sandbox, skipped, until, wait_for_tick};

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

/// Records 6 s of a scenario, or of one with programs in Python, and branches it at moments that follow from `draw`: without a
/// change, with other streams, and with a command. Each branch must be its parent before its moment, and to the end without a
/// change. Returns the number of branches.
fn branch_at_random(
    sandbox: &Sandbox,
    scenario: &str,
    python: Option<&Path>,
    draw: &mut u64,
) -> u64 {
    let call = |words: &str| {
        let call = sandbox.protean(words.split(' '));
        match python {
            Some(python) => call.arg("--allow-external").first_in_path(python).run(),
            None => call.run(),
        }
    };
    let way = if python.is_none() {
        "--in-process "
    } else {
        ""
    };
    let mut next = |below: u64| {
        *draw = draw.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (*draw >> 33) % below
    };
    let run = format!(
        "run {scenario} {way}--quiet --force --out a.mcap --set rules.time_limit=6 --seed {}",
        next(1000)
    );
    let run = call(&run);
    assert_eq!(run.code, Some(0), "{run}");
    let info = sandbox
        .protean("info a.mcap --json".split(' '))
        .run()
        .json();
    let end_s = info["end_s"].as_f64().unwrap();
    let robots = info["robots"].as_array().unwrap();
    let robot = &robots[next(robots.len() as u64) as usize]["name"];
    let robot = robot.as_str().unwrap();
    let streams = format!(" --reseed all --seed {}", next(1000));
    let command = format!(" --command {robot}=0.05,0.3 --for 1");
    let changes = ["", " --reseed all", &streams, &command];
    for change in changes {
        // A multiple of every tick period.
        let at_s = next((end_s * 5.0 - 1.0) as u64) as f64 / 5.0;
        let words = format!("branch a.mcap --at {at_s} --force --out b.mcap --json{change}");
        let branch = call(&words);
        assert_eq!(branch.code, Some(0), "{scenario} {words}: {branch}");
        let report = branch.json();
        assert_eq!(report["same"], true, "{scenario} {words}: {branch}");
        if change.is_empty() {
            assert_eq!(
                report["branch_digest"], info["digest"],
                "{scenario}: {branch}"
            );
        }
        let verified = call("verify b.mcap --quiet");
        assert_eq!(verified.code, Some(0), "{scenario} {words}: {verified}");
    }
    changes.len() as u64
}

#[test]
fn a_branch_without_a_change_equals_its_parent_and_others_do_up_to_their_moment() {
    let (sandbox, mut draw) = (Sandbox::new(), 12_345);
    for scenario in SCENARIOS {
        branch_at_random(&sandbox, scenario, None, &mut draw);
    }
}

#[test]
#[ignore = "ten minutes: docs/how-to/branch.md says how to run it"]
fn branches_of_all_built_in_scenarios_are_their_parents_up_to_their_moments() {
    let (sandbox, mut draw, mut branches) = (Sandbox::new(), 1, 0);
    let deadline = Instant::now() + Duration::from_secs(600);
    let listed = sandbox.protean(["list"]).json();
    let all: Vec<_> = listed["scenarios"].as_array().unwrap().iter().collect();
    for scenario in all.iter().cycle() {
        if Instant::now() >= deadline {
            break;
        }
        let name = scenario["name"].as_str().unwrap();
        branches += branch_at_random(&sandbox, name, None, &mut draw);
    }
    println!("{branches} branches");
}

#[test]
#[ignore = "ten minutes: docs/how-to/branch.md says how to run it"]
fn branches_with_programs_in_python_are_their_parents_up_to_their_moments() {
    let python = match &*package::PYTHON {
        Ok(python) => python.as_path(),
        Err(reason) => return skipped("branches with programs in Python", reason),
    };
    let (sandbox, mut draw, mut branches) = (Sandbox::new(), 1, 0);
    for (name, text) in [
        (
            "hall.toml",
            include_str!("../examples/python_planner/hall.toml"),
        ),
        (
            "planner.py",
            include_str!("../examples/python_planner/planner.py"),
        ),
        (
            "bearings.toml",
            include_str!("../examples/external_sensor/bearings.toml"),
        ),
        (
            "bearings.py",
            include_str!("../examples/external_sensor/bearings.py"),
        ),
    ] {
        sandbox.file(name, text);
    }
    for scenario in ["hall.toml", "bearings.toml"].iter().cycle() {
        if branches >= 52 {
            break;
        }
        branches += branch_at_random(&sandbox, scenario, Some(python), &mut draw);
        sandbox.assert_nothing_left();
    }
    println!("{branches} branches");
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
        "branch a.mcap --at 3 --draw teams.police.limits.v_max=0.2..0.1",
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
fn a_process_that_failed_fails_in_every_branch_at_its_tick() {
    let sandbox = Sandbox::new();
    let words = "run chase --quiet --out a.mcap --set run.dt=0.01 --set rules.time_limit=8 --set processes.evader_potential.on_failure=continue";
    let running = sandbox.protean(words.split(' ')).start();
    wait_for_tick(&sandbox.next_run(&BTreeSet::new()), 100);
    signal(
        sandbox.process("evader_potential_evader_1").pid,
        Signal::KILL,
    );
    let run = running.finish();
    assert_eq!(run.code, Some(3), "{run}");
    let info = sandbox.protean("info a.mcap".split(' ')).json();
    let branch = |change: &str| {
        let words = format!("branch a.mcap --force --out b.mcap --json {change}");
        let branch = sandbox.protean(words.split(' ')).run();
        assert_eq!(branch.code, Some(0), "{words}: {branch}");
        let verified = sandbox.protean("verify b.mcap --quiet".split(' ')).run();
        assert_eq!(verified.code, Some(0), "{words}: {verified}");
        branch.json()
    };
    for at_s in ["0.5", "7"] {
        let nothing = branch(&format!("--at {at_s}"));
        assert_eq!(nothing["branch_digest"], info["digest"], "{nothing}");
    }
    let other = branch("--at 7 --reseed all");
    assert_ne!(other["branch_digest"], info["digest"], "{other}");
    let times = "branch a.mcap --at 7 --times 2";
    sandbox.protean(times.split(' ')).json();
}

/// Records a whole game; returns its end (s).
fn record_game(sandbox: &Sandbox) -> f64 {
    let run = "run chase_exact --in-process --quiet --out a.mcap";
    let run = sandbox.protean(run.split(' ')).run();
    assert_eq!(run.code, Some(0), "{run}");
    let info = sandbox.protean("info a.mcap".split(' ')).json();
    info["end_s"].as_f64().unwrap()
}

/// Clicks on the curves of the page of a report, at moments with one outcome and with two: that many continuations end so.
fn click_on_curves(page: &Path, report: &Json) {
    let size = std::fs::metadata(page).unwrap().len();
    assert!(size < 1 << 20, "{size}");
    // By the number of outcomes: a robot, its outcomes by frequency, and a moment.
    let items = |list: &'static str| report[list].as_array().unwrap();
    let mut curves: Vec<(&Json, Vec<&Json>, f64)> = Vec::new();
    for (decision, moment) in items("decisions").iter().flat_map(|decision| {
        items("moments")
            .iter()
            .map(move |moment| (decision, moment))
    }) {
        let robots = moment["robots"].as_array().unwrap();
        let robot = &decision["robot"];
        let shares = robots.iter().find(|own| own["robot"] == *robot).unwrap();
        let mut outcomes: Vec<&Json> = shares["outcomes"].as_array().unwrap().iter().collect();
        outcomes.sort_by_key(|outcome| std::cmp::Reverse(outcome["count"].as_u64()));
        let time_s = moment["time_s"].as_f64().unwrap();
        if time_s <= decision["time_s"].as_f64().unwrap() {
            curves.push((robot, outcomes, time_s));
        }
    }
    for count in [1, 2] {
        let (robot, outcomes, at_s) = curves.iter().find(|curve| curve.1.len() == count).unwrap();
        let name = robot.as_str().unwrap();
        // Hides the other curves, and clicks at the moment.
        let click = format!(
            "(() => {{ const plot = document.querySelector('#stage .plot'); \
             for (const one of plot.querySelectorAll('.legend button')) if (!one.textContent.startsWith('{name} ')) one.click(); \
             const canvas = plot.querySelector('canvas'); canvas.scrollIntoView(); const box = canvas.getBoundingClientRect(); \
             const x = box.left + 52 + (box.width - 64) * {at_s} / protean.end_s, y = box.top + 90; return [x, y, x, y]; }})()"
        );
        let last = "protean.runs.slice(1).map(({ outcome, at, facts }) => \
                    [outcome, at(facts.end_s).robots.map(({ name, status }) => [name, status])])";
        let steps = json!([
            { "eval": "document.querySelectorAll('#stage .plot .legend button').length" },
            { "drag": click },
            { "until": "protean.runs.length > 1" },
            { "eval": "[protean.playing, protean.t]" },
            { "eval": "[...document.querySelectorAll('.continuations section')].map((one) => one.innerText)" },
            { "eval": last },
            { "eval": format!("protean.runs.map(({{ at }}) => at({at_s}).robots.map(({{ x, y }}) => [x, y]))") },
            { "eval": "[...document.querySelectorAll('.continuations > section')].map((one) => one.getBoundingClientRect().left)" },
        ]);
        let Some(found) = browse(page, &steps) else {
            return;
        };
        assert_eq!(found["errors"], json!([]));
        assert_eq!(found["requests"].as_array().unwrap().len(), 1, "{found}");
        let answers = &found["answers"];
        assert_eq!(answers[0], items("decisions").len());
        assert_eq!(answers[2][0], true, "{answers}");
        let (texts, ends) = (
            answers[3].as_array().unwrap(),
            answers[4].as_array().unwrap(),
        );
        assert_eq!((texts.len(), ends.len()), (count, count), "{answers}");
        for ((outcome, text), end) in outcomes.iter().zip(texts).zip(ends) {
            let (text, word) = (text.as_str().unwrap(), outcome["outcome"].as_str().unwrap());
            let percent = (100.0 * outcome["share"].as_f64().unwrap() + 0.5).floor();
            let start = format!("{name} {}: {percent} % (", word.replace('_', " "));
            assert!(text.starts_with(&start), "{text}: {start}");
            let command = format!(
                "protean branch a.mcap --at={at_s} --reseed=all --seed={}",
                outcome["stream"]
            );
            assert!(text.ends_with(&command), "{text}: {command}");
            let recorded = end[0]
                .as_array()
                .unwrap()
                .iter()
                .find(|own| own["name"] == **robot);
            assert_eq!(recorded.unwrap()["outcome"], word, "{end}");
            assert!(
                end[1].as_array().unwrap().contains(&json!([name, word])),
                "{end}"
            );
        }
        // Each begins where the run is.
        for own in answers[5].as_array().unwrap() {
            assert_eq!(*own, answers[5][0], "{answers}");
        }
        let lefts = answers[6].as_array().unwrap();
        assert!(
            count == 1 || lefts[0] != lefts[1],
            "side by side: {lefts:?}"
        );
    }
}

#[test]
fn outcomes_of_copies_are_those_of_branches_from_the_start_for_any_number_of_jobs() {
    let sandbox = Sandbox::new();
    record_game(&sandbox);
    let decided = |jobs: &str| {
        let words = "decided a.mcap --moments 4 --times 1 --share 0.5 --force --svg curve.svg --report page.html --jobs";
        sandbox.protean(words.split(' ')).arg(jobs).json()
    };
    let report = decided("1");
    assert_eq!(report, decided("3"));
    let moments = report["moments"].as_array().unwrap();
    assert!(moments.len() >= 4, "{report}");
    for moment in moments {
        let at_s = moment["time_s"].as_f64().unwrap();
        let mut counts: BTreeMap<(String, String), (u64, u64)> = BTreeMap::new();
        for seed in 1..=moment["continuations"].as_u64().unwrap() {
            // Each runs in its own process from the start.
            let words = format!(
                "branch a.mcap --at {at_s} --reseed all --seed {seed} --force --out b.mcap"
            );
            let branch = sandbox.protean(words.split(' ')).json();
            for robot in branch["robots"].as_array().unwrap() {
                let of = |key: &str| robot[key].as_str().unwrap().to_owned();
                let key = (of("name"), of("outcome"));
                counts.entry(key).or_insert((0, seed)).0 += 1;
            }
        }
        let mut found = BTreeMap::new();
        for robot in moment["robots"].as_array().unwrap() {
            for share in robot["outcomes"].as_array().unwrap() {
                let of = |value: &Json| value.as_str().unwrap().to_owned();
                let key = (of(&robot["robot"]), of(&share["outcome"]));
                let [count, stream] = ["count", "stream"].map(|key| share[key].as_u64().unwrap());
                found.insert(key, (count, stream));
            }
        }
        assert_eq!(found, counts, "{moment}");
    }
    for decision in report["decisions"].as_array().unwrap() {
        let (at, between) = (&decision["time_s"], &decision["between_s"]);
        let ends = between.as_array().map_or([0.0, 0.0], |ends| {
            [0, 1].map(|end: usize| ends[end].as_f64().unwrap())
        });
        assert!(ends[1] - ends[0] <= 1.0 && ends[1] < at.as_f64().unwrap());
    }
    let curves = std::fs::read_to_string(sandbox.path().join("curve.svg")).unwrap();
    let decisions = report["decisions"].as_array().unwrap().len();
    assert_eq!(curves.matches("<polyline").count(), decisions);
    click_on_curves(&sandbox.path().join("page.html"), &report);
}

#[test]
fn continuations_near_the_end_have_the_recorded_outcomes_and_keep_their_logs() {
    let sandbox = Sandbox::new();
    let late = record_game(&sandbox) - 0.1;
    let times = format!("branch a.mcap --at {late:.2} --times 3 --keep-logs kept");
    let report = sandbox.protean(times.split(' ')).json();
    for robot in report["robots"].as_array().unwrap() {
        let outcome = &robot["outcomes"][0];
        assert_eq!(outcome["count"], 3, "{report}");
        assert_eq!(outcome["outcome"], robot["recorded"], "{report}");
    }
    let verified = sandbox.protean(["verify", "kept/2.mcap", "--quiet"]).run();
    assert_eq!(verified.code, Some(0), "{verified}");
}

#[test]
fn a_killed_copy_is_an_error_and_an_interruption_leaves_nothing() {
    let sandbox = Sandbox::new();
    record_game(&sandbox);
    let decided = || {
        let words = "decided a.mcap --moments 8 --times 2000 --jobs 2 --quiet";
        sandbox.protean(words.split(' ')).start()
    };
    let children = |pid: u32| -> Vec<u32> {
        let list = std::fs::read_to_string(format!("/proc/{pid}/task/{pid}/children"));
        let list = list.unwrap_or_default();
        list.split_whitespace()
            .map(|pid| pid.parse().unwrap())
            .collect()
    };
    // A continuation is a child of a walk, which is a child of the program.
    let continuation = |pid: u32| {
        let mut walks = children(pid).into_iter();
        walks.find_map(|walk| children(walk).first().copied())
    };
    let running = decided();
    let copy = until("a copy", SOON, || continuation(running.pid()));
    signal(copy, Signal::KILL);
    let words = ["the continuation from", "has no outcome: its process ended"];
    running.finish().refused(1, &words);
    sandbox.assert_empty();

    let running = decided();
    until("a copy", SOON, || continuation(running.pid()));
    running.signal(Signal::INT);
    running.finish().refused(3, &["interrupted"]);
    sandbox.assert_empty();

    let mut running = decided();
    until("a copy", SOON, || continuation(running.pid()));
    running.signal(Signal::KILL);
    until("its end", SOON, || (!running.is_alive()).then_some(()));
    until("the end of its copies", SOON, || {
        sandbox.processes().is_empty().then_some(())
    });
}
