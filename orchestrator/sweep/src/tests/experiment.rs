//! Meaning of a valid experiment file.

use robot::team::Role;

use super::super::{Metric, Seeds, Value};
use super::*;

#[test]
fn cells_are_all_combinations_case_by_case() {
    let experiment = load(GOOD).unwrap();
    let labels: Vec<String> = experiment
        .cells
        .iter()
        .map(|c| format!("{} {}", c.case, c.values[0]))
        .collect();
    assert_eq!(
        labels,
        [
            "potential 0.8",
            "potential 1.5",
            "potential 2",
            "braitenberg 0.8",
            "braitenberg 1.5",
            "braitenberg 2",
        ]
    );
    assert_eq!(experiment.seeds, Seeds::range(1, 3).unwrap());
    assert_eq!(
        experiment.parameters[0].title,
        "evader speed / Police speed"
    );
    assert_eq!(experiment.run.timeout_s, 100.0);
    assert_eq!(experiment.figures[0].metric, Metric::EscapeChance);
    assert!(experiment.notes().is_empty(), "{:?}", experiment.notes());
}

#[test]
fn a_cell_is_the_scenario_with_its_overrides_and_the_seed() {
    let experiment = load(GOOD).unwrap();
    let cell = &experiment.cells[4];
    assert_eq!(cell.target, "chase_exact");
    // 1.5 times the Police's 0.3 m/s.
    assert_eq!(
        cell.overrides.last().unwrap(),
        "teams.evader.limits.v_max=0.45"
    );
    let scenario = cell.scenario(7).unwrap();
    assert_eq!(scenario.run.seed, 7);
    for robot in scenario
        .world
        .robots
        .iter()
        .filter(|r| r.role() == Role::Evader)
    {
        assert_eq!(robot.model().v_max, 0.45);
        assert_eq!(robot.scan.as_ref().unwrap().beams, 72);
    }
    let kinds: Vec<_> = scenario
        .processes
        .iter()
        .filter_map(|p| p.program.kind_name())
        .collect();
    assert!(kinds.contains(&"evader_braitenberg"));
    assert!(!kinds.contains(&"evader_potential"));
    // As from the command line.
    let same = kinds::load(&cell.target, &cell.overrides, Some(7)).unwrap();
    assert_eq!(same, scenario);
}

#[test]
fn starts_follow_from_the_seed_and_are_common_to_all_cells() {
    let experiment = load(GOOD).unwrap();
    let starts = |cell: usize, seed| -> Vec<_> {
        let scenario = experiment.cells[cell].scenario(seed).unwrap();
        scenario.world.robots.iter().map(|r| r.start).collect()
    };
    assert_eq!(starts(0, 5), starts(5, 5));
    assert_ne!(starts(0, 5), starts(0, 6));
}

#[test]
fn levels_set_several_keys_and_names_have_defaults() {
    let text = r#"
scenario = "builtin:chase"
seeds = { first = 4, count = 2 }
[parameters.knowledge]
set = "processes.pursuer.params.knowledge"
[parameters.pace]
levels.slow = { teams.evader.limits.v_max = 0.1 }
levels.fast = { teams.evader.limits.v_max = 0.9, rules.time_limit = 50 }
[grid]
knowledge = ["exact", "belief"]
pace = ["slow", "fast"]
"#;
    let experiment = load(text).unwrap();
    assert_eq!(experiment.name, "small", "the file's name");
    assert_eq!(experiment.cases[0].name, "chase", "the scenario's name");
    assert_eq!(experiment.cells.len(), 4);
    assert_eq!(experiment.seeds, Seeds::from_values(vec![4, 5]));
    assert_eq!(experiment.cells[0].values[0], Value::Text("exact".into()));
    assert_eq!(
        experiment.cells[0].overrides,
        [
            "processes.pursuer.params.knowledge=\"exact\"",
            "teams.evader.limits.v_max=0.1",
        ]
    );
    let fast = experiment.cells[3].scenario(4).unwrap();
    assert_eq!(fast.world.rules.time_limit, Some(50.0));
}

#[test]
fn a_process_can_be_added() {
    let text = changed(
        "name = \"potential\"\n",
        "name = \"potential\"\nset.\"processes[+]\" = { kind = \"perception\" }\n",
    );
    let scenario = load(&text).unwrap().cells[0].scenario(1).unwrap();
    assert_eq!(scenario.processes.len(), 1 + 4 + 2);
}

