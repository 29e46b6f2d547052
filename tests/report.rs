//! The page of a log, in a real browser.

use std::collections::BTreeMap;

use serde_json::{Value as Json, json};

use crate::support::Sandbox;
use crate::support::browser::browse;
use crate::support::history::History;

/// The same with all numbers as a browser has them: it does not tell 6 from 6.0.
fn in_a_browser(value: &Json) -> Json {
    match value {
        Json::Number(number) => json!(number.as_f64()),
        Json::Array(all) => all.iter().map(in_a_browser).collect(),
        Json::Object(all) => all
            .iter()
            .map(|(key, value)| (key.clone(), in_a_browser(value)))
            .collect(),
        other => other.clone(),
    }
}

#[test]
#[expect(
    clippy::too_many_lines,
    reason = "one look at the page after the other"
)]
fn a_page_plays_the_mission_in_a_browser_and_shows_what_the_log_says() {
    let sandbox = Sandbox::new();
    let summary = sandbox
        .protean(["run", "chase", "--seed", "3", "--out", "run.mcap"])
        .set("rules.time_limit=6")
        .json();
    let report = sandbox.protean(["report", "run.mcap"]).json();
    assert_eq!(report["page"], "run.html");
    assert_eq!(report["robots"], summary["robots"]);
    let history = History::read(&sandbox.path().join("run.mcap"));
    let state = &history.states[history.states.len() / 2];
    let time_s = state.tick as f64 * 0.05;
    let seek = format!(
        "new Promise((done) => {{ protean.seek({time_s}); requestAnimationFrame(() => requestAnimationFrame(() => \
         done({{ t: protean.t, clock: document.getElementById('clock').textContent, \
         scrub: Number(document.getElementById('scrub').value) }}))); }})"
    );
    // Until time has gone on, however slow the machine is.
    let plays = "new Promise((done) => { const from = protean.t, drawn = protean.drawn; \
         const look = () => protean.t > from + 0.05 && protean.drawn > drawn + 2 ? done(true) : setTimeout(look, 20); look(); })";
    let drawn = "(() => { const map = document.getElementById('map'); \
         const data = map.getContext('2d').getImageData(0, 0, map.width, map.height).data; const seen = new Set(); \
         for (let i = 0; i < data.length; i += 4) seen.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]); \
         return { colours: seen.size, police: seen.has(0x0072b2), evader: seen.has(0xd55e00), wall: seen.has(0xcfd4db) }; })()";
    // On a small map: the numbers of names and of pairs that overlap, at several times.
    let names = "new Promise((done) => { document.getElementById('map-box').style.width = '150px'; \
         const overlap = (a, b) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]; \
         setTimeout(() => { const all = [1, 2, 3, 4, 5, 6].map((t) => protean.namesAt(t)); \
         done([all.flat().length, all.flatMap((boxes) => boxes.flatMap((a, i) => boxes.slice(i + 1).filter((b) => overlap(a, b)))).length]); }, 300); })";
    let steps = json!([
        { "eval": "protean.outcome" },
        { "eval": "[...document.querySelectorAll('#outcome tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent))" },
        { "eval": seek },
        { "eval": format!("protean.at({time_s})") },
        { "eval": format!("protean.layersAt({time_s})") },
        { "eval": drawn },
        { "key": " " },
        { "eval": "protean.playing" },
        { "eval": plays },
        { "key": " " },
        { "eval": "protean.playing" },
        { "eval": "protean.seek(3), protean.t" },
        { "key": "ArrowLeft" },
        { "eval": "protean.t" },
        { "eval": "document.getElementById('run').textContent" },
        { "eval": "document.querySelectorAll('*').length" },
        { "eval": names },
    ]);
    let Some(found) = browse(&sandbox.path().join("run.html"), &steps) else {
        return;
    };
    assert_eq!(found["errors"], json!([]), "errors of the browser");
    for request in found["requests"].as_array().unwrap() {
        let address = request.as_str().unwrap();
        let inside = address.starts_with("file://") && address.ends_with("run.html")
            || address.starts_with("data:");
        assert!(inside, "asks for {address}");
    }
    let mut answers = found["answers"].as_array().unwrap().iter();
    let mut next = || answers.next().unwrap();
    assert_eq!(in_a_browser(next()), in_a_browser(&summary["robots"]));
    let rows = next().as_array().unwrap();
    for (row, robot) in rows.iter().zip(summary["robots"].as_array().unwrap()) {
        assert_eq!(row[0], robot["name"]);
        let outcome = robot["outcome"].as_str().unwrap().replace('_', " ");
        let shown = outcome.replace("active", "to the end");
        assert_eq!(row[1], shown);
    }
    assert_eq!(rows.len(), history.states[0].robots.len());
    let scrubbed = next();
    assert_eq!(scrubbed["t"], time_s);
    assert!(
        (scrubbed["scrub"].as_f64().unwrap() - time_s).abs() < 1e-6,
        "{scrubbed}"
    );
    assert!(
        scrubbed["clock"]
            .as_str()
            .unwrap()
            .starts_with(&format!("{time_s:.2} s of")),
        "{scrubbed}"
    );
    let at = next();
    assert_eq!(at["tick"], state.tick);
    for (shown, robot) in at["robots"].as_array().unwrap().iter().zip(&state.robots) {
        for (key, value) in [("x", robot.x), ("y", robot.y)] {
            let shown = shown[key].as_f64().unwrap();
            assert!(
                (shown - value).abs() <= 0.000_501,
                "{key}: {shown}, {value}"
            );
        }
        let turned =
            (shown["theta"].as_f64().unwrap() - robot.theta).rem_euclid(std::f64::consts::TAU);
        assert!(turned.min(std::f64::consts::TAU - turned) < 1e-4, "{shown}");
    }
    let layers = next();
    for robot in ["4", "5"] {
        assert!(layers["beliefs"][robot].as_u64().unwrap() > 100, "{layers}");
    }
    let picture = next();
    for what in ["police", "evader", "wall"] {
        assert_eq!(picture[what], true, "{what}: {picture}");
    }
    assert_eq!(
        (next(), next(), next()),
        (&json!(true), &json!(true), &json!(false)),
        "plays and pauses"
    );
    assert_eq!((next(), next()), (&json!(3), &json!(2)), "a second back");
    let words = next().as_str().unwrap();
    assert!(
        words.contains(summary["digest"].as_str().unwrap()),
        "{words}"
    );
    let nodes = next().as_u64().unwrap();
    assert!(
        nodes < 1000,
        "{nodes} elements for a page that draws on canvases"
    );
    let names = next();
    assert!(names[0].as_u64().unwrap() > 12, "{names}");
    assert_eq!(names[1], 0, "names overlap: {names}");
    sandbox.assert_nothing_left();
}

