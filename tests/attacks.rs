//! Attacks on patrols: the adversaries' times and places, and judgements of their attacks, from the positions in logs alone.

use std::collections::BTreeMap;

use crate::patrol::off_contour;
use crate::support::Sandbox;
use crate::support::browser::browse;
use crate::support::geometry::between;
use crate::support::history::{Attack, History, State};
use serde_json::{Value as Json, json};

/// Tick of the scenario (s).
const TICK_S: f64 = 0.05;

/// Returns whether a guard is within a distance (m) of the place of an attack. The workplace is empty: a guard that sees has
/// a free line of sight to every place.
fn is_guarded(state: &State, attack: &Attack, distance: f64) -> bool {
    attack.guards.iter().any(|&guard| {
        let robot = &state.robots[guard];
        robot.status == 0 && between([robot.x, robot.y], [attack.x, attack.y]) <= distance
    })
}

/// The outcome of an attack and the time of its detection (s); `open` if the log ends before it.
fn judged(states: &[State], attack: &Attack) -> (&'static str, Option<f64>) {
    let lasts = (attack.duration_s / TICK_S).round() as usize;
    let begin = attack.tick as usize;
    let distance = attack.distance.max(attack.sight);
    let during = states.iter().skip(begin).take(lasts + 1);
    let seen = during
        .clone()
        .find(|state| is_guarded(state, attack, distance));
    match seen {
        Some(state) => ("detected", Some(state.tick as f64 * TICK_S)),
        None if during.count() > lasts => ("undetected", None),
        None => ("open", None),
    }
}

/// Compares every attack of a summary with the log's messages and with the judgement of this test; returns the attacks.
#[track_caller]
fn compare(summary: &Json, history: &History) -> Vec<Json> {
    let told = summary["attacks"].as_array().unwrap();
    assert_eq!(told.len(), history.attacks.len());
    for (told, attack) in told.iter().zip(&history.attacks) {
        assert_eq!(history.states[attack.tick as usize].tick, attack.tick);
        let (outcome, detected_s) = judged(&history.states, attack);
        assert_eq!(told["outcome"], outcome, "{told} {attack:?}");
        let number = |name: &str| told[name].as_f64();
        let differ = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() > 1e-6,
            (a, b) => a != b,
        };
        assert!(!differ(number("detected_s"), detected_s), "{told}");
        let begin_s = attack.tick as f64 * TICK_S;
        assert!(!differ(number("begin_s"), Some(begin_s)), "{told}");
        assert_eq!(told["method"], *attack.method);
        assert_eq!([&told["x"], &told["y"]], [attack.x, attack.y]);
    }
    told.clone()
}

#[test]
fn every_attack_is_judged_as_the_positions_in_the_log_say() {
    let sandbox = Sandbox::new();
    let words = ["run", "patrol_intruder", "--quiet", "--out", "run.mcap"];
    let summary = sandbox.protean(words).json();
    let alone = sandbox
        .protean(["run", "patrol_intruder", "--quiet", "--in-process"])
        .json();
    assert_eq!(alone["digest"], summary["digest"]);
    assert_eq!(alone["attacks"], summary["attacks"]);

    let history = History::read(&sandbox.path().join("run.mcap"));
    let attacks = compare(&summary, &history);
    for method in ["statistical", "best_response"] {
        let own: Vec<&Attack> = history
            .attacks
            .iter()
            .filter(|attack| attack.method == method)
            .collect();
        assert!(own.len() >= 5, "{method}: {}", own.len());
        // It watches for 300 s, and rests for 10 s after each attack; its window is 60 s.
        let mut ready_s = 300.0;
        for attack in &own {
            let begin_s = attack.tick as f64 * TICK_S;
            let last_s = ready_s + 60.0 + TICK_S;
            assert!((ready_s - 1e-9..=last_s).contains(&begin_s), "{attack:?}");
            ready_s = begin_s + attack.duration_s + 10.0;
            assert!(off_contour([attack.x, attack.y]) < 1e-9, "{attack:?}");
            assert_eq!((attack.duration_s, attack.guards.len()), (34.0, 3));
            // The moment of `statistical` is that at which a guard leaves the place.
            let tick = attack.tick as usize;
            let is_left = |now: usize| is_guarded(&history.states[now], attack, attack.distance);
            if method == "statistical" && begin_s < last_s - 2.0 * TICK_S {
                assert!(is_left(tick - 1) && !is_left(tick), "{attack:?}");
            }
        }
    }
    // Visits of a place are nearly 40 s apart: an attack of 34 s is detected if it does not begin just after one.
    let count = |outcome: &str| attacks.iter().filter(|a| a["outcome"] == outcome).count();
    assert!(count("undetected") > count("detected"), "{attacks:?}");

    sandbox.protean(["report", "run.mcap"]).json();
    let rows = "[...document.querySelectorAll('section')].find((card) => card.textContent.startsWith('Attacks')).querySelectorAll('tbody tr').length";
    let steps = json!([
        { "eval": rows },
        { "eval": "[...document.querySelectorAll('#layers label')].map((layer) => layer.textContent)" },
    ]);
    if let Some(found) = browse(&sandbox.path().join("run.html"), &steps) {
        assert_eq!(found["errors"], json!([]));
        assert_eq!(found["answers"][0], attacks.len(), "{}", found["answers"]);
        let layers = found["answers"][1].to_string();
        assert!(layers.contains("attacks while they last"), "{layers}");
    }
}