#[test]
fn a_scenario_may_be_in_the_folder_of_the_experiment() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::create_dir(directory.path().join("s")).unwrap();
    let hello = scenario::builtin::scenario("hello").unwrap();
    let text = hello.text.replace("maps/hello.toml", "builtin:hello");
    std::fs::write(directory.path().join("s/mine.toml"), text).unwrap();
    let path = directory.path().join("e.toml");
    std::fs::write(
        &path,
        "scenario = \"s/mine.toml\"\nseeds = { first = 1, count = 1 }\n",
    )
    .unwrap();
    let experiment = Experiment::load(&path, &LoadOptions::new(kinds::KINDS)).unwrap();
    assert_eq!(experiment.cells.len(), 1);
    assert_eq!(experiment.cells[0].case, "mine");
    assert!(experiment.cells[0].target.ends_with("s/mine.toml"));
}

#[test]
fn the_hash_covers_everything_that_affects_results() {
    let of = |text: &str| load(text).unwrap().manifest();
    let good = of(GOOD);
    for (from, to) in [
        ("A small experiment", "Another title"),
        ("timeout_s = 100.0", "timeout_s = 7.0"),
        ("name = \"chance\"", "name = \"other\""),
        ("count = 3", "count = 5"),
        ("title = \"evader speed / Police speed\"", ""),
        (
            "threat.gain = 0.0",
            "threat.gain = 0.0\nset.run.pin = \"none\"",
        ),
    ] {
        assert_eq!(good.difference(&of(&changed(from, to))), None, "{to}");
    }
    for (from, to) in [
        ("name = \"small\"", "name = \"smell\""),
        ("name = \"potential\"", "name = \"p\""),
        ("[0.8, 1.5, 2]", "[0.8, 1.5]"),
        ("[0.8, 1.5, 2]", "[1.5, 0.8, 2]"),
        ("gain = 0.0", "gain = 0.1"),
        ("chase_exact", "chase"),
    ] {
        let difference = good.difference(&of(&changed(from, to))).unwrap();
        assert!(difference.contains("compare its experiment.toml"), "{to}");
    }
    let mut newer = good.clone();
    newer.program = "9.9.9".into();
    newer.blake3 = newer.fingerprint();
    assert!(
        good.difference(&newer)
            .unwrap()
            .contains("version 9.9.9 of Protean")
    );
}

#[test]
fn cells_that_are_the_same_scenario_are_noted() {
    let text = changed(
        "threat.gain = 0.0",
        "threat.gain = 0.0\n[[cases]]\nname = \"again\"\nset.processes.evader_potential.params.threat.gain = 0.0\n",
    );
    let notes = load(&text).unwrap().notes();
    assert_eq!(notes.len(), 3);
    assert!(
        notes[0].contains("(potential, 0.8) and (again, 0.8) have the same scenario"),
        "{notes:?}"
    );
}

fn experiments() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments")
}

#[test]
fn the_knowledge_of_the_police_follows_the_case() {
    for file in ["knowledge.toml", "knowledge_paper.toml"] {
        let path = experiments().join(file);
        let experiment = Experiment::load(&path, &LoadOptions::new(kinds::KINDS)).unwrap();
        for cell in &experiment.cells {
            let knowledge = match &*cell.case {
                "exact" => "exact",
                "particle_filter" => "belief",
                other => panic!("{file}: case {other}"),
            };
            let processes = cell.scenario(1).unwrap().processes;
            let known: Vec<_> = processes
                .iter()
                .filter(|p| p.program.kind_name() == Some("pursuer"))
                .map(|p| p.program.params()["knowledge"].clone())
                .collect();
            assert!(!known.is_empty(), "{file}: {cell:?}");
            assert!(known.iter().all(|k| k == knowledge), "{file}: {cell:?}");
        }
    }
}

#[test]
fn the_experiments_of_the_project_are_valid() {
    let folder = experiments();
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        // Experiments of plans have a separate test.
        let planning = super::super::planning::is_planning(&path);
        if !planning && path.extension().is_some_and(|e| e == "toml") {
            let loaded = Experiment::load(&path, &LoadOptions::new(kinds::KINDS));
            let experiment = loaded.unwrap_or_else(|e| panic!("{e}"));
            assert!(experiment.notes().is_empty(), "{:?}", experiment.notes());
            count += 1;
        }
    }
    assert!(count > 0, "no experiments");
}