#[test]
#[expect(
    clippy::too_many_lines,
    reason = "one look at the page after the other"
)]
fn a_page_opens_before_the_first_decision_and_two_runs_share_its_clock() {
    let sandbox = Sandbox::new();
    for (log, seed) in [("a.mcap", "1"), ("b.mcap", "2")] {
        let words = ["run", "popup", "--in-process", "--seed", seed, "--out", log];
        sandbox.protean(words).json();
    }
    let reports = sandbox.protean(["report", "a.mcap", "b.mcap"]).json();
    assert_eq!(reports[0]["page"], "a-b.html");
    assert_eq!(reports[1]["page"], "a-b.html");
    let times = |kinds: &str| {
        format!(
            "protean.runs.map(({{ facts }}) => facts.events.filter((e) => {kinds}.includes(facts.event_kinds[e[1]]))\
             .map((e) => e[0]))"
        )
    };
    let later =
        |value: &str| format!("new Promise((done) => setTimeout(() => done({value}), 500))");
    let steps = json!([
        { "eval": times("['goal_reached']") },
        { "eval": times("['obstacle']") },
        { "eval": "document.getElementById('difference').textContent" },
        { "eval": "['timeline', 'curves'].map((part) => document.querySelectorAll(`#${part} canvas`).length)" },
        { "eval": "protean.runs.map((run) => run.root.querySelectorAll('#events, #plots').length)" },
        { "eval": "[...document.querySelectorAll('#curves .legend button')].map((curve) => curve.textContent)" },
        { "eval": "protean.t" },
        { "key": "p" },
        { "eval": later("[protean.t, location.hash]") },
        { "eval": "protean.runs.map((run) => run.root.getElementById('event-words').textContent)" },
        { "eval": "protean.runs.map((run) => [run.plansAt(5)[0][0], [run.at(5).robots[0].x, run.at(5).robots[0].y]])" },
        { "eval": "protean.runs.map((run) => run.root.getElementById('result').textContent)" },
        { "eval": "protean.runs.map((run) => [...run.root.querySelectorAll('#layers label')].map((l) => l.textContent))" },
        { "eval": "void (location.hash = '#t=18')" },
        { "eval": later("[protean.t, document.getElementById('clock').textContent]") },
    ]);
    let Some(found) = browse(&sandbox.path().join("a-b.html"), &steps) else {
        return;
    };
    assert_eq!(found["errors"], json!([]));
    let mut answers = found["answers"].as_array().unwrap().iter();
    let mut next = || answers.next().unwrap();
    let all = |times: &Json| -> Vec<f64> {
        let runs = times.as_array().unwrap().iter();
        let times = runs.flat_map(|run| run.as_array().unwrap());
        times.map(|time| time.as_f64().unwrap()).collect()
    };
    let (goals, obstacles) = (all(next()), all(next()));
    assert_eq!((goals.len(), obstacles.len()), (2, 4));
    let difference = next().as_str().unwrap();
    for words in ["The histories are equal", "run.seed"] {
        assert!(difference.contains(words), "{difference}");
    }
    // Time line and curves are there once, with both runs.
    let counts = next();
    assert_eq!(counts[0], 1);
    assert!(counts[1].as_u64() > Some(1), "{counts}");
    assert_eq!(next(), &json!([0, 0]));
    let curves = next().as_array().unwrap();
    assert!(curves.len() > 1);
    for curve in curves {
        assert!(curve.as_str().unwrap().contains(" | "), "{curve}");
    }
    let opens = next().as_f64().unwrap();
    let first = goals.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((first - 5.0 - opens).abs() < 1e-6, "{opens} s, {goals:?}");
    let last = obstacles.iter().copied().fold(0.0, f64::max);
    let back = next();
    assert_eq!(back[0].as_f64(), Some(last), "the previous event");
    let address = back[1].as_str().unwrap().trim_start_matches("#t=");
    assert!(
        (address.parse::<f64>().unwrap() - last).abs() < 0.01,
        "{back}"
    );
    let words = next();
    for run in 0..2 {
        let words = words[run].as_str().unwrap();
        assert!(words.contains("popup_2 appeared"), "{words}");
    }
    for ends in next().as_array().unwrap() {
        let apart = |i: usize| ends[0][i].as_f64().unwrap() - ends[1][i].as_f64().unwrap();
        assert!(
            apart(0).abs().max(apart(1).abs()) < 0.1,
            "a plan begins at its robot: {ends}"
        );
    }
    let results = next();
    for run in 0..2 {
        let result = results[run].as_str().unwrap();
        assert!(
            result.starts_with("the robot reached its goal after"),
            "{result}"
        );
    }
    for layers in next().as_array().unwrap() {
        let layers = layers.to_string();
        assert!(layers.contains("planned paths"), "{layers}");
        for lacking in ["belief", "dominance", "idleness", "not in this log"] {
            assert!(!layers.contains(lacking), "{lacking}: {layers}");
        }
    }
    assert_eq!(next(), &Json::Null);
    let sought = next();
    assert_eq!(sought[0].as_f64(), Some(18.0));
    assert!(
        sought[1].as_str().unwrap().starts_with("18.00 s of"),
        "{sought}"
    );
}

