use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use config::Diagnostics;

use super::*;
use crate::merge::merge;
use crate::runner::{RunOptions, run};
use crate::shard::Shard;
use crate::spec::LogPolicy;
use crate::{LoadOptions, Results, Seeds};

const SMALL: &str = r#"
kind = "planning"
seeds = { first = 1, count = 4 }
[task]
options.fallbacks = false
[[cases]]
name = "bspline"
[[cases]]
name = "tangent"
set.options.method = "tangent"
[parameters.radius]
levels.small = { instances.radius = [5, 15] }
levels.large = { instances.radius = [20, 30] }
[grid]
radius = ["small", "large"]
"#;

fn load_with(text: &str, options: &LoadOptions) -> Result<PlanExperiment, Diagnostics> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small.toml");
    std::fs::write(&path, text).unwrap();
    assert!(is_planning(&path) || !text.contains("\"planning\""));
    PlanExperiment::load(&path, options)
}

fn load(text: &str) -> Result<PlanExperiment, Diagnostics> {
    load_with(text, &LoadOptions::new(kinds::KINDS))
}

fn carry_out(experiment: &PlanExperiment, out: &Path, shard: &str) {
    carry_out_jobs(experiment, out, shard, 2);
}

fn carry_out_jobs(experiment: &PlanExperiment, out: &Path, shard: &str, jobs: usize) {
    let mut results = PlanResults::open(out, &experiment.manifest(), &experiment.text).unwrap();
    let options = RunOptions {
        jobs,
        shard: Shard::parse(shard).unwrap(),
        retry_failed: false,
        log: LogPolicy::None,
        timeout: Duration::MAX,
        quiet: true,
        interrupted: Arc::new(AtomicBool::new(false)),
    };
    let report = run(experiment, &mut results, &(), &options).unwrap();
    assert!(report.missing.is_empty() && !report.interrupted);
    results.write_tables().unwrap();
}

#[test]
fn merged_shards_equal_the_whole_byte_for_byte() {
    let experiment = load(SMALL).unwrap();
    assert_eq!(experiment.cells.len(), 4);
    assert!(!experiment.cells[0].subject.options.fallbacks);
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    carry_out(&experiment, &at("whole"), "1/1");
    carry_out(&experiment, &at("a"), "1/2");
    carry_out(&experiment, &at("b"), "2/2");
    let merged = merge::<PlanRow>(&[at("a"), at("b")], &at("merged")).unwrap();
    assert!(merged.missing().is_empty());
    assert_eq!(merged.rows().count(), 16);
    assert!(
        merged
            .rows()
            .all(|(mission, _)| merged.cpu_ms(mission).is_some())
    );
    let table = |name: &str| std::fs::read_to_string(at(name).join("results.csv")).unwrap();
    assert_eq!(table("whole"), table("merged"));
    assert!(table("whole").starts_with("case,radius,seed,outcome,honest,obstacles,t_s,"));
    assert!(!table("whole").contains("cpu"));
    // Finished missions do not run again; results of other directories can be reused.
    drop(merged);
    carry_out(&experiment, &at("whole"), "1/1");
    let mut again = PlanResults::open(&at("again"), &experiment.manifest(), "").unwrap();
    let taken = again
        .reuse(&PlanResults::read(&at("whole")).unwrap())
        .unwrap();
    assert_eq!(taken, 16);
    // Results of one kind are not accepted as those of the other.
    let error = Results::<crate::Row>::read(&at("whole")).err().unwrap();
    assert!(error.to_string().contains("Planning"), "{error}");
}

#[test]
fn every_cell_has_its_first_mission_before_any_has_its_second() {
    let experiment = load(SMALL).unwrap();
    let order = |out: &Path| {
        let journal = std::fs::read_to_string(out.join("journal.jsonl")).unwrap();
        let number = |line: &str, key| {
            let json: serde_json::Value = serde_json::from_str(line).unwrap();
            json[key].as_u64().unwrap()
        };
        let lines = journal.lines();
        lines
            .map(|line| (number(line, "seed"), number(line, "cell")))
            .collect::<Vec<_>>()
    };
    let folder = tempfile::tempdir().unwrap();
    let of = |shard: &str| {
        let out = folder.path().join(shard.replace('/', "-"));
        carry_out_jobs(&experiment, &out, shard, 1);
        order(&out)
    };
    let whole: Vec<_> = (1..=4)
        .flat_map(|seed| (0..4).map(move |cell| (seed, cell)))
        .collect();
    assert_eq!(of("1/1"), whole);
    // A part has the missions that it had in any order: cell by cell, every third one.
    let part = [(1, 0), (1, 3), (2, 2), (3, 1), (4, 0), (4, 3)];
    assert_eq!(of("1/3"), part);
}

#[test]
fn keys_of_the_command_line_override_the_file() {
    let options = LoadOptions {
        set: vec![
            "options.method=\"vmc\"".into(),
            "instances.obstacles=[1,2]".into(),
        ],
        seeds: Some(Seeds::parse("5..6").unwrap()),
        ..LoadOptions::new(kinds::KINDS)
    };
    let experiment = load_with(SMALL, &options).unwrap();
    assert!(
        experiment
            .cells
            .iter()
            .all(|c| c.subject.instances.obstacles == [1, 2])
    );
    assert_eq!(experiment.seeds.len(), 2);
    assert_ne!(
        experiment.manifest().blake3,
        load(SMALL).unwrap().manifest().blake3
    );
}

#[test]
fn a_fault_of_an_experiment_is_reported_at_its_line() {
    for (from, to, words) in [
        (
            "fallbacks = false",
            "falbacks = false",
            ["falbacks", "fallbacks"],
        ),
        (
            "fallbacks = false",
            "degree = 77",
            ["`options.degree` is 77", "between 2 and 8"],
        ),
        (
            "\"tangent\"\n[param",
            "\"tangents\"\n[param",
            ["tangents", "tangent"],
        ),
        (
            "[5, 15]",
            "[15, 5]",
            ["`instances.radius`", "the first one not above the second"],
        ),
        ("[5, 15]", "[5, 15, 2]", ["radius", "small.toml"]),
        ("[task]", "[tusk]", ["tusk", "task"]),
        (
            "name = \"bspline\"",
            "name = \"bspline\"\nscenario = \"x\"",
            ["no scenario", "task"],
        ),
        (
            "[grid]",
            "[[figures]]\nname = \"a\"\n[grid]",
            ["figures", "small.toml"],
        ),
        ("count = 4", "count = 0", ["no seeds", "seeds"]),
    ] {
        let text = SMALL.replacen(from, to, 1);
        assert_ne!(text, SMALL, "{from}");
        let error = load(&text).unwrap_err().to_string();
        for word in words {
            assert!(
                error.contains(word),
                "{to}: {word:?} is missing in\n{error}"
            );
        }
    }
}

#[test]
fn every_planning_experiment_of_the_project_is_valid() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments");
    for (name, cells) in [("vmc_lp_sensitivity", 56), ("vmc_lp_tables_3_4", 12)] {
        let path = folder.join(format!("{name}.toml"));
        assert!(is_planning(&path));
        let experiment = PlanExperiment::load(&path, &LoadOptions::new(kinds::KINDS))
            .unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(
            (experiment.cells.len(), experiment.seeds.len()),
            (cells, 500)
        );
    }
}
