//! Teams on patrol: their distances, the idleness of the contour as tables, pages and pictures show it, and robots whose
//! processes fail.

use crate::patrol::{OCTAGON, off_contour};
use crate::support::browser::browse;
use crate::support::call::PATIENCE;
use crate::support::geometry::between;
use crate::support::history::{History, State};
use crate::support::sandbox::signal;
use crate::support::{Sandbox, wait_for_tick};
use rustix::process::Signal;
use serde_json::{Value as Json, json};

/// Tick of the scenarios (s).
const TICK_S: f64 = 0.05;

/// Runs a team on a contour; returns its figures in the summary.
fn team(sandbox: &Sandbox, count: usize, contour: &str, time_limit: f64) -> Json {
    let count = format!("robots.guard.count={count}");
    let contour = format!("processes.patrol.params.mission.contour={contour}");
    let time_limit = format!("rules.time_limit={time_limit}");
    let words = ["run", "patrol_team", "--quiet", "--in-process"];
    let call = sandbox.protean(words);
    let call = [count, contour, time_limit]
        .iter()
        .fold(call, |call, set| call.set(set));
    let summary = call.json();
    let [patrol] = &summary["patrols"].as_array().unwrap()[..] else {
        panic!("{}", summary["patrols"]);
    };
    patrol.clone()
}

#[test]
fn a_team_spreads_around_its_contour() {
    const ANGLE: &str = "[[0,0],[16,0],[16,6],[6,6],[6,14],[0,14]]";
    let sandbox = Sandbox::new();
    let octagon: Vec<String> = OCTAGON.iter().map(|p| format!("{p:?}")).collect();
    let octagon = format!("[{}]", octagon.join(","));
    for (contour, length, count) in [
        (&*octagon, 48.28, 3),
        (&octagon, 48.28, 7),
        (ANGLE, 60.0, 4),
    ] {
        let patrol = team(&sandbox, count, contour, 400.0);
        let figure = |name: &str| patrol[name].as_f64().unwrap();
        let part_s = 120.0 / count as f64;
        assert_eq!(patrol["robots"].as_array().unwrap().len(), count);
        assert!(figure("nearest_m") >= length / 8.0, "{patrol}");
        assert!(figure("worst_idleness_s") <= 1.1 * part_s, "{patrol}");
        assert!(
            (figure("mean_idleness_s") - 0.5 * part_s).abs() < 0.15 * part_s,
            "{patrol}"
        );
    }
}

/// Number of equal pieces of the octagon's contour, twice that of the program.
const PIECES: usize = 960;

/// Length of a side of the octagon, by its first corner (m).
fn side(corner: usize) -> f64 {
    between(OCTAGON[corner % 8], OCTAGON[(corner + 1) % 8])
}

/// The middles of the pieces (m).
fn pieces() -> Vec<[f64; 2]> {
    let lap: f64 = (0..8).map(side).sum();
    let middle = |piece: usize| {
        let (mut left, mut corner) = ((piece as f64 + 0.5) * lap / PIECES as f64, 0);
        while left > side(corner) {
            left -= side(corner);
            corner += 1;
        }
        let (from, to) = (OCTAGON[corner], OCTAGON[(corner + 1) % 8]);
        [0, 1].map(|axis| from[axis] + left / side(corner) * (to[axis] - from[axis]))
    };
    (0..PIECES).map(middle).collect()
}

/// Visits of each piece by the robots with these indices (s): of the piece nearest to a robot, and of all that it passes.
fn visits(states: &[State], robots: &[usize]) -> Vec<Vec<f64>> {
    let pieces = pieces();
    let mut visits = vec![Vec::new(); PIECES];
    let mut places = vec![None; robots.len()];
    for state in states {
        for (place, &robot) in places.iter_mut().zip(robots) {
            let at = [state.robots[robot].x, state.robots[robot].y];
            let apart = pieces.iter().map(|&piece| between(piece, at));
            let (now, nearest) = apart
                .enumerate()
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .unwrap();
            // One that drives to its place from the middle visits none on its way.
            let now = Some(now).filter(|_| nearest <= 48.28 / 16.0);
            let before = std::mem::replace(place, now).or(now);
            let (Some(before), Some(now)) = (before, now) else {
                continue;
            };
            let ahead = (now + PIECES - before) % PIECES;
            let (first, count) = if ahead <= PIECES / 2 {
                (before, ahead)
            } else {
                (now, PIECES - ahead)
            };
            for piece in first..=first + count {
                visits[piece % PIECES].push(state.tick as f64 * TICK_S);
            }
        }
    }
    visits
}

