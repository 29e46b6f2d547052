//! Execution of the experiments, resumed where it was interrupted.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use config::Diagnostics;
use platform::atomic_file::{SaveError, save};
use platform::eprintln;
use platform::presence;
use platform::progress::Progress;
use scenario::kind;
use serde::Serialize;
use sweep::engine::{Engine, InProcess};
use sweep::planning::Task;
use sweep::runner::{self, RunOptions};
use sweep::shard::Shard;
use sweep::spec::LogPolicy;
use sweep::{
    ExperimentOf, Kind, LoadOptions, Mission, Record, Results, Seeds, Subject, SweepError, kind_of,
};

use crate::claim::Paper;
use crate::evidence::{Evidence, EvidenceError};
use crate::experiments::{EXPERIMENTS, Experiment, PLAN_SEEDS};
use crate::plans::{Plan, Plans, PlansError};
use crate::rrt_star::{MeasureError, Measuring};

/// Name of the single plans among the experiments, and of their file.
const PLANS: &str = "plans";
/// Names of the reports and of the folder of pages, beside the results.
pub(crate) const REPORTS: [&str; 4] = ["reproduce.md", "reproduce.json", "reproduce.html", "pages"];

/// Failure of a reproduction. Everything recorded before is kept.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The directory contains files of other origin.
    #[error(
        "{} exists, but {} has no results of a reproduction; choose another --out",
        file.display(), directory.display()
    )]
    Foreign {
        /// The file.
        file: PathBuf,
        /// The directory.
        directory: PathBuf,
    },
    /// An experiment cannot be read.
    #[error("{0}")]
    Experiment(Diagnostics),
    /// A sweep failed.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// Results cannot be used.
    #[error(transparent)]
    Evidence(#[from] EvidenceError),
    /// Single plans cannot be read.
    #[error(transparent)]
    Plans(#[from] PlansError),
    /// Single plans cannot be made.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// Single plans cannot be written as a table.
    #[error("cannot write single plans: {0}")]
    Csv(#[from] csv::Error),
    /// A file cannot be written.
    #[error(transparent)]
    Save(#[from] SaveError),
}

/// Seeds of a reproduction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SeedChoice {
    /// Those of the experiments.
    All,
    /// Fewer of them: [`Experiment::quick`].
    Quick,
    /// These, in every experiment.
    These(Seeds),
}

/// Options of a reproduction.
#[derive(Debug, Clone)]
pub struct Options {
    /// The kinds of processes.
    pub kinds: &'static [kind::Kind],
    /// The papers.
    pub papers: Vec<Paper>,
    /// The seeds.
    pub seeds: SeedChoice,
    /// Number of parallel missions, > 0.
    pub jobs: usize,
    /// `true` if no progress is shown.
    pub quiet: bool,
    /// Set by the caller (Ctrl-C): running missions are aborted, finished ones are kept.
    pub interrupted: Arc<AtomicBool>,
}

/// An executed experiment.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Ran {
    /// Its name.
    pub name: String,
    /// Its seeds.
    pub seeds: String,
    /// Number of missions, failed ones included.
    pub missions: usize,
    /// Number of failed missions.
    pub failed: usize,
}

/// Result of a reproduction.
#[derive(Debug)]
pub struct Outcome {
    /// The results.
    pub evidence: Evidence,
    /// The experiments, in the order of their execution.
    pub experiments: Vec<Ran>,
    /// `true` if it was interrupted: results are missing.
    pub interrupted: bool,
}

/// Executes the experiments of papers; each has its results in a folder of `directory`.
///
/// # Errors
/// [`RunError`].
pub fn run(directory: &Path, options: &Options) -> Result<Outcome, RunError> {
    refuse_foreign(directory)?;
    let mut outcome = Outcome {
        evidence: Evidence::default(),
        experiments: Vec::new(),
        interrupted: false,
    };
    let engine = InProcess::default();
    let chosen = |experiment: &&Experiment| options.papers.contains(&experiment.paper);
    let has_plans = options.papers.contains(&Paper::Chase);
    let count = EXPERIMENTS.iter().filter(chosen).count() + usize::from(has_plans);
    for (index, experiment) in EXPERIMENTS.iter().filter(chosen).enumerate() {
        let turn = format!("{} of {count}", index + 1);
        match experiment.kind {
            Kind::Missions => {
                let engine: &dyn Engine = &engine;
                let results = carry_out::<Mission>(experiment, engine, directory, &turn, options)?;
                outcome.note(&results);
                outcome.evidence.add(experiment.paper, &results)?;
            }
            Kind::Planning => {
                // A panic of a planner becomes the error of its row.
                let hook = std::panic::take_hook();
                std::panic::set_hook(Box::new(|_| ()));
                let results = carry_out::<Task>(experiment, &(), directory, &turn, options);
                std::panic::set_hook(hook);
                let results = results?;
                outcome.note(&results);
                outcome.evidence.add_planning(&results)?;
            }
        }
        if options.interrupted.load(Ordering::SeqCst) {
            outcome.interrupted = true;
            return Ok(outcome);
        }
    }
    if has_plans {
        let plans = plans(directory, &format!("{count} of {count}"), options)?;
        outcome.interrupted = options.interrupted.load(Ordering::SeqCst);
        outcome.experiments.push(Ran {
            name: PLANS.to_owned(),
            seeds: plans.seeds().to_string(),
            missions: plans.0.len(),
            failed: 0,
        });
        outcome.evidence.add_plans(plans);
    }
    Ok(outcome)
}

impl Outcome {
    /// Notes an executed experiment.
    fn note<R: Record>(&mut self, results: &Results<R>) {
        let manifest = results.manifest();
        self.experiments.push(Ran {
            name: manifest.experiment.clone(),
            seeds: manifest.seeds.to_string(),
            missions: results.rows().count(),
            failed: results.rows().filter(|(_, row)| row.is_failed()).count(),
        });
    }

    /// Returns `true` if missions failed.
    pub fn has_failures(&self) -> bool {
        self.experiments.iter().any(|ran| ran.failed > 0)
    }
}

/// Refuses a directory that has a file under the name of a report, but no results.
fn refuse_foreign(directory: &Path) -> Result<(), RunError> {
    for experiment in EXPERIMENTS {
        match kind_of(&directory.join(experiment.name)) {
            Ok(_) => return Ok(()),
            Err(SweepError::NotResults { .. }) => {}
            Err(error) => return Err(error.into()),
        }
    }
    for file in REPORTS.iter().map(|name| directory.join(name)) {
        let there = presence::entry(&file).map_err(|source| SweepError::Io {
            path: file.clone(),
            what: "cannot be read",
            source,
        })?;
        if there.is_some() {
            return Err(RunError::Foreign {
                file,
                directory: directory.to_owned(),
            });
        }
    }
    Ok(())
}

/// Executes the missions of an experiment that are not finished; `turn` is its number and that of all.
fn carry_out<S: Subject>(
    experiment: &Experiment,
    engine: &S::Engine,
    directory: &Path,
    turn: &str,
    options: &Options,
) -> Result<Results<S::Row>, RunError> {
    let mut load = LoadOptions::new(options.kinds);
    load.seeds = match &options.seeds {
        SeedChoice::All => None,
        SeedChoice::Quick => Seeds::range(1, experiment.quick),
        SeedChoice::These(seeds) => Some(seeds.clone()),
    };
    let loaded = ExperimentOf::<S>::from_text(experiment.name, experiment.text, &load);
    let loaded = loaded.map_err(RunError::Experiment)?;
    let folder = directory.join(experiment.name);
    let mut results = Results::open(&folder, &loaded.manifest(), &loaded.text)?;
    if let Some(other) = experiment.reuse {
        results.reuse(&Results::read(&directory.join(other))?)?;
    }
    if !options.quiet {
        eprintln!("experiment {turn}: {}, seeds {}", loaded.name, loaded.seeds);
    }
    let run = RunOptions {
        jobs: options.jobs,
        shard: Shard::WHOLE,
        retry_failed: false,
        log: LogPolicy::None,
        timeout: Duration::from_secs_f64(loaded.run.timeout_s),
        quiet: options.quiet,
        interrupted: Arc::clone(&options.interrupted),
    };
    let ran = runner::run(&loaded, &mut results, engine, &run);
    // The tables are written also after an error.
    let written = results.write_tables();
    ran?;
    written?;
    Ok(results)
}

/// Makes the single plans that are missing, several seeds at once; each is saved when it is done.
fn plans(directory: &Path, turn: &str, options: &Options) -> Result<Plans, RunError> {
    let path = directory.join(format!("{PLANS}.csv"));
    let mut plans = Plans::read_if_any(&path)?;
    let [all, quick] = PLAN_SEEDS.map(|count| Seeds::range(1, count).unwrap_or_default());
    let seeds = match &options.seeds {
        SeedChoice::All => all,
        SeedChoice::Quick => quick,
        SeedChoice::These(seeds) => seeds.clone(),
    };
    let known: Vec<u64> = plans.seeds().iter().collect();
    let open: Vec<u64> = seeds.iter().filter(|seed| !known.contains(seed)).collect();
    if !options.quiet {
        eprintln!("experiment {turn}: {PLANS}, seeds {seeds}");
    }
    let mut progress = Progress::new(open.len(), known.len(), options.quiet, "seeds of plans");
    let measuring = Measuring::new()?;
    for several in open.chunks(options.jobs.max(1)) {
        if options.interrupted.load(Ordering::SeqCst) {
            break;
        }
        let made: Vec<Result<Vec<Plan>, MeasureError>> = std::thread::scope(|scope| {
            let measuring = &measuring;
            let start = |&seed: &u64| scope.spawn(move || measuring.of_seed(seed));
            let threads: Vec<_> = several.iter().map(start).collect();
            let join = |thread: std::thread::ScopedJoinHandle<'_, _>| {
                thread
                    .join()
                    .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
            };
            threads.into_iter().map(join).collect()
        });
        for made in made {
            plans.add(made?);
            progress.done(false, String::new);
        }
        save(&plans.to_csv()?, &path)?;
    }
    progress.finish();
    Ok(plans)
}
