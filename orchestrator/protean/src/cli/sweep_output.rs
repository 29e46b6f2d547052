//! Output of `protean sweep`: missions to run, and results.

use std::collections::BTreeMap;
use std::process::ExitCode;

use platform::eprintln;
use serde_json::{Value as Json, json};

use super::output::{EXIT_PARTIAL, print, print_json};
use super::sweep_kind::SweepKind;
use sweep::runner::RunReport;
use sweep::{Manifest, Measure, MissionId, Record as _, Results};

/// Missions that a sweep would run.
pub struct Listing<'a> {
    /// Manifest of the experiment.
    pub manifest: &'a Manifest,
    /// Missions to run.
    pub open: &'a [MissionId],
    /// Number of finished missions.
    pub known: usize,
    /// Name of the missions: `missions to run`.
    pub what: &'a str,
}

/// Prints the missions that a sweep would run; `details` returns fields of a cell besides case and parameters.
pub fn list(listing: &Listing<'_>, as_json: bool, details: impl Fn(usize) -> Json) {
    let manifest = listing.manifest;
    if as_json {
        let mission = |mission: &MissionId| {
            let cell = manifest.cells.get(mission.cell)?;
            let parameters: BTreeMap<_, _> = manifest.parameters.iter().zip(&cell.values).collect();
            let mut json = json!({
                "case": cell.case,
                "parameters": parameters,
                "seed": mission.seed,
            });
            if let (Json::Object(all), Json::Object(more)) = (&mut json, details(mission.cell)) {
                all.extend(more);
            }
            Some(json)
        };
        print_json(&json!({
            "experiment": manifest.experiment,
            "blake3": manifest.blake3,
            "cells": manifest.cells.len(),
            "seeds": manifest.seeds,
            "known": listing.known,
            "missions": listing.open.iter().filter_map(mission).collect::<Vec<_>>(),
        }));
        return;
    }
    for mission in listing.open {
        print(&format!(
            "{}, seed {}",
            manifest.describe(mission.cell),
            mission.seed
        ));
    }
    eprintln!(
        "{}: {} cells, seeds {}; {} {}, {} done",
        manifest.experiment,
        manifest.cells.len(),
        manifest.seeds,
        listing.open.len(),
        listing.what,
        listing.known,
    );
}

/// Prints the summary of results with the worst missions by a measure, without notes if `quiet`; returns the exit code.
pub fn conclude<S: SweepKind>(
    results: &Results<S::Row>,
    report: Option<&RunReport>,
    worst: Option<Measure>,
    as_json: bool,
    quiet: bool,
) -> ExitCode {
    for note in results.notes().iter().filter(|_| !quiet) {
        eprintln!("note: {note}");
    }
    if as_json {
        print_json(&S::json(results, report, worst));
    } else {
        let table = results.directory().join("results.csv");
        let text = S::text(results, report, worst);
        print(&format!("{text}\nresults   {}", table.display()));
    }
    let failures = results.rows().any(|(_, row)| row.is_failed());
    // A shard is complete when its own missions are done.
    let interrupted = report.is_some_and(|report| report.interrupted);
    let missing = report.is_none() && !results.missing().is_empty();
    if failures || interrupted || missing {
        ExitCode::from(EXIT_PARTIAL)
    } else {
        ExitCode::SUCCESS
    }
}