#[test]
fn table_page_and_picture_show_the_idleness_of_a_team() {
    let sandbox = Sandbox::new();
    let words = [
        "run",
        "patrol_team",
        "--quiet",
        "--in-process",
        "--out",
        "run.mcap",
    ];
    sandbox.protean(words).set("rules.time_limit=90").json();
    let history = History::read(&sandbox.path().join("run.mcap"));
    let visits = visits(&history.states, &[0, 1, 2, 3]);

    let words = [
        "export", "run.mcap", "--out", "tables", "--topics", "patrols",
    ];
    let exported = sandbox.protean(words).json();
    let rows = history.states.len();
    assert_eq!(exported["tables"]["patrols"]["rows"], rows);
    assert_eq!(exported["tables"].as_object().unwrap().len(), 1);
    let mut table = csv::Reader::from_path(sandbox.path().join("tables/patrols.csv")).unwrap();
    let table: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert_eq!(&table[0][1], "guard_1, guard_2, guard_3, guard_4");
    let number = |row: usize, column: usize| table[row][column].parse::<f64>().unwrap();
    for row in [rows / 10, rows / 3, rows / 2, rows - 1] {
        let time_s = row as f64 * TICK_S;
        let age = |visits: &Vec<f64>| {
            let before = visits.iter().filter(|visit| **visit <= time_s + 1e-9);
            time_s - before.copied().fold(0.0, f64::max)
        };
        let ages: Vec<f64> = visits.iter().map(age).collect();
        let mean = ages.iter().sum::<f64>() / PIECES as f64;
        let worst = ages.iter().copied().fold(0.0, f64::max);
        let (told, longest) = (number(row, 2), number(row, 3));
        assert!((told - mean).abs() < 0.25, "row {row}: {told} s, {mean} s");
        assert!(
            (longest - worst).abs() < 0.3,
            "row {row}: {longest} s, {worst} s"
        );
        let at = [4, 5].map(|column| number(row, column));
        assert!(off_contour(at) < 1e-9, "{at:?}");
    }
    let visited: Vec<f64> = (0..rows).map(|row| number(row, 6)).collect();
    assert!(visited.is_sorted() && visited[0] < 0.05 && visited[rows - 1] == 1.0);

    sandbox.protean(["report", "run.mcap"]).json();
    let middle = rows / 2;
    let ages = |row: usize| {
        let time_s = number(row, 0) * 1e-9;
        let ages = format!("protean.patrolsAt({time_s})");
        json!({ "eval": format!("{ages}.map((ages) => [ages.length, ages.reduce((a, b) => a + b) / ages.length, Math.max(...ages)])") })
    };
    let steps = json!([
        ages(middle),
        ages(rows - 1),
        { "eval": "[...document.querySelectorAll('#plots h3')].map((title) => title.textContent)" },
        { "eval": "[...document.querySelectorAll('#layers label')].map((layer) => layer.textContent)" },
        { "eval": "[document.getElementById('layer-waypoints').checked, protean.runs[0].facts.capture_m]" },
    ]);
    if let Some(found) = browse(&sandbox.path().join("run.html"), &steps) {
        assert_eq!(found["errors"], json!([]));
        for (answer, row) in [(0, middle), (1, rows - 1)] {
            let [count, mean, worst] =
                [0, 1, 2].map(|i| found["answers"][answer][0][i].as_f64().unwrap());
            assert_eq!(count, 480.0);
            // The page keeps visits of a place that are a second apart.
            assert!((mean - number(row, 2)).abs() < 1.0, "{mean}");
            assert!((worst - number(row, 3)).abs() < 1.0, "{worst}");
        }
        assert_eq!(found["answers"][4], json!([false, null]), "many waypoints");
        let words = found["answers"].to_string();
        for text in [
            "Places of the patrol visited so far [%]",
            "Time since the last visit of the places of the patrol [s]",
            "idleness of the places of patrols",
        ] {
            assert!(words.contains(text), "{text}: {words}");
        }
    }

    let drawn = sandbox.protean(["picture", "run.mcap", "--at", "45"]);
    assert_eq!(drawn.run().code, Some(0));
    let picture = std::fs::read_to_string(sandbox.path().join("run.svg")).unwrap();
    let (_, places) = picture.split_once("<g class=\"places\"").unwrap();
    let (places, _) = places.split_once("</g>").unwrap();
    let colours = places.matches("d=\"M").count();
    assert!(colours >= 2, "{places}");
}

