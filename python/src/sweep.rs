//! Sweeps: experiments of many missions.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use kinds::KINDS;
use mission::MissionReport;
use pyo3::prelude::*;
use scenario::ResolvedScenario;
use serde_json::Value as Json;
use sweep::engine::{Call, Engine, EngineError, InProcess};
use sweep::planning::{self, Task, is_planning};
use sweep::runner::{self, RunOptions, RunReport};
use sweep::shard::Shard;
use sweep::spec::LogPolicy;
use sweep::{
    Experiment, ExperimentOf, LoadOptions, Measure, MeasureError, Mission, Results, Seeds, Subject,
    SweepError, published, summary,
};

use crate::run::{FunctionPlanner, kinds_of, place};
use python_algorithms::arguments::invalid;
use python_algorithms::error::{Error, InvalidInput};
use python_algorithms::interruptible::{compute, wait};

/// End of the parts of an experiment that threads of Python run: Ctrl-C reaches the main thread alone.
#[pyclass(frozen, module = "protean_robotics")]
pub struct Interruption(Arc<AtomicBool>);

#[pymethods]
impl Interruption {
    #[new]
    fn new() -> Self {
        Self(Arc::default())
    }

    /// Ends the parts.
    fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Options of an experiment beside its file.
#[derive(FromPyObject)]
pub struct Options {
    /// Seeds `A..B` instead of those of the file.
    seeds: Option<String>,
    /// `key=value` overrides of every scenario.
    overrides: Vec<String>,
    /// `true` if scenarios may start programs.
    allow_external: bool,
    /// `true` if files may be outside the folder of the experiment.
    allow_outside: bool,
    /// `true` if failed missions run again.
    retry_failed: bool,
    /// Missions whose logs are kept: `failed`, `all`, or none.
    keep_logs: String,
    /// Column and end of the worst missions.
    worst: Option<String>,
    /// Planners in the place of those of the scenarios.
    placed: Vec<FunctionPlanner>,
    /// End by Ctrl-C.
    interruption: Py<Interruption>,
}

impl Options {
    fn load<S: Subject>(&self, path: &Path) -> PyResult<ExperimentOf<S>> {
        let seeds = self.seeds.as_deref().map(Seeds::parse).transpose();
        let options = LoadOptions {
            set: self.overrides.clone(),
            seeds: seeds.map_err(|error| InvalidInput::new_err(format!("seeds: {error}")))?,
            allow_outside: self.allow_outside,
            // No program is started in the place of a planner.
            allow_external: self.allow_external || !self.placed.is_empty(),
            ..LoadOptions::new(KINDS)
        };
        ExperimentOf::load(path, &options).map_err(|problems| {
            let text = problems.to_string();
            InvalidInput::new_err(text.trim_start_matches("error: ").to_owned())
        })
    }

    fn log(&self) -> LogPolicy {
        match self.keep_logs.as_str() {
            "failed" => LogPolicy::Failed,
            "all" => LogPolicy::All,
            _ => LogPolicy::None,
        }
    }

    fn worst(&self) -> PyResult<Option<Measure>> {
        let text = self.worst.as_deref();
        let measure = text.map(|text| {
            let refused =
                |error: MeasureError| InvalidInput::new_err(format!("worst = {text:?}: {error}"));
            text.parse().map_err(refused)
        });
        measure.transpose()
    }

