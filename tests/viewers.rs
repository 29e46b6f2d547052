//! Logs and live runs in the viewers that people have.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value as Json, json};

use crate::support::browser::{layout, studio};
use crate::support::{Sandbox, python, skipped};

/// Counts pixels of the colours that matter, in a screenshot. Buildings are the obstacles, of one
/// colour alone; the map is what is nearly white: panels are white or light grey, what lies behind
/// the map is darker. Fields of view are blue on it; drawn without light they are grey.
const COLOURS: &str = "(data) => {
    const seen = { police: 0, evader: 0, building: 0, map: 0, unlit: 0, sum: 0 };
    const near = (value, wanted) => Math.abs(value - wanted) < 4;
    for (let i = 0; i < data.length; i += 4) {
        const [r, g, b] = [data[i], data[i + 1], data[i + 2]];
        if (b > r + 80 && b > g + 30) seen.police += 1;
        if (r > b + 100 && r > g + 40) seen.evader += 1;
        if (near(r, 112) && near(g, 119) && near(b, 129)) seen.building += 1;
        if (r === g && g === b && r > 245 && r < 255) seen.map += 1;
        if (r === g && g === b && near(r, 220)) seen.unlit += 1;
        seen.sum = (seen.sum * 31 + (r << 16 | g << 8 | b)) % 4294967291;
    }
    return seen;
}";

/// The schemas of a log by topic.
fn schemas(log: &Path) -> BTreeMap<String, (String, String)> {
    let bytes = std::fs::read(log).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let all = summary.channels.values().map(|channel| {
        let schema = channel.schema.as_ref().unwrap();
        let text = String::from_utf8_lossy(&schema.data).into_owned();
        (channel.topic.clone(), (schema.name.clone(), text))
    });
    all.collect()
}

/// The type of a field of a message type, by the text of a ROS 2 schema.
fn field<'a>(schema: &'a str, message: Option<&str>, name: &str) -> Option<&'a str> {
    let mut parts = schema.split("====\nMSG: ");
    let own = parts.next().unwrap();
    let part = match message {
        None => own,
        Some(message) => parts.find(|part| part.lines().next() == Some(message))?,
    };
    part.lines().find_map(|line| {
        let mut words = line.split_whitespace();
        let kind = words.next()?;
        (words.next() == Some(name)).then_some(kind)
    })
}

/// Asserts that a path of messages, `topic{filter}.field[0].field`, names what is there.
#[track_caller]
fn names_what_is_there(path: &str, schemas: &BTreeMap<String, (String, String)>) {
    let end = path.find(['.', '{']).unwrap_or(path.len());
    let (topic, fields) = path.split_at(end);
    let (_, schema) = schemas
        .get(topic)
        .unwrap_or_else(|| panic!("{path}: no topic {topic}"));
    let mut message: Option<&str> = None;
    for part in fields.split('.') {
        // The filter names a field of the message that it stands behind.
        let (name, filter) = part.split_once('{').unwrap_or((part, ""));
        let name = name.split('[').next().unwrap();
        if !name.is_empty() {
            let kind = field(schema, message, name);
            let kind = kind.unwrap_or_else(|| panic!("{path}: no field {name}"));
            message = Some(kind.trim_end_matches("[]"));
        }
        if let Some((filtered, _)) = filter.split_once("==") {
            let kind = field(schema, message, filtered);
            assert!(kind.is_some(), "{path}: no field {filtered}");
        }
    }
}

/// The view for Rerun.
fn rerun_view() -> PathBuf {
    layout().with_file_name("rerun-blueprint.py")
}

/// The layout for Foxglove.
fn foxglove_layout() -> Json {
    serde_json::from_slice(&std::fs::read(layout()).unwrap()).unwrap()
}

