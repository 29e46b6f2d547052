//! Names that programs outside this repository rely on: JSON keys, table headers, scenario keys, topics.

use std::collections::{BTreeMap, BTreeSet};
use std::convert::Infallible;
use std::fmt::Write as _;

use crate::support::Sandbox;
use crate::support::call::PATIENCE;
use ipc_types::message::Message as _;
use ipc_types::schema;
use ipc_types::topics::{Topic, TopicVisitor, for_each_topic};
use scenario::builtin::SCENARIOS;
use serde_json::Value as Json;

/// Adds the paths of all keys of a JSON value: `robots[].outcome`.
fn paths(value: &Json, prefix: &str, found: &mut BTreeSet<String>) {
    match value {
        Json::Object(fields) => {
            for (key, value) in fields {
                // Keys that are data stand for all of their kind.
                let key = match key.as_str() {
                    key if key.parse::<f64>().is_ok() => "NUMBER",
                    key if key.contains('/') => "TOPIC",
                    key if key.contains(' ') => "HOP",
                    key => key,
                };
                let path = if prefix.is_empty() {
                    key.to_owned()
                } else {
                    format!("{prefix}.{key}")
                };
                found.insert(path.clone());
                paths(value, &path, found);
            }
        }
        Json::Array(items) => {
            for item in items {
                paths(item, &format!("{prefix}[]"), found);
            }
        }
        _ => {}
    }
}

/// Sections, each with sorted lines.
fn text(sections: &BTreeMap<String, BTreeSet<String>>) -> String {
    let mut text = String::new();
    for (name, lines) in sections {
        writeln!(text, "[{name}]").unwrap();
        for line in lines {
            writeln!(text, "{line}").unwrap();
        }
    }
    text
}

/// The commands that print JSON, each as it is called after those before it.
const COMMANDS: &[(&str, &[&str], i32)] = &[
    (
        "run",
        &[
            "run",
            "chase",
            "--set",
            "rules.time_limit=2",
            "--set",
            PATIENCE,
            "--out",
            "chase.mcap",
        ],
        0,
    ),
    (
        "run patrol",
        &[
            "run",
            "patrol_octagon",
            "--in-process",
            "--set",
            "rules.time_limit=60",
            "--out",
            "patrol.mcap",
        ],
        0,
    ),
    (
        "run coverage",
        &[
            "run",
            "coverage_open",
            "--in-process",
            "--set",
            "rules.time_limit=60",
        ],
        0,
    ),
    (
        "run referee",
        &[
            "run",
            "chase_referee",
            "--in-process",
            "--set",
            "rules.time_limit=2",
        ],
        0,
    ),
    ("check", &["check", "chase"], 0),
    ("list", &["list"], 0),
    ("clean", &["clean"], 0),
    ("info", &["info", "chase.mcap"], 0),
    (
        "recover",
        &["recover", "chase.mcap", "--out", "recovered.mcap"],
        0,
    ),
    ("export", &["export", "chase.mcap", "--out", "tables"], 0),
    ("report", &["report", "chase.mcap"], 0),
    ("verify", &["verify", "chase.mcap", "--in-process"], 0),
    (
        "replay",
        &["replay", "chase.mcap", "--as-fast-as-possible"],
        0,
    ),
    (
        "replay --test",
        &[
            "replay",
            "chase.mcap",
            "--test",
            "perception",
            "--in-process",
        ],
        0,
    ),
    ("plan", &["plan", "instances.json", "--samples"], 0),
    (
        "sweep",
        &[
            "sweep",
            "missions.toml",
            "--in-process",
            "--out",
            "missions",
        ],
        0,
    ),
    (
        "sweep planning",
        &["sweep", "plans.toml", "--out", "plans"],
        0,
    ),
    (
        "sweep merge",
        &["sweep", "merge", "missions", "--out", "merged"],
        0,
    ),
    ("latency", &["latency", "chase.mcap"], 0),
];

/// Two observed patrols of a few seconds, so that the tables have predictions.
const MISSIONS: &str = r#"
scenario = "builtin:patrol_octagon"
seeds = { first = 1, count = 2 }

[[cases]]
name = "plain"

[parameters.limit]
set = "rules.time_limit"

[grid]
limit = [10]
"#;

/// Two single plans.
const PLANS: &str = r#"
kind = "planning"
seeds = { first = 1, count = 2 }

