//! Summaries of the cells of an experiment: a table as text, and JSON.

use std::collections::{BTreeMap, BTreeSet};

use platform::shell;
use recorder::time_text;
use serde_json::{Map, Value as Json, json};
use statistics::{Interval, Mean, Sample, Z95, wilson};
use tables::{Importance, TerminalTable};

use super::manifest::Manifest;
use super::mission_id::MissionId;
use super::results::Results;
use super::row::{Record, Row};
use super::runner::RunReport;
use super::worst::{Measure, worst};

/// Maximum number of failures listed on a terminal; JSON and the table of results contain all.
const SHOWN: usize = 20;
/// Maximum number of worst missions listed on a terminal; JSON contains those of all cells.
const WORST_SHOWN: usize = 5;

/// Summary of the games of one cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellSummary {
    /// Index of the cell.
    pub cell: usize,
    /// Games that ended.
    pub games: usize,
    /// Games that failed.
    pub failed: usize,
    /// Different histories among the games that ended; 1 if seeds have no effect.
    pub histories: usize,
    /// Evaders of these games.
    pub evaders: u64,
    /// Evaders that escaped.
    pub escaped: u64,
    /// Evaders that were caught.
    pub caught: u64,
    /// Part of the evaders that escaped; `None` without evaders.
    pub escape_chance: Option<f64>,
    /// Wilson 95 % interval of the escape chance, with evaders as independent outcomes.
    pub independent: Option<Interval>,
    /// 95 % interval of the escape chance, with games as independent outcomes.
    pub by_game: Option<Interval>,
    /// Mean simulated length of a game (s).
    pub mean_time_s: Option<f64>,
    /// Contact episodes per game.
    pub contacts: Option<f64>,
    /// Robots with a goal that reached it.
    pub arrived: usize,
    /// Mean simulated time of arrival (s).
    pub arrival_s: Option<f64>,
    /// Mean share of the area visited.
    pub coverage: Option<f64>,
    /// Mean length of a lap (m).
    pub lap_m: Option<f64>,
    /// Detected attacks among those of each adversary, by the name of its method; missions are the groups.
    pub detections: BTreeMap<String, Sample>,
}

/// Summarises every cell, in the order of the experiment.
pub fn cells(results: &Results) -> Vec<CellSummary> {
    let mut rows: Vec<Vec<&Row>> = vec![Vec::new(); results.manifest().cells.len()];
    for (mission, row) in results.rows() {
        if let Some(rows) = rows.get_mut(mission.cell) {
            rows.push(row);
        }
    }
    rows.iter()
        .enumerate()
        .map(|(cell, rows)| summarise(cell, rows))
        .collect()
}

fn summarise(cell: usize, rows: &[&Row]) -> CellSummary {
    let played: Vec<&Row> = rows.iter().copied().filter(|r| !r.is_failed()).collect();
    let escapes: Sample = played.iter().map(|r| (r.escaped, r.evaders)).collect();
    let share = escapes.share();
    let sum = |f: fn(&Row) -> u32| played.iter().map(|r| u64::from(f(r))).sum::<u64>();
    let mean = |sum: f64| (!played.is_empty()).then(|| sum / played.len() as f64);
    let mean_of = |value: fn(&Row) -> Option<f64>| {
        let values: Vec<f64> = played.iter().filter_map(|row| value(row)).collect();
        Mean::from_values(&values).map(|mean| mean.value)
    };
    let robots = played.iter().flat_map(|row| &row.robots);
    let arrivals = robots.filter(|robot| robot.outcome == "goal_reached");
    let arrivals: Vec<f64> = arrivals.map(|robot| robot.time_s).collect();
    let mut detections: BTreeMap<String, Sample> = BTreeMap::new();
    for adversary in played.iter().flat_map(|row| &row.attacks) {
        let sample = detections.entry(adversary.method.clone()).or_default();
        sample.add(adversary.detected, adversary.attacks);
    }
    let histories: BTreeSet<&str> = played.iter().map(|row| row.digest.as_str()).collect();
    CellSummary {
        cell,
        games: played.len(),
        failed: rows.len() - played.len(),
        histories: histories.len(),
        evaders: sum(|r| r.evaders),
        escaped: sum(|r| r.escaped),
        caught: sum(|r| r.caught),
        escape_chance: share,
        independent: share.map(|_| wilson(escapes.hits(), escapes.members())),
        by_game: share.map(|_| escapes.interval(Z95)),
        mean_time_s: mean(played.iter().map(|r| r.sim_time_s).sum()),
        contacts: mean(sum(|r| r.contacts) as f64),
        arrived: arrivals.len(),
        arrival_s: Mean::from_values(&arrivals).map(|mean| mean.value),
        coverage: mean_of(|row| Some(row.coverage.as_ref()?.coverable_fraction)),
        lap_m: mean_of(lap_m),
        detections,
    }
}