#[test]
fn guards_that_see_detect_attacks_from_afar() {
    let sandbox = Sandbox::new();
    let words = ["run", "patrol_intruder", "--quiet", "--in-process"];
    let methods = r#"processes.intruder.params.methods=["random","history"]"#;
    let run = |sight: &str| {
        let log = format!("{sight}.mcap");
        let sight = format!("processes.intruder.params.sight={sight}");
        let call = sandbox.protean(words).arg("--out").arg(&log).set(&sight);
        let call = call.set("processes.intruder.params.duration_s=16");
        let summary = call.set(methods).set("rules.time_limit=600").json();
        let history = History::read(&sandbox.path().join(log));
        let attacks = compare(&summary, &history);
        attacks
            .iter()
            .filter(|a| a["outcome"] == "detected")
            .count() as f64
            / attacks.len() as f64
    };
    // A guard that sees 7 m far leaves a place out of sight for less than 16 s.
    let (near, far) = (run("1.5"), run("7"));
    assert!(near < 0.5 && far > 0.9, "{near} {far}");
}

#[test]
fn a_sweep_has_the_detected_attacks_of_each_adversary_with_their_interval() {
    let sandbox = Sandbox::new();
    let text = r#"
        scenario = "builtin:patrol_intruder"
        seeds = { first = 1, count = 2 }
        [[cases]]
        name = "short"
        set.rules.time_limit = 480
        set.processes.intruder.params.methods = ["random", "statistical"]
    "#;
    sandbox.file("attacks.toml", text);
    let words = ["sweep", "attacks.toml", "--in-process", "--quiet"];
    let summary = sandbox.protean(words).args(["--out", "out"]).json();
    let mut results = csv::Reader::from_path(sandbox.path().join("out/results.csv")).unwrap();
    for row in results.deserialize::<BTreeMap<String, String>>() {
        assert_eq!(row.unwrap()["evader_distance_m"], "0.0");
    }
    let mut table = csv::Reader::from_path(sandbox.path().join("out/adversaries.csv")).unwrap();
    let mut counts: BTreeMap<String, (u64, u64)> = BTreeMap::new();
    for row in table.deserialize::<BTreeMap<String, String>>() {
        let row = row.unwrap();
        let number = |name: &str| row[name].parse::<u64>().unwrap();
        let of = counts.entry(row["adversary"].clone()).or_default();
        *of = (of.0 + number("attacks_detected"), of.1 + number("attacks"));
        assert_eq!(row["attacker"], "intruder");
    }
    let detections = summary["cells"][0]["detections"].as_array().unwrap();
    assert_eq!(detections.len(), counts.len());
    assert_eq!(counts.len(), 2);
    for of in detections {
        let (detected, attacks) = counts[of["adversary"].as_str().unwrap()];
        assert_eq!(
            (&of["detected"], &of["attacks"]),
            (&detected.into(), &attacks.into())
        );
        // Wilson's interval.
        let (n, p, z) = (attacks as f64, detected as f64 / attacks as f64, 1.959_964);
        let middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
        let half = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt() / (1.0 + z * z / n);
        for (end, expected) in [middle - half, middle + half].into_iter().enumerate() {
            let end = of["wilson_95"][end].as_f64().unwrap();
            assert!((end - expected).abs() < 1e-6, "{of}");
        }
    }
}
