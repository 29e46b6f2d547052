//! `protean sweep --engine`: an experiment in parts, each a job of a scheduler.

use std::path::Path;
use std::process::ExitCode;

use super::sweep::SweepRunArgs;
use super::{EXIT_FAILED, print, processors};
use crate::sweep::SweepError;
use crate::sweep::launcher::{self, Plan, Scheduler};
use crate::sweep::spec::{LogPolicy, RunSpec};

/// The words that every part is given.
fn shared_arguments(path: &Path, args: &SweepRunArgs) -> Vec<String> {
    let mut words = vec![path.display().to_string()];
    for set in &args.set {
        words.extend(["--set".to_owned(), set.clone()]);
    }
    if let Some(seeds) = &args.seeds {
        words.extend(["--seeds".to_owned(), seeds.clone()]);
    }
    if let Some(log) = args.log {
        let name = match log {
            LogPolicy::None => "none",
            LogPolicy::Failed => "failed",
            LogPolicy::All => "all",
        };
        words.extend(["--log".to_owned(), name.to_owned()]);
    }
    for directory in &args.reuse {
        words.extend(["--reuse".to_owned(), directory.display().to_string()]);
    }
    for (given, word) in [
        (args.in_process, "--in-process"),
        (args.retry_failed, "--retry-failed"),
        (args.allow_external, "--allow-external"),
        (args.allow_outside, "--allow-outside"),
    ] {
        words.extend(given.then(|| word.to_owned()));
    }
    words
}

/// Writes the scripts of a scheduler, and starts them if asked to.
pub(super) fn schedule(
    (name, run): (&str, &RunSpec),
    path: &Path,
    args: &SweepRunArgs,
    scheduler: Scheduler,
    out: &Path,
) -> Result<ExitCode, SweepError> {
    let launcher_error = |what: String| SweepError::Launcher {
        program: "sweep".to_owned(),
        what,
        help: None,
    };
    let program = std::env::current_exe()
        .map_err(|e| launcher_error(format!("cannot find this program: {e}")))?;
    let folder = std::env::current_dir()
        .map_err(|e| launcher_error(format!("cannot find the present folder: {e}")))?;
    let default_jobs = if scheduler == Scheduler::Slurm {
        1
    } else {
        processors()
    };
    let plan = Plan {
        program,
        arguments: shared_arguments(path, args),
        out: folder.join(out),
        folder,
        name: name.to_owned(),
        shards: args.shards as usize,
        jobs: args
            .jobs
            .map(usize::from)
            .or(run.jobs)
            .unwrap_or(default_jobs),
    };
    if args.submit {
        launcher::check(scheduler)?;
    }
    let scripts = match scheduler {
        Scheduler::Slurm => plan.write_slurm()?,
        _ => plan.write_parallel()?,
    };
    if !args.submit {
        for file in &scripts.files {
            print(&file.display().to_string());
        }
        eprintln!(
            "start it with: sh {}, or with --submit",
            scripts.start.display()
        );
        return Ok(ExitCode::SUCCESS);
    }
    let status = launcher::start(&scripts.start)?;
    Ok(match status.code() {
        Some(0) => ExitCode::SUCCESS,
        Some(code) => ExitCode::from(u8::try_from(code).unwrap_or(EXIT_FAILED)),
        None => ExitCode::from(EXIT_FAILED),
    })
}