/// Area of a polygon of corners.
fn area(corners: &[[f64; 2]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let cross = corners
        .iter()
        .zip(next)
        .map(|(a, b)| a[0] * b[1] - a[1] * b[0]);
    (cross.sum::<f64>() / 2.0).abs()
}

/// Visible regions in the last picture up to a time (s): its time, and areas (m²) by the names of the fields of view.
fn seen_in_viewers(sandbox: &Sandbox, until_s: u32) -> (f64, BTreeMap<String, f64>) {
    let until = until_s.to_string();
    let words = [
        "cat",
        "run.mcap",
        "--topics",
        "/fields_of_view",
        "--end",
        &until,
    ];
    let printed = sandbox.protean(words).run().stdout;
    let last = printed.lines().last().expect("fields of view are drawn");
    let last: Json = serde_json::from_str(last).unwrap();
    let markers = last["message"]["markers"].as_array().unwrap();
    let mut areas: BTreeMap<String, f64> = BTreeMap::new();
    for marker in markers.iter().filter(|marker| marker["ns"] != "") {
        let points = marker["points"].as_array().unwrap().iter();
        let points = points.map(|p| [p["x"].as_f64().unwrap(), p["y"].as_f64().unwrap()]);
        let points: Vec<[f64; 2]> = points.collect();
        let name = marker["ns"].as_str().unwrap().to_owned();
        *areas.entry(name).or_default() += points.chunks_exact(3).map(area).sum::<f64>();
    }
    (last["log_time_s"].as_f64().unwrap(), areas)
}

/// Viewers get polygons from the map's cells, the page makes them from the shapes of the obstacles,
/// at any time: they are the same to within a cell.
#[test]
fn what_is_seen_is_the_same_on_the_page_and_in_viewers() {
    let sandbox = Sandbox::new();
    for set in [
        "log.compression=\"zstd\"",
        "processes.perception.params.sensor={range = 3.0, field_of_view = 2.0}",
    ] {
        sandbox
            .protean(["run", "chase_popup", "--out", "run.mcap", "--force"])
            .set("rules.time_limit=12")
            .set(set)
            .json();
        sandbox.protean(["report", "run.mcap", "--force"]).json();
        let pictures = [0, 6, 11].map(|time_s| seen_in_viewers(&sandbox, time_s));
        let steps = pictures
            .each_ref()
            .map(|(time_s, _)| json!({ "eval": format!("protean.sightAt({time_s})") }));
        let Some(found) = browse(&sandbox.path().join("run.html"), &json!(steps)) else {
            return;
        };
        assert_eq!(found["errors"], json!([]));
        for ((time_s, seen), page) in pictures.iter().zip(found["answers"].as_array().unwrap()) {
            assert!(seen.len() >= 2, "{set}: {seen:?}");
            let page: BTreeMap<String, Vec<[f64; 2]>> =
                serde_json::from_value(page.clone()).unwrap();
            assert_eq!(
                page.keys().collect::<Vec<_>>(),
                seen.keys().collect::<Vec<_>>()
            );
            for (name, area_in_log) in seen {
                let (log, page) = (*area_in_log, area(&page[name]));
                assert!(
                    (log - page).abs() < 0.05 * page.max(1.0),
                    "{set}: {name} at {time_s} s: {log} m^2 in viewers, {page} m^2 on the page"
                );
            }
        }
    }
}

#[test]
fn pages_of_what_is_no_log_are_refused_and_those_of_a_killed_run_say_so() {
    let sandbox = Sandbox::new();
    sandbox.file("empty.mcap", "");
    for (name, words) in [("nope.mcap", "No such file"), ("empty.mcap", "it is empty")] {
        let before = sandbox.files();
        let outcome = sandbox.protean(["report", name]).run();
        outcome.refused(2, &["error: ", name, words]);
        assert_eq!(sandbox.files(), before);
    }
    sandbox
        .protean(["run", "chase_exact", "--in-process", "--out", "run.mcap"])
        .set("rules.time_limit=1")
        .json();
    let bytes = std::fs::read(sandbox.path().join("run.mcap")).unwrap();
    let index = mcap::Summary::read(&bytes).unwrap().unwrap();
    let last = index
        .chunk_indexes
        .iter()
        .map(|i| i.chunk_start_offset)
        .max();
    sandbox.file("cut.mcap", &bytes[..last.unwrap() as usize + 40]);
    let outcome = sandbox
        .protean(["report", "cut.mcap", "--out", "cut.html"])
        .run();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    assert!(outcome.stderr.contains("is incomplete"), "{outcome}");
    let steps = json!([{ "eval": "document.getElementById('missing').textContent" }]);
    if let Some(found) = browse(&sandbox.path().join("cut.html"), &steps) {
        assert_eq!(found["errors"], json!([]));
        let answer = found["answers"][0].as_str().unwrap();
        assert!(answer.contains("ends in the middle"), "{answer}");
    }
}

#[test]
fn a_page_fits_the_screens_of_its_readers() {
    let sandbox = Sandbox::new();
    let words = ["run", "chase", "--in-process", "--out", "run.mcap"];
    sandbox.protean(words).set("rules.time_limit=6").json();
    sandbox.protean(["report", "run.mcap"]).json();
    let lowest = "Math.min(...[...document.querySelectorAll('button, select, input, summary')].filter((e) => e.offsetParent)\
         .map((e) => e.getBoundingClientRect().height))";
    let share = "(({ view: { width, height, scale }, facts: { ground: { min, max } } }) => \
         (max[0] - min[0]) * (max[1] - min[1]) * scale * scale / (width * height))(protean)";
    let seen = "['map', 'play', 'scrub'].map((id) => document.getElementById(id).getBoundingClientRect())\
         .map(({ left, top, right, bottom }) => [left, top, right, bottom])";
    let overflow = "document.documentElement.scrollWidth - document.documentElement.clientWidth";
    let look = format!("[{lowest}, {share}, {seen}, {overflow}]");
    let screens = [[1500, 1000], [390, 844], [844, 390]];
    let mut steps = Vec::new();
    for screen in screens {
        steps.extend([json!({ "screen": screen }), json!({ "eval": look })]);
    }
    steps.extend([
        json!({ "eval": "protean.seek(0)" }),
        json!({ "key": "]" }),
        json!({ "eval": "protean.t" }),
        json!({ "key": "]" }),
        json!({ "key": "[" }),
        json!({ "eval": "[protean.t, protean.facts.events[0][0]]" }),
        json!({ "key": "?" }),
        json!({ "eval": "document.getElementById('keys').open" }),
    ]);
    let Some(found) = browse(&sandbox.path().join("run.html"), &json!(steps)) else {
        return;
    };
    assert_eq!(found["errors"], json!([]));
    let mut answers = found["answers"].as_array().unwrap().iter();
    let mut next = || answers.next().unwrap();
    for [width, height] in screens {
        let look = next();
        let number = |value: &Json| value.as_f64().unwrap();
        assert!(number(&look[0]) >= 24.0, "a low control: {look}");
        assert!(number(&look[1]) > 0.75, "a small world: {look}");
        assert!(number(&look[3]) <= 0.0, "wider than {width}: {look}");
        for part in look[2].as_array().unwrap() {
            let inside = number(&part[0]) >= 0.0 && number(&part[2]) <= f64::from(width);
            assert!(inside, "{width}: {look}");
            let is_seen = number(&part[1]) >= 0.0 && number(&part[3]) <= f64::from(height);
            assert!(is_seen, "beyond the screen of {width}: {look}");
        }
    }
    next();
    let first = next().clone();
    assert_eq!(next(), &json!([first, first]), "the next event and back");
    assert_eq!(next(), true, "the keys");
}