#[test]
fn the_others_close_the_gap_of_a_guard_whose_process_is_killed() {
    const FAILED: usize = 1;
    const END_S: f64 = 460.0;
    let sandbox = Sandbox::new();
    let running = sandbox
        .protean([
            "run",
            "patrol_team",
            "--json",
            "--quiet",
            "--out",
            "run.mcap",
        ])
        .set("rules.time_limit=460")
        .set("processes.patrol.on_failure=continue")
        .set(PATIENCE)
        .start();
    let run = sandbox.next_run(&std::collections::BTreeSet::new());
    wait_for_tick(&run, 2500);
    signal(sandbox.process("patrol_guard_2").pid, Signal::KILL);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    let summary = outcome.json();
    let processes = summary["processes"].as_array().unwrap();
    assert_eq!(processes.len(), 1, "{summary}");
    assert_eq!(processes[0]["name"], "patrol_guard_2");
    let left = processes[0]["outages"][0]["left_tick"].as_u64().unwrap();

    let history = History::read(&sandbox.path().join("run.mcap"));
    let states = &history.states;
    let (lap_s, failed_s) = (120.0, left as f64 * TICK_S);
    let closed_s = failed_s + lap_s;
    assert!(closed_s + 1.5 * lap_s < END_S, "killed at {failed_s} s");
    let stands = states[left as usize + 40].robots[FAILED].clone();
    assert!(states[left as usize + 40..].iter().all(|state| {
        let robot = &state.robots[FAILED];
        robot.fail_safe && between([robot.x, robot.y], [stands.x, stands.y]) < 0.5
    }));
    // A lap after the failure, every place is visited as by three guards at equal distances.
    let others = [0, 2, 3];
    for visits in visits(states, &others) {
        let late = visits.iter().filter(|visit| **visit >= closed_s);
        let times: Vec<f64> = [closed_s]
            .iter()
            .chain(late)
            .copied()
            .chain([END_S])
            .collect();
        let longest = times.windows(2).map(|pair| pair[1] - pair[0]);
        let longest = longest.fold(0.0, f64::max);
        assert!(longest <= 1.1 * lap_s / 3.0, "{longest} s");
    }
    // Before it they were a quarter of the contour apart, now a third.
    let pieces = pieces();
    let place = |state: &State, robot: usize| {
        let at = [state.robots[robot].x, state.robots[robot].y];
        let apart = |piece: &usize| between(pieces[*piece], at);
        (0..PIECES)
            .min_by(|a, b| apart(a).total_cmp(&apart(b)))
            .unwrap()
    };
    let nearest = |state: &State| {
        let mut places = others.map(|robot| place(state, robot));
        places.sort_unstable();
        let [a, b, c] = places;
        [b - a, c - b, a + PIECES - c].into_iter().min().unwrap() as f64 / PIECES as f64
    };
    let before = &states[left as usize];
    assert!(nearest(before) < 0.3, "{}", nearest(before));
    for state in states.iter().skip((closed_s / TICK_S) as usize).step_by(20) {
        assert!(
            nearest(state) > 0.3,
            "tick {}: {}",
            state.tick,
            nearest(state)
        );
    }
}