/// Returns the mean length of a planned lap over the robots that have one (m).
fn lap_m(row: &Row) -> Option<f64> {
    let visits = row.robots.iter().filter_map(|r| r.waypoints.as_ref());
    let lengths: Vec<f64> = visits.filter_map(|w| Some(w.planned?.length_m)).collect();
    Mean::from_values(&lengths).map(|mean| mean.value)
}

/// Returns the missions that failed.
fn failures(results: &Results) -> Vec<(MissionId, &Row)> {
    results.rows().filter(|(_, row)| row.is_failed()).collect()
}

/// Returns the missing missions: those of this sweep, or of the whole experiment.
pub(super) fn missing<R: Record>(
    results: &Results<R>,
    report: Option<&RunReport>,
) -> Vec<MissionId> {
    report.map_or_else(|| results.missing(), |report| report.missing.clone())
}

/// Returns a table with one line per cell: the case and the parameters, then `columns` with the cells of each row. The
/// only case of several cells is left out on a narrow terminal.
pub(super) fn cell_table(
    manifest: &Manifest,
    columns: &[(&str, Importance)],
    rows: impl Iterator<Item = Vec<String>>,
) -> TerminalTable {
    let cases: BTreeSet<&str> = manifest
        .cells
        .iter()
        .map(|cell| cell.case.as_str())
        .collect();
    let is_alone = cases.len() == 1 && !manifest.parameters.is_empty();
    let parameters = manifest.parameters.iter().map(|name| (name.as_str(), 0));
    let header = std::iter::once(("case", if is_alone { Importance::MAX } else { 0 }));
    let header = header.chain(parameters).chain(columns.iter().copied());
    let mut table = TerminalTable::new(header, 1);
    for (cell, row) in manifest.cells.iter().zip(rows) {
        let values = cell.values.iter().map(ToString::to_string);
        table.add_row(std::iter::once(cell.case.clone()).chain(values).chain(row));
    }
    table
}

/// Returns the first line of a summary: the name of the experiment, and its title if it has one.
pub(super) fn heading(manifest: &Manifest) -> String {
    if manifest.title == manifest.experiment {
        return manifest.experiment.clone();
    }
    format!("{}: {}", manifest.experiment, manifest.title)
}

/// Formats an interval of a share.
pub(super) fn interval(interval: Option<Interval>) -> String {
    interval.map_or_else(|| "-".into(), |i| format!("{:.3} .. {:.3}", i.low, i.high))
}

/// Returns the rate at which missions or plans were executed; empty if there were none.
pub(super) fn pace(report: Option<&RunReport>, unit: &str) -> String {
    report
        .filter(|report| report.carried_out > 0)
        .map_or_else(String::new, |report| {
            format!(
                "\n{} {unit} in {:.1} s, {:.1} per second\n",
                report.carried_out,
                report.wall_time_s,
                report.carried_out as f64 / report.wall_time_s.max(1e-9),
            )
        })
}

/// Returns the values of a cell's parameters by name.
pub(super) fn parameters(names: &[String], values: &[impl serde::Serialize]) -> Map<String, Json> {
    let values = values.iter().map(|value| json!(value));
    names.iter().cloned().zip(values).collect()
}

/// Returns the common keys of the JSON objects of all experiments.
pub(super) fn json_head<R: Record>(
    results: &Results<R>,
    report: Option<&RunReport>,
) -> Map<String, Json> {
    let manifest = results.manifest();
    let head = [
        ("experiment", json!(manifest.experiment)),
        ("blake3", json!(manifest.blake3)),
        ("program", json!(manifest.program)),
        ("out", json!(results.directory())),
        ("missions", json!(results.rows().count())),
        ("carried_out", json!(report.map(|r| r.carried_out))),
        ("known", json!(report.map(|r| r.known))),
        ("wall_time_s", json!(report.map(|r| r.wall_time_s))),
        ("interrupted", json!(report.is_some_and(|r| r.interrupted))),
    ];
    head.map(|(key, value)| (key.to_owned(), value))
        .into_iter()
        .collect()
}

