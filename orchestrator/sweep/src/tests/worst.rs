//! Worst missions in summaries.

use super::super::{Measure, MissionId, Outcome, Results, Row, summary};
use super::*;

fn row(outcome: Outcome, contacts: u32, sim_time_s: f64) -> Row {
    Row {
        outcome,
        sim_time_s,
        contacts,
        ..Row::failed("")
    }
}

fn mission(cell: usize, seed: u64) -> MissionId {
    MissionId { cell, seed }
}

#[test]
fn a_summary_lists_the_worst_missions_with_their_commands_and_logs() {
    let directory = tempfile::tempdir().unwrap();
    let manifest = load(GOOD).unwrap().manifest();
    let mut results = Results::open(directory.path(), &manifest, GOOD).unwrap();
    let (end, limit) = (Outcome::Ended, Outcome::TimeLimit);
    for (cell, seed, row) in [
        (0, 1, row(end, 0, 9.0)),
        (0, 2, row(end, 4, 5.0)),
        (0, 3, row(end, 4, 6.0)),
        (1, 1, row(limit, 0, 60.0)),
        (1, 2, row(end, 1, 5.0)),
        (1, 3, Row::failed("broken")),
    ] {
        results.record(mission(cell, seed), row, 0.1).unwrap();
    }
    let order = |measure: Option<&str>| -> Vec<(String, u64)> {
        let measure = measure.map(|measure| measure.parse().unwrap());
        let json = summary::json(&results, None, measure);
        let worst = json["worst"].as_array().unwrap().iter();
        worst
            .map(|one| {
                let speed = &one["parameters"]["relative_speed"];
                (speed.to_string(), one["seed"].as_u64().unwrap())
            })
            .collect()
    };
    let of = |missions: &[(&str, u64)]| -> Vec<(String, u64)> {
        missions
            .iter()
            .map(|(s, seed)| ((*s).to_owned(), *seed))
            .collect()
    };
    let default = of(&[("1.5", 1), ("0.8", 3), ("0.8", 2), ("1.5", 2)]);
    assert_eq!(order(None), default);
    let shortest = of(&[("0.8", 2), ("1.5", 2), ("0.8", 3), ("0.8", 1), ("1.5", 1)]);
    assert_eq!(order(Some("sim_time_s=min")), shortest);
    assert_eq!(
        order(Some("contacts=max"))[..2],
        of(&[("0.8", 2), ("0.8", 3)])
    );
    assert!(order(Some("first_escape_s=max")).is_empty(), "no value");

    let log = results.logs().join(manifest.log_name(mission(1, 1)));
    std::fs::create_dir(results.logs()).unwrap();
    std::fs::write(&log, "").unwrap();
    let text = summary::text(&results, None, None);
    let lines = format!(
        "  case potential, relative_speed = 1.5, seed 1: time_limit, 0 contacts, 60.00 s\n    \
         protean run chase_exact --set processes.evader_potential.params.threat.gain=0.0 \
         --set teams.evader.limits.v_max=0.45 --seed 1\n    log: {}\n",
        log.display()
    );
    assert!(text.contains(&lines), "{lines} is missing in\n{text}");
}

#[test]
fn a_cell_has_three_worst_missions() {
    let directory = tempfile::tempdir().unwrap();
    let text = changed("count = 3", "count = 5");
    let manifest = load(&text).unwrap().manifest();
    let mut results = Results::open(directory.path(), &manifest, &text).unwrap();
    for seed in 1..=5 {
        let row = row(Outcome::Ended, seed as u32, 12.5);
        results.record(mission(0, seed), row, 0.1).unwrap();
    }
    let json = summary::json(&results, None, Some("contacts=max".parse().unwrap()));
    let worst = json["worst"].as_array().unwrap().iter();
    let seeds: Vec<_> = worst.map(|one| one["seed"].as_u64().unwrap()).collect();
    assert_eq!(seeds, [5, 4, 3]);
}