/// Asserts that the layout for Foxglove and the view for Rerun name only what a log holds.
pub fn assert_layouts_fit(log: &Path) {
    let schemas = schemas(log);
    let layout = foxglove_layout();
    let mut shown = 0;
    for (panel, config) in layout["configById"].as_object().unwrap() {
        let topics = config["topics"].as_object();
        for topic in topics.into_iter().flat_map(|t| t.keys()) {
            let (schema, _) = schemas
                .get(topic)
                .unwrap_or_else(|| panic!("{panel}: {topic}"));
            assert!(
                ["visualization_msgs/", "nav_msgs/", "sensor_msgs/"]
                    .iter()
                    .any(|p| schema.starts_with(p)),
                "{panel}: {topic} is {schema}"
            );
            shown += 1;
        }
        for path in config["paths"].as_array().into_iter().flatten() {
            names_what_is_there(path["value"].as_str().unwrap(), &schemas);
            shown += 1;
        }
        for key in ["topicPath", "topicToRender"] {
            if let Some(path) = config[key].as_str() {
                names_what_is_there(path, &schemas);
                shown += 1;
            }
        }
    }
    assert!(shown > 20, "{shown}");
    let view = std::fs::read_to_string(rerun_view()).unwrap();
    let words = view.split('"').skip(1).step_by(2);
    let topics: Vec<&str> = words.filter(|word| word.starts_with('/')).collect();
    assert!(topics.len() > 3, "{topics:?}");
    for topic in topics {
        assert!(schemas.contains_key(topic), "{topic} of the view for Rerun");
    }
}

#[test]
fn every_panel_of_the_layout_has_its_place_and_every_place_its_panel() {
    let layout = foxglove_layout();
    let panels = layout["configById"].as_object().unwrap();
    let places = layout["layout"].to_string();
    for panel in panels.keys() {
        assert!(
            places.contains(&format!("{panel:?}")),
            "{panel} has no place"
        );
    }
    assert_eq!(places.matches('!').count(), panels.len());
}

/// The panel looks at the middle of the map from so far that all of it is seen, whatever the mission.
#[test]
fn the_layout_shows_the_whole_map_of_any_log() {
    let layout = foxglove_layout();
    let panel = &layout["configById"]["3D!mission"];
    assert_eq!(panel["cameraState"]["perspective"], false);
    let shown = panel["cameraState"]["distance"].as_f64().unwrap();
    let frame = panel["followTf"].as_str().unwrap();
    let sandbox = Sandbox::new();
    for target in [
        "chase",
        "patrol_octagon",
        "patrol_square",
        "coverage_open",
        "hello",
    ] {
        sandbox
            .protean([
                "run",
                target,
                "--in-process",
                "--force",
                "--out",
                "run.mcap",
            ])
            .set("rules.time_limit=1")
            .json();
        let first = |topic: &str| -> Json {
            let words = ["cat", "run.mcap", "--limit", "1", "--topics", topic];
            let printed = sandbox.protean(words).run().stdout;
            serde_json::from_str::<Json>(&printed).unwrap()["message"].clone()
        };
        let map = first("/map");
        let info = &map["info"];
        let number = |value: &Json| value.as_f64().unwrap();
        let side = number(&info["resolution"]);
        let size = ["width", "height"].map(|cells| side * number(&info[cells]));
        let corner = &info["origin"]["position"];
        let middle = [
            number(&corner["x"]) + 0.5 * size[0],
            number(&corner["y"]) + 0.5 * size[1],
        ];
        let frames = first("/tf_static");
        let looked_at = &frames["transforms"][0];
        assert_eq!(looked_at["child_frame_id"], frame);
        let at = &looked_at["transform"]["translation"];
        let at = [number(&at["x"]), number(&at["y"])];
        assert!(
            (at[0] - middle[0]).abs() < 1e-6 && (at[1] - middle[1]).abs() < 1e-6,
            "{target}: {at:?}, {middle:?}"
        );
        assert!(size.iter().all(|size| *size <= shown), "{target}: {size:?}");
    }
}

