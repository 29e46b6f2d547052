//! `protean sweep` of experiments whose missions are plans.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use serde_json::json;

use super::processors;
use super::sweep::{SweepRunArgs, failed, interruptible, invalid, place, take_over};
use super::sweep_output::{self, Listing, known, list};
use crate::sweep::merge::merge;
use crate::sweep::planning::{
    PlanExperiment, PlanResults, PlanRow, run as carry_out, summary, to_do,
};
use crate::sweep::runner::{RunOptions, RunReport};
use crate::sweep::shard::Shard;
use crate::sweep::spec::LogPolicy;
use crate::sweep::{LoadOptions, SweepError};

/// Runs an experiment of plans, or the part of it that was asked for.
pub(super) fn run(path: &Path, args: &SweepRunArgs, load: &LoadOptions, shard: Shard) -> ExitCode {
    if args.log.is_some() {
        return invalid("error: --log: plans have no logs; leave it away");
    }
    let experiment = match PlanExperiment::load(path, load) {
        Ok(experiment) => experiment,
        Err(problems) => return invalid(problems),
    };
    let out = place(args, &experiment.name, shard);
    let ended = if args.dry_run {
        dry_run(&experiment, args, shard, &out)
    } else {
        local(&experiment, args, shard, &out)
    };
    ended.unwrap_or_else(|error| failed(&error))
}

/// Puts the results of parts together.
pub(super) fn merged(parts: &[PathBuf], out: &Path, as_json: bool) -> ExitCode {
    match merge::<PlanRow>(parts, out) {
        Ok(results) => conclude(&results, None, as_json),
        Err(error) => failed(&error),
    }
}

fn dry_run(
    experiment: &PlanExperiment,
    args: &SweepRunArgs,
    shard: Shard,
    out: &Path,
) -> Result<ExitCode, SweepError> {
    let manifest = experiment.manifest();
    let results = known::<PlanRow>(out, &manifest)?;
    let (open, known) = to_do(experiment, results.as_ref(), shard, args.retry_failed);
    let listing = Listing {
        manifest: &manifest,
        open: &open,
        known,
        what: "plans to make",
    };
    list(
        &listing,
        args.json,
        |cell| json!({ "task": experiment.cells.get(cell).map(|c| &c.task) }),
    );
    Ok(ExitCode::SUCCESS)
}

fn local(
    experiment: &PlanExperiment,
    args: &SweepRunArgs,
    shard: Shard,
    out: &Path,
) -> Result<ExitCode, SweepError> {
    let interrupted = interruptible()?;
    let mut results = PlanResults::open(out, &experiment.manifest(), &experiment.text)?;
    take_over(&mut results, args, "plans")?;
    let jobs = args.jobs.map_or_else(processors, usize::from);
    let options = RunOptions {
        jobs,
        shard,
        retry_failed: args.retry_failed,
        log: LogPolicy::None,
        timeout: Duration::MAX,
        quiet: args.quiet,
        interrupted,
    };
    // A planner that breaks down is a row that says so.
    std::panic::set_hook(Box::new(|_| ()));
    let ran = carry_out(experiment, &mut results, &options);
    let _ = std::panic::take_hook();
    // What is done is worth a table also when something went wrong.
    let written = results.write_tables();
    let report = ran?;
    written?;
    Ok(conclude(&results, Some(&report), args.json))
}

/// Prints what the results amount to.
fn conclude(results: &PlanResults, report: Option<&RunReport>, as_json: bool) -> ExitCode {
    sweep_output::conclude(results, report, as_json, summary::json, summary::text)
}
