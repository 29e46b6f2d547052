//! Directories of results.

use std::path::Path;

use super::super::merge::merge;
use super::super::{Manifest, MissionId, Outcome, Results, Row, SweepError, summary};
use super::*;

fn manifest() -> Manifest {
    load(GOOD).unwrap().manifest()
}

fn row(escaped: u32) -> Row {
    Row {
        outcome: Outcome::Ended,
        evaders: 2,
        escaped,
        caught: 2 - escaped,
        sim_time_s: 12.5,
        ticks: 250,
        digest: "d".repeat(64),
        ..Row::failed("")
    }
}

fn mission(cell: usize, seed: u64) -> MissionId {
    MissionId { cell, seed }
}

/// The error without the name of the directory of the test.
fn words<T>(result: Result<T, SweepError>, directory: &Path) -> String {
    let error = result.err().unwrap().to_string();
    error.replace(&directory.display().to_string(), "FOLDER")
}

fn open(directory: &Path) -> Result<Results, SweepError> {
    Results::open(directory, &manifest(), GOOD)
}

fn table(directory: &Path) -> String {
    std::fs::read_to_string(directory.join("results.csv")).unwrap()
}

#[test]
fn the_table_is_in_the_order_of_the_experiment() {
    let missions: Vec<_> = (0..6)
        .flat_map(|c| (1..=3).map(move |s| mission(c, s)))
        .collect();
    let written = |order: &mut dyn Iterator<Item = &MissionId>| {
        let directory = tempfile::tempdir().unwrap();
        let mut results = open(directory.path()).unwrap();
        for &m in order {
            results
                .record(m, row((m.cell as u32 + m.seed as u32) % 3), 0.1)
                .unwrap();
        }
        results.write_tables().unwrap();
        table(directory.path())
    };
    let straight = written(&mut missions.iter());
    assert_eq!(straight, written(&mut missions.iter().rev()));
    let mut lines = straight.lines();
    assert!(
        lines
            .next()
            .unwrap()
            .starts_with("case,relative_speed,seed,outcome,evaders,escaped")
    );
    assert!(
        lines
            .next()
            .unwrap()
            .starts_with("potential,0.8,1,ended,2,1,1,0,12.5,")
    );
    assert_eq!(lines.count(), 17);
}

#[test]
fn recorded_rows_are_read_again_and_results_replace_failures() {
    let directory = tempfile::tempdir().unwrap();
    let mut results = open(directory.path()).unwrap();
    results.record(mission(0, 1), row(1), 0.1).unwrap();
    results
        .record(mission(0, 2), Row::failed("process x ended"), 0.1)
        .unwrap();
    drop(results);
    let mut results = open(directory.path()).unwrap();
    assert_eq!(results.row(mission(0, 1)), Some(&row(1)));
    assert!(results.row(mission(0, 2)).unwrap().is_failed());
    assert_eq!(results.missing().len(), 16);
    results.record(mission(0, 2), row(2), 0.1).unwrap();
    drop(results);
    let mut results = open(directory.path()).unwrap();
    assert_eq!(results.row(mission(0, 2)), Some(&row(2)));
    let other = results.record(mission(0, 2), row(0), 0.1);
    expect!["FOLDER: two different results of case potential, relative_speed = 0.8, seed 2: caught 0 and 2; a result depends only on the experiment, so one of them was made by another program: remove one of the two directories"].assert_eq(&words(other, directory.path()));
}