/// Returns the command that runs one mission again.
pub fn command(results: &Results, mission: MissionId) -> String {
    let Some(cell) = results.manifest().cells.get(mission.cell) else {
        return String::new();
    };
    let mut words = vec!["protean", "run", cell.scenario.as_str()];
    for set in &cell.set {
        words.extend(["--set", set.as_str()]);
    }
    let seed = mission.seed.to_string();
    words.extend(["--seed", seed.as_str()]);
    words.extend(cell.external.then_some("--allow-external"));
    shell::line(words)
}

/// Title, importance and text of a column of the cells.
type CellColumn<'a> = (
    &'a str,
    Importance,
    Box<dyn Fn(&CellSummary) -> String + 'a>,
);

/// Returns the summary as text: a table of the cells, failures and the worst missions by the measure with the command
/// that repeats them, and missing missions.
pub fn text(results: &Results, report: Option<&RunReport>, measure: Option<Measure>) -> String {
    let manifest = results.manifest();
    let summaries = cells(results);
    let has = |fact: fn(&CellSummary) -> bool| summaries.iter().any(fact);
    let or_none = |value: Option<f64>, digits: usize| {
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
    };
    // What no mission has is no column.
    let mut columns: Vec<CellColumn<'_>> = vec![("games", 0, Box::new(|c| c.games.to_string()))];
    if has(|c| c.evaders > 0) {
        columns.push((
            "escaped",
            2,
            Box::new(|c| format!("{}/{}", c.escaped, c.evaders)),
        ));
        columns.push(("chance", 0, Box::new(move |c| or_none(c.escape_chance, 3))));
        columns.push(("95 % interval", 1, Box::new(|c| interval(c.independent))));
        columns.push(("by game", 4, Box::new(|c| interval(c.by_game))));
    }
    if has(|c| c.arrived > 0) {
        columns.push(("arrived", 0, Box::new(|c| c.arrived.to_string())));
        columns.push((
            "arrival (s)",
            0,
            Box::new(|c| c.arrival_s.map_or_else(|| "-".to_owned(), time_text)),
        ));
    }
    if has(|c| c.coverage.is_some()) {
        columns.push(("coverage", 1, Box::new(move |c| or_none(c.coverage, 3))));
    }
    if has(|c| c.lap_m.is_some()) {
        columns.push(("lap (m)", 1, Box::new(move |c| or_none(c.lap_m, 2))));
    }
    let adversaries: BTreeSet<&String> =
        summaries.iter().flat_map(|c| c.detections.keys()).collect();
    for method in adversaries {
        // Detected attacks and their share, with its Wilson interval.
        let cell = move |c: &CellSummary| {
            let sample = c.detections.get(method).copied().unwrap_or_default();
            let (hits, members) = (sample.hits(), sample.members());
            let of = wilson(hits, members);
            format!("{hits}/{members}, {:.2} .. {:.2}", of.low, of.high)
        };
        columns.push((method, 1, Box::new(cell)));
    }
    columns.push((
        "time (s)",
        3,
        Box::new(|c| c.mean_time_s.map_or_else(|| "-".to_owned(), time_text)),
    ));
    let titles: Vec<_> = columns
        .iter()
        .map(|(title, importance, _)| (*title, *importance))
        .collect();
    let rows = summaries.iter();
    let rows = rows.map(|summary| columns.iter().map(|(_, _, cell)| cell(summary)).collect());
    let table = cell_table(manifest, &titles, rows);
    let mut text = format!("{}\n\n{table}\n", heading(manifest));
    text += &pace(report, "missions");
    for one in summaries.iter().filter(|c| c.games > 1 && c.histories == 1) {
        text += &format!(
            "\nnote: {}: all {} seeds gave the same mission; nothing in it is random\n",
            manifest.describe(one.cell),
            one.games
        );
    }
    let failures = failures(results);
    if !failures.is_empty() {
        text += &format!("\n{} missions failed; to repeat one:\n", failures.len());
        for (mission, row) in failures.iter().take(SHOWN) {
            let reason = row.error.lines().next().unwrap_or_default();
            text += &listed(results, *mission, reason);
        }
        if failures.len() > SHOWN {
            text += &format!("  … and {} more, see results.csv\n", failures.len() - SHOWN);
        }
        text += "--retry-failed runs them again\n";
    }
    let worst = worst(results, measure);
    if !worst.is_empty() {
        let order = match measure {
            Some(_) => "",
            None => " at the time limit, or with contacts (--worst COLUMN=max|min: by a column)",
        };
        text += &format!("\nworst missions{order}:\n");
        for (mission, reason) in worst.iter().take(WORST_SHOWN) {
            text += &listed(results, *mission, reason);
        }
    }
    let missing = missing(results, report);
    if !missing.is_empty() {
        text += &format!("\n{} missions are missing:\n", missing.len());
        for line in ranges(results, &missing).iter().take(SHOWN) {
            text += &format!("  {line}\n");
        }
    }
    text
}

