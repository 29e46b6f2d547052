//! `protean sweep`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use platform::eprintln;
use serde_json::Value as Json;

use super::lab;
use super::output::{EXIT_FAILED, EXIT_INVALID};
use super::run::handle_signals;
use super::sweep_args::{SweepArgs, SweepCommand, SweepRunArgs};
use super::sweep_kind::SweepKind;
use super::sweep_output::{Listing, conclude, list};
use platform::machine::processors;
use scenario::kind;
use sweep::merge::merge;
use sweep::planning::{Task, is_planning};
use sweep::runner::{self, RunOptions};
use sweep::shard::Shard;
use sweep::spec::LogPolicy;
use sweep::{
    ExperimentOf, Kind, LoadOptions, Mission, Record, Results, Seeds, SweepError, kind_of,
};

/// Runs an experiment, merges results, or draws their figures.
pub fn sweep(kinds: &'static [kind::Kind], args: &SweepArgs) -> ExitCode {
    match (&args.command, &args.run.experiment) {
        (Some(SweepCommand::Merge { parts, out, json }), _) => merged(parts, out, json.json),
        (Some(SweepCommand::Figures(args)), _) => lab::execute("figures", args),
        (None, Some(experiment)) => run(kinds, experiment, &args.run),
        (None, None) => {
            invalid("error: expected an experiment file: `protean sweep EXPERIMENT.toml`")
        }
    }
}

/// Prints an error; returns its exit code.
fn failed(error: &SweepError) -> ExitCode {
    eprintln!("error: {error}");
    ExitCode::from(match error {
        SweepError::Io { .. } | SweepError::Resource { .. } => EXIT_FAILED,
        _ => EXIT_INVALID,
    })
}

fn invalid(text: impl std::fmt::Display) -> ExitCode {
    eprintln!("{text}");
    ExitCode::from(EXIT_INVALID)
}

fn merged(parts: &[PathBuf], out: &Path, as_json: bool) -> ExitCode {
    match parts.first().map(|part| kind_of(part)).transpose() {
        Ok(Some(Kind::Planning)) => merged_of::<Task>(parts, out, as_json),
        Ok(_) => merged_of::<Mission>(parts, out, as_json),
        Err(error) => failed(&error),
    }
}

fn merged_of<S: SweepKind>(parts: &[PathBuf], out: &Path, as_json: bool) -> ExitCode {
    let joined = || {
        let results = merge::<S::Row>(parts, out)?;
        // Every shard has the published points of the figures.
        if let Some(part) = parts.first() {
            S::keep_published(part, &results)?;
        }
        Ok(results)
    };
    match joined() {
        Ok(results) => conclude::<S>(&results, None, None, as_json, false),
        Err(error) => failed(&error),
    }
}

fn run(kinds: &'static [kind::Kind], path: &Path, args: &SweepRunArgs) -> ExitCode {
    runtime::logging::start("warn");
    let parsed = (
        args.seeds.as_deref().map(Seeds::parse).transpose(),
        args.shard.as_deref().map(Shard::parse).transpose(),
    );
    let (seeds, shard) = match parsed {
        (Ok(seeds), Ok(shard)) => (seeds, shard.unwrap_or(Shard::WHOLE)),
        (Err(error), _) => return invalid(format!("error: --seeds: {error}")),
        (_, Err(error)) => return invalid(format!("error: --shard: {error}")),
    };
    let options = LoadOptions {
        kinds,
        set: args.set.clone(),
        seeds,
        allow_outside: args.allow_outside,
        allow_external: args.external.allow_external,
    };
    if is_planning(path) {
        run_of::<Task>(path, args, &options, shard)
    } else {
        run_of::<Mission>(path, args, &options, shard)
    }
}