#[test]
fn results_of_another_experiment_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    open(directory.path()).unwrap();
    let other = load(&changed("gain = 0.0", "gain = 1.0"))
        .unwrap()
        .manifest();
    let another = Results::<Row>::open(directory.path(), &other, "");
    let path = directory.path().join("manifest.json");
    let with = |manifest: &str| {
        std::fs::write(&path, manifest).unwrap();
        words(open(directory.path()), directory.path())
    };
    let mut errors = vec![words(another, directory.path())];
    // Other formats may have any other content.
    errors.extend([r#"{"format": 99, "future": true}"#, "no json"].map(with));
    std::fs::remove_file(&path).unwrap();
    errors.push(words(open(directory.path()), directory.path()));
    expect![[r#"
        FOLDER contains the results of another experiment: compare its experiment.toml and its scenarios with yours; choose another --out, or remove the directory if its results are no longer needed
        FOLDER contains the results of another experiment: its files have format 99, this program writes format 3; choose another --out, or remove the directory if its results are no longer needed
        FOLDER/manifest.json:1: expected ident at line 1 column 2: no json: expected the manifest of a sweep's results
        FOLDER is not a directory of results: it has no manifest.json; choose another --out, or an empty directory"#]].assert_eq(&errors.join("\n"));
}

#[test]
fn an_edited_manifest_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    open(directory.path()).unwrap();
    let path = directory.path().join("manifest.json");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace("\"potential\"", "\"best\"")).unwrap();
    let error = words(open(directory.path()), directory.path());
    expect!["FOLDER/manifest.json:1: its hash does not match: it was edited: {"]
        .assert_eq(error.lines().next().unwrap());
}

#[test]
fn a_second_sweep_in_a_directory_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let first = open(directory.path()).unwrap();
    let error = open(directory.path()).err().unwrap();
    assert!(matches!(error, SweepError::InUse { .. }), "{error}");
    drop(first);
    open(directory.path()).unwrap();
}

#[test]
fn a_directory_that_is_refused_stays_as_it_is() {
    let names = |directory: &Path| {
        let entries = std::fs::read_dir(directory).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let directory = tempfile::tempdir().unwrap();
    let users = directory.path().join("experiment.toml");
    std::fs::write(&users, "their own").unwrap();
    expect!["FOLDER is not a directory of results: it has no manifest.json; choose another --out, or an empty directory"].assert_eq(&words(open(directory.path()), directory.path()));
    assert_eq!(names(directory.path()), ["experiment.toml"]);
    assert_eq!(std::fs::read_to_string(&users).unwrap(), "their own");
    // Copied results of another experiment, without the lock.
    std::fs::write(directory.path().join("manifest.json"), "no json").unwrap();
    open(directory.path()).err().unwrap();
    assert_eq!(
        names(directory.path()),
        ["experiment.toml", "manifest.json"]
    );
}

#[test]
fn a_link_in_the_place_of_the_lock_is_refused_and_its_target_stays() {
    let directory = tempfile::tempdir().unwrap();
    let target = directory.path().join("target");
    std::fs::write(&target, "their own").unwrap();
    let results = directory.path().join("results");
    std::fs::create_dir(&results).unwrap();
    std::os::unix::fs::symlink(&target, results.join("lock")).unwrap();
    expect!["FOLDER/results/lock: cannot be opened: it is a symbolic link"]
        .assert_eq(&words(open(&results), directory.path()));
    assert_eq!(std::fs::read_to_string(&target).unwrap(), "their own");
    assert_eq!(std::fs::read_dir(&results).unwrap().count(), 1);
}

#[test]
fn more_seeds_continue_the_same_results() {
    let directory = tempfile::tempdir().unwrap();
    open(directory.path())
        .unwrap()
        .record(mission(0, 1), row(1), 0.1)
        .unwrap();
    let more = load(&changed("first = 1, count = 3", "first = 3, count = 2"))
        .unwrap()
        .manifest();
    let results: Results = Results::open(directory.path(), &more, "").unwrap();
    assert_eq!(results.manifest().seeds.to_string(), "1..4");
    assert_eq!(results.missing().len(), 6 * 4 - 1);
}

#[test]
fn parts_merge_to_the_table_of_the_whole() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let mut whole = open(&at("whole")).unwrap();
    for number in 0..18_usize {
        let m = mission(number / 3, number as u64 % 3 + 1);
        let row = if number == 5 {
            Row::failed("x")
        } else {
            row(number as u32 % 3)
        };
        whole.record(m, row.clone(), 0.1).unwrap();
        // The last part has only some of its missions.
        if number != 17 {
            let mut part = open(&at(&format!("part-{}", number % 3))).unwrap();
            part.record(m, row, 0.1).unwrap();
        }
    }
    whole.write_tables().unwrap();
    let parts = [at("part-2"), at("part-0"), at("part-1")];
    let merged: Results = merge(&parts, &at("merged")).unwrap();
    assert_eq!(merged.missing(), [mission(5, 3)]);
    drop(merged);
    open(&at("part-2"))
        .unwrap()
        .record(mission(5, 3), row(17 % 3), 0.1)
        .unwrap();
    // The target already contains results.
    assert!(
        merge::<Row>(&parts[..1], &at("merged"))
            .unwrap()
            .missing()
            .is_empty()
    );
    assert_eq!(table(&at("merged")), table(&at("whole")));
    assert!(!at("part-0").join("results.csv").exists());
}

