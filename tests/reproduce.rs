//! `protean reproduce`: its reports agree, it resumes, and the same seeds give the same bytes.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::support::call::Outcome;
use crate::support::{SOON, Sandbox, until};
use rustix::process::Signal;
use serde_json::Value as Json;

/// The paper whose missions are shortest.
const PAPER: &str = "vmc-lp";

/// Keys of a claim, on which other programs rely.
const KEYS: [&str; 9] = [
    "claim",
    "details",
    "id",
    "ours",
    "paper",
    "published",
    "rule",
    "timed",
    "verdict",
];

/// Reproduces the paper with these seeds.
#[track_caller]
fn reproduce(sandbox: &Sandbox, out: &str, seeds: &str) -> Outcome {
    let words = [
        "reproduce",
        "--paper",
        PAPER,
        "--seeds",
        seeds,
        "--out",
        out,
    ];
    sandbox.protean(words).args(["--quiet", "--json"]).run()
}

/// Returns a report without the rows about CPU times.
fn report(out: &Path) -> (Vec<String>, Json) {
    let text = fs::read_to_string(out.join("reproduce.md")).unwrap();
    let lines = text.lines().filter(|line| !line.contains(" † |"));
    let json = fs::read(out.join("reproduce.json")).unwrap();
    let mut json: Json = serde_json::from_slice(&json).unwrap();
    // Their verdicts are counted there.
    json["papers"] = Json::Null;
    let claims = json["claims"].as_array_mut().unwrap();
    claims.retain(|claim| claim["timed"] == false);
    let lines = lines.filter(|line| !line.starts_with(&format!("| {PAPER} | Report")));
    (lines.map(str::to_owned).collect(), json)
}

/// Returns the experiments and the number of records in their journals.
fn recorded(out: &Path) -> BTreeMap<&'static str, usize> {
    let count = |name| {
        let journal = fs::read_to_string(out.join(name).join("journal.jsonl"));
        (name, journal.map_or(0, |text| text.lines().count()))
    };
    ["vmc_lp_sensitivity", "vmc_lp_tables_3_4"]
        .into_iter()
        .map(count)
        .collect()
}

#[test]
fn reports_agree_and_an_interrupted_reproduction_gives_the_same_bytes() {
    let sandbox = Sandbox::new();
    let path = |out: &str| sandbox.path().join(out);
    let whole = reproduce(&sandbox, "whole", "1..2");
    assert_eq!(whole.code, Some(0), "{whole}");

    // Printed, written, and in the table.
    let written: Json =
        serde_json::from_slice(&fs::read(path("whole/reproduce.json")).unwrap()).unwrap();
    assert_eq!(whole.json(), written);
    let text = fs::read_to_string(path("whole/reproduce.md")).unwrap();
    let page = fs::read_to_string(path("whole/reproduce.html")).unwrap();
    let claims = written["claims"].as_array().unwrap();
    let rows: Vec<Vec<&str>> = text
        .lines()
        .map(|line| line.trim_matches('|').split(" | ").map(str::trim).collect())
        .filter(|cells: &Vec<&str>| cells.len() == 7 && cells[0] == PAPER)
        .collect();
    assert_eq!(rows.len(), claims.len());
    assert!(claims.len() > 40, "{}", claims.len());
    for (row, claim) in rows.iter().zip(claims) {
        let keys: Vec<&String> = claim.as_object().unwrap().keys().collect();
        assert_eq!(keys, KEYS);
        assert_eq!(row[2], claim["published"]["text"]);
        assert_eq!(row[3], claim["ours"]["text"]);
        assert_eq!(row[4], claim["ours"]["interval_text"]);
        let verdict = claim["verdict"].as_str().unwrap().replace('_', " ");
        assert_eq!(row[6].trim_matches('*'), verdict, "{row:?}");
        let id = claim["id"].as_str().unwrap();
        assert_eq!(page.matches(&format!("id=\"{id}\"")).count(), 1, "{id}");
    }
    assert_eq!(page.matches("data:image/svg+xml").count(), 2);
    assert!(path("whole/pages/vmc-lp.md").exists());

    // Fewer seeds first, then killed.
    let missions = recorded(&path("whole"));
    let first = reproduce(&sandbox, "parts", "1..1");
    assert_eq!(first.code, Some(0), "{first}");
    let known = recorded(&path("parts"))["vmc_lp_sensitivity"];
    assert_eq!(2 * known, missions["vmc_lp_sensitivity"]);
    let words = [
        "reproduce",
        "--paper",
        PAPER,
        "--seeds",
        "1..2",
        "--out",
        "parts",
    ];
    let running = sandbox
        .protean(words)
        .args(["--quiet", "--jobs", "1"])
        .start();
    until("a mission to be recorded", SOON, || {
        (recorded(&path("parts"))["vmc_lp_sensitivity"] > known).then_some(())
    });
    running.signal(Signal::KILL);
    running.finish();
    let resumed = reproduce(&sandbox, "parts", "1..2");
    assert_eq!(resumed.code, Some(0), "{resumed}");
    assert_eq!(recorded(&path("parts")), missions);
    assert_eq!(report(&path("parts")), report(&path("whole")));

    // Again from the same results: every byte.
    let files = ["reproduce.md", "reproduce.json", "reproduce.html"];
    let bytes = || files.map(|name| fs::read(path("parts").join(name)).unwrap());
    let before = bytes();
    let again = reproduce(&sandbox, "parts", "1..2");
    assert_eq!(again.code, Some(0), "{again}");
    assert!(bytes() == before);
}

#[test]
fn other_files_are_refused_and_kept() {
    let sandbox = Sandbox::new();
    fs::create_dir(sandbox.path().join("taken")).unwrap();
    sandbox.file("taken/reproduce.md", "mine");
    let words = &["taken/reproduce.md", "no results of a reproduction"];
    reproduce(&sandbox, "taken", "1").refused(2, words);
    let kept = fs::read_to_string(sandbox.path().join("taken/reproduce.md")).unwrap();
    assert_eq!(kept, "mine");
    assert_eq!(
        fs::read_dir(sandbox.path().join("taken")).unwrap().count(),
        1
    );

    fs::create_dir_all(sandbox.path().join("other/vmc_lp_sensitivity")).unwrap();
    sandbox.file("other/vmc_lp_sensitivity/results.csv", "mine");
    reproduce(&sandbox, "other", "1").refused(2, &["vmc_lp_sensitivity", "manifest.json"]);
    reproduce(&sandbox, "new", "2..1").refused(2, &["--seeds"]);
    assert!(!sandbox.path().join("new").exists());
}