fn run_of<S: SweepKind>(
    path: &Path,
    args: &SweepRunArgs,
    options: &LoadOptions,
    shard: Shard,
) -> ExitCode {
    let experiment = match ExperimentOf::<S>::load(path, options) {
        Ok(experiment) => experiment,
        Err(problems) => return invalid(problems),
    };
    if let Err(message) = S::check(&experiment, args) {
        return invalid(format!("error: {message}"));
    }
    let out = place(args, &experiment.name, shard);
    if args.dry_run {
        let listed = dry_run(&experiment, args, shard, &out);
        return listed.unwrap_or_else(|error| invalid(format!("error: {error}")));
    }
    match open(&experiment, path, args, &out) {
        Ok(results) => {
            carry_out(&experiment, results, args, shard).unwrap_or_else(|error| failed(&error))
        }
        Err(error) => invalid(format!("error: {error}")),
    }
}

/// Returns the directory of the results.
fn place(args: &SweepRunArgs, name: &str, shard: Shard) -> PathBuf {
    args.out.clone().unwrap_or_else(|| {
        let out = Path::new("results").join(name);
        shard
            .directory()
            .map_or(out.clone(), |shard| out.join(shard))
    })
}

/// Lists the missions that would run.
fn dry_run<S: SweepKind>(
    experiment: &ExperimentOf<S>,
    args: &SweepRunArgs,
    shard: Shard,
    out: &Path,
) -> Result<ExitCode, SweepError> {
    let manifest = experiment.manifest();
    let results = Results::<S::Row>::existing(out, &manifest)?;
    let (open, known) = runner::to_do(experiment, results.as_ref(), shard, args.retry_failed);
    let listing = Listing {
        manifest: &manifest,
        open: &open,
        known,
        what: S::TO_DO,
    };
    list(&listing, args.json.json, |cell| {
        experiment.cells.get(cell).map_or(Json::Null, S::details)
    });
    Ok(ExitCode::SUCCESS)
}

/// Returns the flag that Ctrl-C sets.
fn interruptible() -> Result<Arc<AtomicBool>, SweepError> {
    let interrupted = Arc::new(AtomicBool::new(false));
    handle_signals(&interrupted).map_err(|source| SweepError::Resource {
        what: format!("cannot handle signals: {source}"),
        help: "",
    })?;
    Ok(interrupted)
}

/// Copies missions from the results that `--reuse` names.
fn take_over<R: Record>(
    results: &mut Results<R>,
    args: &SweepRunArgs,
    what: &str,
) -> Result<(), SweepError> {
    for directory in &args.reuse {
        let taken = results.reuse(&Results::read(directory)?)?;
        if !args.quiet.quiet {
            eprintln!("{taken} {what} copied from {}", directory.display());
        }
    }
    Ok(())
}

/// Opens the results, with what figures need and with the missions of other results.
fn open<S: SweepKind>(
    experiment: &ExperimentOf<S>,
    path: &Path,
    args: &SweepRunArgs,
    out: &Path,
) -> Result<Results<S::Row>, SweepError> {
    let mut results = Results::open(out, &experiment.manifest(), &experiment.text)?;
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    S::keep_published(folder.unwrap_or(Path::new(".")), &results)?;
    take_over(&mut results, args, S::UNIT)?;
    Ok(results)
}

fn carry_out<S: SweepKind>(
    experiment: &ExperimentOf<S>,
    mut results: Results<S::Row>,
    args: &SweepRunArgs,
    shard: Shard,
) -> Result<ExitCode, SweepError> {
    let interrupted = interruptible()?;
    let jobs = args.jobs.map_or_else(processors, usize::from);
    let options = RunOptions {
        jobs,
        shard,
        retry_failed: args.retry_failed,
        log: args
            .keep_logs
            .map_or_else(LogPolicy::default, LogPolicy::from),
        timeout: Duration::from_secs_f64(experiment.run.timeout_s),
        quiet: args.quiet.quiet,
        interrupted,
    };
    let ran = runner::run(experiment, &mut results, S::engine(args).as_ref(), &options);
    // The tables are written also after an error.
    let written = results.write_tables();
    let report = ran?;
    written?;
    Ok(conclude::<S>(
        &results,
        Some(&report),
        args.worst,
        args.json.json,
        args.quiet.quiet,
    ))
}