#[test]
fn parts_that_do_not_belong_together_are_not_merged() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    open(&at("a"))
        .unwrap()
        .record(mission(0, 1), row(1), 0.1)
        .unwrap();
    let other = load(&changed("name = \"small\"", "name = \"big\""))
        .unwrap()
        .manifest();
    Results::<Row>::open(&at("b"), &other, "").unwrap();
    open(&at("c"))
        .unwrap()
        .record(mission(0, 1), row(2), 0.1)
        .unwrap();
    let merged = |parts: &[&str], out| {
        let parts: Vec<_> = parts.iter().map(|part| at(part)).collect();
        words(merge::<Row>(&parts, &at(out)), directory.path())
    };
    let errors = [
        merged(&["a", "b"], "m"),
        merged(&["a", "c"], "n"),
        merged(&["nothing"], "o"),
    ];
    expect![[r#"
        FOLDER/b contains the results of another experiment: compare its experiment.toml and its scenarios with yours; choose another --out, or remove the directory if its results are no longer needed
        FOLDER/c: two different results of case potential, relative_speed = 0.8, seed 1: caught 1 and 0; a result depends only on the experiment, so one of them was made by another program: remove one of the two directories
        FOLDER/nothing is not a directory of results: it has no manifest.json; name the --out of a sweep"#]].assert_eq(&errors.join("\n"));
}

#[test]
fn missions_of_the_same_scenario_are_reused_from_another_experiment() {
    let directories = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let mut older = open(directories[0].path()).unwrap();
    // Cells 0 to 2 are of `potential`, 3 to 5 of `braitenberg`.
    for (at, row) in [
        (mission(0, 1), row(0)),
        (mission(3, 1), row(2)),
        (mission(3, 2), Row::failed("bad luck")),
        (mission(4, 2), row(1)),
        (mission(4, 3), row(1)),
    ] {
        older.record(at, row, 0.1).unwrap();
    }
    // The same scenarios under another name, others under the same, and fewer seeds.
    let text = changed("name = \"braitenberg\"", "name = \"renamed\"")
        .replace("gain = 0.0", "gain = 1.0")
        .replace("count = 3", "count = 2");
    let manifest = load(&text).unwrap().manifest();
    let mut newer = Results::open(directories[1].path(), &manifest, &text).unwrap();
    assert_eq!(newer.reuse(&older).unwrap(), 2);
    let expected = [(mission(3, 1), &row(2)), (mission(4, 2), &row(1))];
    assert_eq!(newer.rows().collect::<Vec<_>>(), expected);
    assert_eq!(newer.reuse(&older).unwrap(), 0);
    // They are stored like others.
    drop(newer);
    let newer = Results::open(directories[1].path(), &manifest, &text).unwrap();
    assert_eq!(newer.rows().collect::<Vec<_>>(), expected);
}

#[test]
fn contradicting_results_and_those_of_other_versions_are_not_reused() {
    let directories = [(); 3].map(|()| tempfile::tempdir().unwrap());
    let mut older = open(directories[0].path()).unwrap();
    let mut newer = open(directories[1].path()).unwrap();
    older.record(mission(0, 1), row(0), 0.1).unwrap();
    newer.record(mission(0, 1), row(1), 0.1).unwrap();
    let error = newer.reuse(&older).unwrap_err();
    assert!(matches!(error, SweepError::Contradiction { .. }), "{error}");
    let mut manifest = manifest();
    manifest.program = "0.0.1".to_owned();
    manifest.blake3 = manifest.fingerprint();
    let older = Results::open(directories[2].path(), &manifest, GOOD).unwrap();
    expect!["FOLDER contains the results of another experiment: it was made by version 0.0.1 of Protean, this is version 0.2.0; choose another --out, or remove the directory if its results are no longer needed"].assert_eq(&words(newer.reuse(&older), directories[2].path()));
}

#[test]
fn the_summary_counts_games_and_repeats_failures() {
    let directory = tempfile::tempdir().unwrap();
    let mut results = open(directory.path()).unwrap();
    results.record(mission(1, 1), row(2), 0.1).unwrap();
    results.record(mission(1, 2), row(0), 0.1).unwrap();
    results
        .record(mission(1, 3), Row::failed("it's \"broken\"\nmore"), 0.1)
        .unwrap();
    let cells = summary::cells(&results);
    assert_eq!((cells[1].games, cells[1].failed), (2, 1));
    assert_eq!((cells[1].evaders, cells[1].escaped), (4, 2));
    assert_eq!(cells[1].escape_chance, Some(0.5));
    assert_eq!(cells[0].escape_chance, None);
    let text = summary::text(&results, None, None);
    for word in [
        "2/4",
        "0.500",
        "seed 3: it's \"broken\"",
        "protean run chase_exact --set processes.evader_potential.params.threat.gain=0.0 \
         --set teams.evader.limits.v_max=0.45 --seed 3",
        "15 missions are missing",
        "case potential, relative_speed = 0.8: seeds 1..3",
    ] {
        assert!(text.contains(word), "{word} is missing in\n{text}");
    }
    let json = summary::json(&results, None, None);
    assert_eq!(json["cells"][1]["wilson_95"].as_array().unwrap().len(), 2);
    assert_eq!(json["failures"][0]["seed"], 3);
    assert_eq!(json["missing"].as_array().unwrap().len(), 15);
}

#[test]
fn a_summary_has_the_columns_of_what_the_missions_have() {
    let directory = tempfile::tempdir().unwrap();
    let text = changed("title = \"A small experiment\"\n", "");
    let manifest = load(&text).unwrap().manifest();
    let mut results = Results::open(directory.path(), &manifest, &text).unwrap();
    for (seed, time_s) in [(1, 4.5), (2, 5.25)] {
        let robots = vec![recorder::RobotOutcome {
            outcome: "goal_reached".to_owned(),
            time_s,
            ..recorder::RobotOutcome::default()
        }];
        let arrived = Row {
            evaders: 0,
            escaped: 0,
            caught: 0,
            robots,
            ..row(0)
        };
        results.record(mission(0, seed), arrived, 0.1).unwrap();
    }
    let text = summary::text(&results, None, None);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "small", "no title twice");
    let titles: Vec<&str> = lines[2].split_whitespace().collect();
    let expected = "case relative_speed games arrived arrival (s) time (s)";
    assert_eq!(titles.join(" "), expected);
    let cells: Vec<&str> = lines[4].split_whitespace().collect();
    assert_eq!(
        cells,
        ["potential", "0.8", "2", "2", "4.88", "12.50"],
        "{text}"
    );
}