/// Waits until the table of topics shows this for a topic; `.+` for any number of messages.
fn listed(topic: &str, schema: &str, count: &str) -> Json {
    let text = format!("{}\\s+{schema}\\s+{count}\\s", topic.replace('/', "\\/"));
    json!({ "until": format!("/{text}/.test(document.body.innerText)") })
}

/// Minimum number of pixels of each kind in a screenshot of the whole default chase. There are 195 000 pixels of buildings and 80 000 of the map; without them, 1 and 4600.
fn all_of_it() -> Json {
    json!({ "police": 30, "evader": 30, "building": 50_000, "map": 20_000 })
}

/// Makes Studio take every jump for one whose messages are slow to come, as they are on a busy
/// machine or from far: it then shows the time before the messages, and clears what it drew of them
/// when playing begins. What is output only once is gone from then on.
const SLOW_JUMPS: &str = "(() => {
    const later = globalThis.setTimeout;
    globalThis.setTimeout = (act, ms, ...rest) => later(act, ms === 100 ? 0 : ms, ...rest);
})()";

/// Waits until a screenshot shows robots, buildings and the map.
fn drawn() -> Json {
    json!({ "until_colours": COLOURS, "least": all_of_it() })
}

#[test]
fn a_log_opens_in_foxglove_studio_and_plays() {
    let sandbox = Sandbox::new();
    let summary = sandbox
        .protean(["run", "chase", "--out", "run.mcap"])
        .set("rules.time_limit=20")
        .json();
    let log = sandbox.path().join("run.mcap");
    let count = |topic: &str| {
        let messages = &summary["topics"][topic]["messages"];
        let messages = messages
            .as_u64()
            .unwrap_or_else(|| panic!("{topic}: {summary}"));
        // As the table writes it.
        match messages {
            0..1000 => messages.to_string(),
            _ => format!("{},{:03}", messages / 1000, messages % 1000),
        }
    };
    // The panel of raw messages shows it.
    let clock = "Number(/@ (\\d+\\.\\d+) sec/.exec(document.body.innerText)?.[1])";
    let steps = json!([
        listed("/robots", "visualization_msgs\\/msg\\/MarkerArray", &count("/robots")),
        listed("/map", "nav_msgs\\/msg\\/OccupancyGrid", &count("/map")),
        listed("/beliefs", "sensor_msgs\\/msg\\/PointCloud2", &count("/beliefs")),
        listed("/rosout", "rcl_interfaces\\/msg\\/Log", &count("/rosout")),
        listed("perception/belief", "protean\\/msg\\/PerceptionBelief", &count("perception/belief")),
        // What it decodes first is the beginning.
        { "until": format!("{clock} >= 8") },
        { "eval": clock },
        drawn(),
        { "eval": SLOW_JUMPS },
        { "key": "ArrowLeft" },
        { "until": format!("{clock} < 8") },
        drawn(),
        { "key": " " },
        // Longer than it takes until map and obstacles come again.
        { "until": format!("{clock} > 10.5") },
        { "key": " " },
        { "eval": clock },
        drawn(),
        // That panel has decoded our messages, and no panel reports an error of the layout.
        { "eval": "/robots\\s*\\[\\]\\s*6 items/.test(document.body.innerText)" },
        { "eval": "/An error occurred|unknown panel/i.test(document.body.innerText)" },
    ]);
    let Some(found) = studio(log.to_str().unwrap(), 8.0, &steps) else {
        return;
    };
    let answers = found["answers"].as_array().unwrap();
    let [.., from, _, _, _, before, _, to, after, decoded, broken] = &answers[..] else {
        panic!("{found}");
    };
    assert_eq!(from, 8.0, "opened where it was asked to");
    assert!(to.as_f64().unwrap() > 10.5);
    assert_ne!(before["sum"], after["sum"], "the picture moves");
    // There are 1800 such pixels; 13 000 where markers differ in their numbers of triangles.
    assert!(
        after["unlit"].as_u64().unwrap() < 6000,
        "fields of view turn grey: {after}"
    );
    assert_eq!((decoded, broken), (&json!(true), &json!(false)));
    asks_only_this_machine(&found);
}