/// Returns the lines of a mission in a list: what is the matter, the command that repeats it, and its log if there is one.
fn listed(results: &Results, mission: MissionId, reason: &str) -> String {
    let (name, command) = (results.describe(mission), command(results, mission));
    let log = results.log(mission);
    let log = log.map_or_else(String::new, |log| format!("    log: {}\n", log.display()));
    format!("  {name}: {reason}\n    {command}\n{log}")
}

/// Returns missing missions cell by cell: `case potential, relative_speed = 1.5: seeds 3..7, 9`.
fn ranges(results: &Results, missing: &[MissionId]) -> Vec<String> {
    missing
        .chunk_by(|a, b| a.cell == b.cell)
        .filter_map(|of_cell| {
            let cell = of_cell.first()?.cell;
            let seeds = super::Seeds::from_values(of_cell.iter().map(|m| m.seed).collect());
            Some(format!(
                "{}: seeds {seeds}",
                results.manifest().describe(cell)
            ))
        })
        .collect()
}

/// Returns the summary as JSON.
pub fn json(results: &Results, report: Option<&RunReport>, measure: Option<Measure>) -> Json {
    let manifest = results.manifest();
    let labels = |cell: usize| {
        let values = manifest
            .cells
            .get(cell)
            .map_or(&[][..], |c| c.values.as_slice());
        let parameters = parameters(&manifest.parameters, values);
        (manifest.cells.get(cell).map(|c| c.case.clone()), parameters)
    };
    let cells: Vec<Json> = cells(results)
        .into_iter()
        .map(|c| {
            let (case, parameters) = labels(c.cell);
            let ends = |i: Interval| json!([i.low, i.high]);
            let detection = |(method, sample): (&String, &Sample)| {
                json!({
                    "adversary": method,
                    "attacks": sample.members(),
                    "detected": sample.hits(),
                    "detection_share": sample.share(),
                    "wilson_95": ends(wilson(sample.hits(), sample.members())),
                    "by_game_95": ends(sample.interval(Z95)),
                })
            };
            let detections: Vec<Json> = c.detections.iter().map(detection).collect();
            json!({
                "case": case,
                "parameters": parameters,
                "games": c.games,
                "failed": c.failed,
                "histories": c.histories,
                "evaders": c.evaders,
                "escaped": c.escaped,
                "caught": c.caught,
                "escape_chance": c.escape_chance,
                "wilson_95": c.independent.map(ends),
                "by_game_95": c.by_game.map(ends),
                "mean_time_s": c.mean_time_s,
                "contacts_per_game": c.contacts,
                "detections": detections,
            })
        })
        .collect();
    let listed = |mission: MissionId, key: &str, reason: &str| {
        let (case, parameters) = labels(mission.cell);
        json!({
            "case": case,
            "parameters": parameters,
            "seed": mission.seed,
            key: reason,
            "command": command(results, mission),
            "log": results.log(mission),
        })
    };
    let failures = failures(results).into_iter();
    let failures: Vec<Json> = failures
        .map(|(mission, row)| listed(mission, "error", &row.error))
        .collect();
    let worst = worst(results, measure).into_iter();
    let worst: Vec<Json> = worst
        .map(|(mission, reason)| listed(mission, "reason", &reason))
        .collect();
    let missing: Vec<Json> = missing(results, report)
        .into_iter()
        .map(|mission| {
            let (case, parameters) = labels(mission.cell);
            json!({ "case": case, "parameters": parameters, "seed": mission.seed })
        })
        .collect();
    let mut all = json_head(results, report);
    all.extend([
        ("cells".to_owned(), json!(cells)),
        ("failures".to_owned(), json!(failures)),
        ("worst".to_owned(), json!(worst)),
        ("missing".to_owned(), json!(missing)),
    ]);
    Json::Object(all)
}
