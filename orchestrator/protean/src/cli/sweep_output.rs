//! What `protean sweep` prints: what is still to be done, and what came of it.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;

use platform::eprintln;
use serde_json::{Value as Json, json};

use super::output::{EXIT_PARTIAL, print, print_json};
use super::sweep_kind::SweepKind;
use sweep::runner::RunReport;
use sweep::{Manifest, MissionId, Record, Results, SweepError};

/// The results that a directory holds of the experiment with this manifest; `None` if it holds none
/// at all.
///
/// # Errors
/// [`SweepError::Other`] if they are of another experiment, or what keeps them from being read.
pub(super) fn known<R: Record>(
    out: &Path,
    manifest: &Manifest,
) -> Result<Option<Results<R>>, SweepError> {
    let results = match Results::read(out) {
        Ok(results) => results,
        Err(SweepError::NotResults { .. }) => return Ok(None),
        Err(error) => return Err(error),
    };
    match manifest.difference(results.manifest()) {
        None => Ok(Some(results)),
        Some(difference) => Err(SweepError::Other {
            path: out.to_owned(),
            difference,
        }),
    }
}

/// What a sweep would do.
pub(super) struct Listing<'a> {
    /// The experiment.
    pub manifest: &'a Manifest,
    /// What is still to be done.
    pub open: &'a [MissionId],
    /// How much is done.
    pub known: usize,
    /// What is to be done, in words: `missions to carry out`.
    pub what: &'a str,
}

/// Prints what a sweep would do; `details` is what a cell has beside case and parameters, as JSON.
pub(super) fn list(listing: &Listing<'_>, as_json: bool, details: impl Fn(usize) -> Json) {
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

/// Prints what results amount to.
pub(super) fn conclude<S: SweepKind>(
    results: &Results<S::Row>,
    report: Option<&RunReport>,
    as_json: bool,
) -> ExitCode {
    for note in results.notes() {
        eprintln!("note: {note}");
    }
    if as_json {
        print_json(&S::json(results, report));
    } else {
        let table = results.directory().join("results.csv");
        let text = S::text(results, report);
        print(&format!("{text}\nresults   {}", table.display()));
    }
    let failures = results.rows().any(|(_, row)| row.is_failed());
    // A part has done its work when its own missions are done.
    let interrupted = report.is_some_and(|report| report.interrupted);
    let missing = report.is_none() && !results.missing().is_empty();
    if failures || interrupted || missing {
        ExitCode::from(EXIT_PARTIAL)
    } else {
        ExitCode::SUCCESS
    }
}