#[test]
fn a_live_run_is_drawn_in_foxglove_studio() {
    let sandbox = Sandbox::new();
    let run = crate::live::Watched::start(&sandbox, &["--quiet"]);
    let steps = json!([
        listed("/robots", "visualization_msgs\\/msg\\/MarkerArray", ".+"),
        listed("world/state", "protean\\/msg\\/WorldState", ".+"),
        drawn(),
    ]);
    let Some(found) = studio(run.url(), 0.0, &steps) else {
        return;
    };
    asks_only_this_machine(&found);
    run.interrupt();
    let (code, output) = run.finish();
    // Over already on a machine that is slow enough.
    assert!(matches!(code, Some(0 | 3)), "{output}");
    sandbox.assert_nothing_left();
}

#[track_caller]
fn asks_only_this_machine(found: &Json) {
    for request in found["requests"].as_array().unwrap() {
        let address = request.as_str().unwrap();
        let inside = ["http://127.0.0.1:", "data:", "blob:"];
        assert!(
            inside.iter().any(|i| address.starts_with(i)),
            "asks for {address}"
        );
    }
}

/// Rerun takes 166 MB to fetch: only where `PROTEAN_TEST_RERUN` is set.
#[test]
fn a_log_opens_in_rerun() {
    let what = "opening a log in Rerun";
    if std::env::var_os("PROTEAN_TEST_RERUN").is_none() {
        skipped(what, "PROTEAN_TEST_RERUN is not set");
        return;
    }
    let python = match python::prepare(&["python-rerun", "rerun-sdk==0.41.0"]) {
        Ok(python) => python,
        Err(reason) => return skipped(what, &reason),
    };
    let sandbox = Sandbox::new();
    let summary = sandbox
        .protean(["run", "chase", "--out", "run.mcap"])
        .set("rules.time_limit=20")
        .json();
    let run = |program: &Path, words: &[&str]| {
        let output = Command::new(program)
            .args(words)
            .current_dir(sandbox.path())
            // It keeps its settings in the home directory.
            .env("HOME", sandbox.path())
            .env("RERUN_ANALYTICS", "false")
            .output()
            .unwrap();
        let stdout = String::from_utf8_lossy(&output.stdout).into_owned();
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{words:?}: {stdout}\n{errors}");
        stdout
    };
    let rerun = |words: &[&str]| run(&python.with_file_name("rerun"), words);
    rerun(&["mcap", "check", "run.mcap"]);
    let info = rerun(&["mcap", "info", "run.mcap"]);
    for (topic, counts) in summary["topics"].as_object().unwrap() {
        let line = info
            .lines()
            .find(|line| line.split_whitespace().nth(1) == Some(topic));
        let line = line.unwrap_or_else(|| panic!("{topic}: {info}"));
        let messages = line.split_whitespace().nth(2).unwrap();
        assert_eq!(messages, counts["messages"].to_string(), "{line}");
    }
    let view = rerun_view();
    run(
        &python,
        &[view.to_str().unwrap(), "run.mcap", "--save", "run.rrd"],
    );
    let chunks = rerun(&["rrd", "print", "run.rrd"]);
    for (entity, component) in [
        ("/viewport", "ViewportBlueprint:root_container"),
        ("/walls", "Points3D:positions"),
        ("/beliefs", "Points3D:positions"),
        ("/tf", "Transform3D:translation"),
        ("/rosout", "TextLog:text"),
    ] {
        let drawn = chunks
            .lines()
            .any(|line| line.contains(&format!(" - {entity} - ")) && line.contains(component));
        assert!(drawn, "{entity} is not drawn as {component}");
    }
}