#[test]
fn a_cell_whose_seeds_have_no_effect_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let manifest = load(GOOD).unwrap().manifest();
    let mut results = Results::open(directory.path(), &manifest, GOOD).unwrap();
    for (cell, seed, digest) in [
        (0, 1, "a"),
        (0, 2, "b"),
        (0, 3, "a"),
        (1, 1, "c"),
        (1, 2, "c"),
        (1, 3, "c"),
    ] {
        let row = Row {
            digest: digest.to_owned(),
            ..row(Outcome::Ended, 0, 9.0)
        };
        results.record(mission(cell, seed), row, 0.1).unwrap();
    }
    let json = summary::json(&results, None, None);
    let cells = json["cells"].as_array().unwrap().iter();
    let histories: Vec<_> = cells.map(|cell| cell["histories"].as_u64()).collect();
    assert_eq!(histories[..2], [Some(2), Some(1)]);
    let text = summary::text(&results, None, None);
    let notes: Vec<&str> = text
        .lines()
        .filter(|line| line.starts_with("note"))
        .collect();
    let note = "note: case potential, relative_speed = 1.5: all 3 seeds gave the same mission; nothing in it is random";
    assert_eq!(notes, [note]);
}

#[test]
fn a_measure_is_a_column_of_numbers_and_its_worse_end() {
    let wrong = [
        "contacts",
        "contacts=high",
        "digest=max",
        "outcome=min",
        "speed=max",
        "=max",
    ];
    let errors = wrong.map(|text| text.parse::<Measure>().unwrap_err().to_string());
    expect![[r#"
        expected COLUMN=max or COLUMN=min; the columns are evaders, escaped, caught, held_out, sim_time_s, first_capture_s, first_escape_s, contacts, evader_distance_m, evader_mean_speed, ticks, escape_possible_fraction, escape_impossible_from_s, coverage_fraction, coverable_fraction, way_m, idleness_mean_s, idleness_worst_s, idleness_std_s, idleness_interval_s, patrol_nearest_m, attacks, attacks_detected, detection_share
        expected COLUMN=max or COLUMN=min; the columns are evaders, escaped, caught, held_out, sim_time_s, first_capture_s, first_escape_s, contacts, evader_distance_m, evader_mean_speed, ticks, escape_possible_fraction, escape_impossible_from_s, coverage_fraction, coverable_fraction, way_m, idleness_mean_s, idleness_worst_s, idleness_std_s, idleness_interval_s, patrol_nearest_m, attacks, attacks_detected, detection_share
        expected COLUMN=max or COLUMN=min; the columns are evaders, escaped, caught, held_out, sim_time_s, first_capture_s, first_escape_s, contacts, evader_distance_m, evader_mean_speed, ticks, escape_possible_fraction, escape_impossible_from_s, coverage_fraction, coverable_fraction, way_m, idleness_mean_s, idleness_worst_s, idleness_std_s, idleness_interval_s, patrol_nearest_m, attacks, attacks_detected, detection_share
        expected COLUMN=max or COLUMN=min; the columns are evaders, escaped, caught, held_out, sim_time_s, first_capture_s, first_escape_s, contacts, evader_distance_m, evader_mean_speed, ticks, escape_possible_fraction, escape_impossible_from_s, coverage_fraction, coverable_fraction, way_m, idleness_mean_s, idleness_worst_s, idleness_std_s, idleness_interval_s, patrol_nearest_m, attacks, attacks_detected, detection_share
        expected COLUMN=max or COLUMN=min; the columns are evaders, escaped, caught, held_out, sim_time_s, first_capture_s, first_escape_s, contacts, evader_distance_m, evader_mean_speed, ticks, escape_possible_fraction, escape_impossible_from_s, coverage_fraction, coverable_fraction, way_m, idleness_mean_s, idleness_worst_s, idleness_std_s, idleness_interval_s, patrol_nearest_m, attacks, attacks_detected, detection_share
        expected COLUMN=max or COLUMN=min; the columns are evaders, escaped, caught, held_out, sim_time_s, first_capture_s, first_escape_s, contacts, evader_distance_m, evader_mean_speed, ticks, escape_possible_fraction, escape_impossible_from_s, coverage_fraction, coverable_fraction, way_m, idleness_mean_s, idleness_worst_s, idleness_std_s, idleness_interval_s, patrol_nearest_m, attacks, attacks_detected, detection_share"#]].assert_eq(&errors.join("\n"));
}