    /// Loads an experiment of missions with the planners in their places.
    fn load_missions(&self, path: &Path) -> PyResult<Experiment> {
        let mut experiment = self.load::<Mission>(path)?;
        let changed = experiment.change_processes(|scenario| place(scenario, &self.placed));
        changed.map_err(invalid)?;
        Ok(experiment)
    }
}

/// Returns the exception for a failure of a sweep.
fn raised(error: &SweepError) -> PyErr {
    match error {
        SweepError::Io { .. } | SweepError::Resource { .. } => Error::new_err(error.to_string()),
        _ => InvalidInput::new_err(error.to_string()),
    }
}

/// Returns the directory of the results of an experiment, and the numbers of the missions that are still to run, in the
/// order of the results.
#[pyfunction]
pub fn missions_to_run(
    py: Python<'_>,
    experiment: PathBuf,
    out: Option<PathBuf>,
    options: Options,
) -> PyResult<(PathBuf, Vec<usize>)> {
    options.worst()?;
    compute(py, move || {
        if is_planning(&experiment) {
            to_run(&options.load::<Task>(&experiment)?, out, &options)
        } else {
            to_run(&options.load_missions(&experiment)?, out, &options)
        }
    })?
}

fn to_run<S: Subject>(
    experiment: &ExperimentOf<S>,
    out: Option<PathBuf>,
    options: &Options,
) -> PyResult<(PathBuf, Vec<usize>)> {
    let out = out.unwrap_or_else(|| Path::new("results").join(&experiment.name));
    let known = Results::<S::Row>::existing(&out, &experiment.manifest());
    let known = known.map_err(|error| raised(&error))?;
    let open = runner::to_do(
        experiment,
        known.as_ref(),
        Shard::WHOLE,
        options.retry_failed,
    );
    let seeds: Vec<u64> = experiment.seeds.iter().collect();
    let number = |seed, cell| {
        let position = seeds.binary_search(&seed).unwrap_or_default();
        cell * seeds.len() + position
    };
    let open = open.0.iter().map(|open| number(open.seed, open.cell));
    Ok((out, open.collect()))
}

/// Runs the missions of an experiment that are not finished in threads of this process; returns the summary as JSON.
/// Missions with the same scenario and seed are copied from the results in `reuse`.
///
/// Raises
/// ------
/// InvalidInput
///     The experiment is invalid, or cannot run in one process.
/// Error
///     The results cannot be stored.
/// KeyboardInterrupt
///     Ctrl-C; finished missions are kept.
#[pyfunction]
#[pyo3(signature = (experiment, out, options, *, shard, jobs, quiet, reuse=Vec::new()))]
#[expect(clippy::too_many_arguments, reason = "the options of the command")]
pub fn sweep_in_process(
    py: Python<'_>,
    experiment: PathBuf,
    out: PathBuf,
    options: Options,
    shard: Option<String>,
    jobs: Option<usize>,
    quiet: bool,
    reuse: Vec<PathBuf>,
) -> PyResult<String> {
    runtime::logging::start("warn");
    let shard = shard.as_deref().map_or(Ok(Shard::WHOLE), Shard::parse);
    let interrupted = Arc::clone(&options.interruption.get().0);
    let run = RunOptions {
        jobs: jobs.unwrap_or_else(platform::machine::processors),
        shard: shard.map_err(invalid)?,
        retry_failed: options.retry_failed,
        log: options.log(),
        timeout: Duration::ZERO,
        quiet,
        interrupted: Arc::clone(&interrupted),
    };
    let worst = options.worst()?;
    let path = experiment;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let keep = |results: &Results| published::keep(&folder, results);
    if options.placed.is_empty() && is_planning(&path) {
        let experiment = compute(py, move || options.load::<Task>(&path))??;
        return wait_for(py, &interrupted, || {
            // A panic of a planner becomes the error of its row.
            let hook = std::panic::take_hook();
            std::panic::set_hook(Box::new(|_| ()));
            let ended = carry_out(&experiment, &out, &reuse, &(), run, |_| Ok(()));
            std::panic::set_hook(hook);
            let (results, report) = ended?;
            Ok(planning::summary::json(&results, Some(&report)))
        });
    }
    let (experiment, options) = compute(py, move || {
        let experiment = options.load_missions(&path)?;
        PyResult::Ok((experiment, options))
    })??;
    let engine = PlannersInProcess {
        engine: InProcess::default(),
        planners: options.placed,
    };
    engine.check(&experiment)?;
    let engine: &dyn Engine = &engine;
    wait_for(py, &interrupted, || {
        let (results, report) = carry_out(&experiment, &out, &reuse, engine, run, keep)?;
        Ok(summary::json(&results, Some(&report), worst))
    })
}

/// Waits for a sweep and returns its summary.
fn wait_for(
    py: Python<'_>,
    interrupted: &AtomicBool,
    work: impl FnOnce() -> Result<Json, SweepError> + Send,
) -> PyResult<String> {
    let (ended, signal) = wait(py, interrupted, work)?;
    signal?;
    let summary = ended.map_err(|error| raised(&error))?;
    Ok(summary.to_string())
}

/// Runs missions; `keep` copies what figures need to the results.
fn carry_out<S: Subject>(
    experiment: &ExperimentOf<S>,
    out: &Path,
    reuse: &[PathBuf],
    engine: &S::Engine,
    options: RunOptions,
    keep: impl Fn(&Results<S::Row>) -> Result<(), SweepError>,
) -> Result<(Results<S::Row>, RunReport), SweepError> {
    let mut results = Results::open(out, &experiment.manifest(), &experiment.text)?;
    keep(&results)?;
    for other in reuse {
        results.reuse(&Results::read(other)?)?;
    }
    let options = RunOptions {
        timeout: Duration::from_secs_f64(experiment.run.timeout_s),
        ..options
    };
    let ran = runner::run(experiment, &mut results, engine, &options);
    // The tables are written also after an error.
    let written = results.write_tables();
    let report = ran?;
    written?;
    Ok((results, report))
}

/// Engine that runs every mission in one thread, with planners in Python.
struct PlannersInProcess {
    engine: InProcess,
    planners: Vec<FunctionPlanner>,
}

impl PlannersInProcess {
    /// Checks that no process remains a program.
    fn check(&self, experiment: &Experiment) -> PyResult<()> {
        for cell in &experiment.cells {
            let scenario = cell.scenario(0);
            let scenario =
                scenario.map_err(|problems| InvalidInput::new_err(problems.to_string()))?;
            let kinds = kinds_of(&scenario, &self.planners).map_err(invalid)?;
            let mut programs = scenario.external_commands();
            if let Some(program) = programs.find(|process| !kinds.contains_key(&process.name)) {
                return Err(InvalidInput::new_err(format!(
                    "in_process: process {:?} of case `{}` is a program: expected a planner for it, or in_process=False",
                    program.name, cell.case
                )));
            }
        }
        Ok(())
    }
}

impl Engine for PlannersInProcess {
    fn execute(
        &self,
        scenario: &ResolvedScenario,
        call: &Call,
    ) -> Result<MissionReport, EngineError> {
        let kinds = kinds_of(scenario, &self.planners)
            .map_err(|error| EngineError::Programs(error.into()))?;
        self.engine.execute_with(kinds, scenario, call)
    }

    fn needs_pinning(&self) -> bool {
        self.engine.needs_pinning()
    }
}