[[cases]]
name = "lp"
set.options = { method = "lp" }

[parameters.degree]
set = "options.degree"

[grid]
degree = [4]
"#;

/// A sandbox in which every command has been called; the keys that each printed.
fn called() -> (Sandbox, BTreeMap<String, BTreeSet<String>>) {
    let sandbox = Sandbox::new();
    sandbox.file("missions.toml", MISSIONS);
    sandbox.file("plans.toml", PLANS);
    let instances = sandbox
        .protean([
            "plan",
            "generate",
            "base",
            "--count",
            "1",
            "--out",
            "instances.json",
        ])
        .run();
    assert_eq!(instances.code, Some(0), "{instances}");
    let mut keys = BTreeMap::new();
    for (name, words, code) in COMMANDS {
        if *name == "clean" {
            // Remains of a run, so that the list is never empty: other tests may leave some in shared memory, too.
            let ended = sandbox.runtime_dir().join("protean/rEnded");
            std::fs::create_dir_all(&ended).unwrap();
            std::fs::write(ended.join("lock"), "").unwrap();
        }
        let outcome = sandbox.protean(words.iter().copied()).arg("--json").run();
        assert_eq!(outcome.code, Some(*code), "{name}: {outcome}");
        let mut found = BTreeSet::new();
        // `plan` prints an object per line.
        for value in serde_json::Deserializer::from_str(&outcome.stdout).into_iter::<Json>() {
            paths(&value.unwrap(), "", &mut found);
        }
        keys.insert((*name).to_owned(), found);
    }
    (sandbox, keys)
}

#[test]
fn json_keys_and_table_headers() {
    let (sandbox, keys) = called();
    super::compare("json_keys.txt", &text(&keys));

    let mut headers = String::new();
    for path in sandbox.files() {
        if path.extension().is_some_and(|e| e == "csv") {
            let name = path
                .strip_prefix(sandbox.path())
                .unwrap()
                .display()
                .to_string();
            let table = std::fs::read_to_string(&path).unwrap();
            writeln!(headers, "{name}: {}", table.lines().next().unwrap()).unwrap();
        }
    }
    super::compare("csv_headers.txt", &headers);
}

#[test]
fn scenario_keys() {
    let sandbox = Sandbox::new();
    let mut keys = BTreeMap::<String, BTreeSet<String>>::new();
    let mut read = |name: &str, set: &[&str]| {
        let mut call = sandbox.protean(["check", name, "--print"]);
        for change in set {
            call = call.set(change);
        }
        let outcome = call.run();
        assert_eq!(outcome.code, Some(0), "{outcome}");
        let mut scenario: Json = toml::from_str(&outcome.stdout).unwrap();
        let processes = scenario
            .as_object_mut()
            .unwrap()
            .remove("processes")
            .unwrap();
        paths(
            &scenario,
            "",
            keys.entry("scenario".to_owned()).or_default(),
        );
        for process in processes.as_array().unwrap() {
            let kind = process["kind"].as_str().unwrap();
            paths(
                process,
                "",
                keys.entry(format!("process {kind}")).or_default(),
            );
        }
    };
    for scenario in SCENARIOS {
        read(scenario.name, &[]);
    }
    for kind in [
        "coverage_keyed",
        "coverage_boustrophedon",
        "coverage_random_bounce",
        "coverage_uniform",
    ] {
        let kind = format!("processes.cover.kind={kind}");
        read("coverage_open", &[&kind, "processes.cover.params={}"]);
    }
    read("patrol_square", &["processes.patrol.kind=patrol_fto"]);
    super::compare("scenario_keys.txt", &text(&keys));
}

#[test]
fn topics() {
    struct Lines(String);
    impl TopicVisitor for Lines {
        type Error = Infallible;

        fn visit<T: Topic>(&mut self) -> Result<(), Infallible> {
            let header = T::Header::DESCRIPTOR.name;
            let element = T::Element::DESCRIPTOR.name;
            let hash = schema::hash::<T>();
            writeln!(
                self.0,
                "{} {:?} {header} {element} {hash}",
                T::NAME,
                T::ARITY
            )
            .unwrap();
            Ok(())
        }
    }
    let mut lines = Lines(String::new());
    let Ok(()) = for_each_topic(&mut lines);
    super::compare("topics.txt", &lines.0);
}
