//! Sweeps: experiments of many missions.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use draw::figures::{Point, Scale, Unit};
use kinds::KINDS;
use mission::MissionReport;
use pyo3::prelude::*;
use scenario::ResolvedScenario;
use serde_json::{Value as Json, json};
use sweep::engine::{Call, Engine, InProcess};
use sweep::planning::{Task, is_planning};
use sweep::runner::{self, RunOptions, RunReport};
use sweep::shard::Shard;
use sweep::{
    Experiment, ExperimentOf, LoadOptions, Mission, Results, Seeds, Subject, SweepError, figures,
    summary,
};

use crate::error::{Error, InvalidInput};
use crate::interruptible::{compute, wait};
use crate::run::{Planned, kinds_of, place};

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
    /// Planners in the place of those of the scenarios.
    placed: Vec<Planned>,
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

    /// Loads an experiment of missions with the planners in their places.
    fn load_missions(&self, path: &Path) -> PyResult<Experiment> {
        let mut experiment = self.load::<Mission>(path)?;
        let changed = experiment.change_processes(|scenario| place(scenario, &self.placed));
        changed.map_err(InvalidInput::new_err)?;
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

/// Returns the figures of results as JSON: a list of charts.
///
/// Raises
/// ------
/// Error
///     The results cannot be read.
#[pyfunction]
pub fn sweep_figures(py: Python<'_>, directory: PathBuf) -> PyResult<String> {
    let charts = compute(py, move || figures::charts(&Results::read(&directory)?))?;
    let charts = charts.map_err(|error| raised(&error))?;
    let points = |points: &[Point]| {
        let bounds = |p: &Point| p.interval.unwrap_or((p.y, p.y));
        let row = |p: &Point| [p.x, p.y, bounds(p).0, bounds(p).1];
        points.iter().map(row).collect::<Vec<_>>()
    };
    let charts = charts.iter().map(|(name, chart)| {
        let series = chart.series.iter().map(|series| {
            json!({ "name": series.name, "points": points(&series.points), "reference": points(&series.reference) })
        });
        json!({
            "name": name,
            "title": chart.title,
            "x_label": chart.x_label,
            "x_names": chart.x_names,
            "x_log": chart.x_scale == Scale::Logarithmic,
            "y_label": chart.y_label,
            "share": chart.unit == Unit::Share,
            "series": series.collect::<Vec<_>>(),
        })
    });
    Ok(charts.collect::<Json>().to_string())
}

/// Runs missions of robots in threads of this process; returns the summary as JSON.
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
#[pyo3(signature = (experiment, out, options, *, shard, jobs, quiet))]
pub fn sweep_in_process(
    py: Python<'_>,
    experiment: PathBuf,
    out: PathBuf,
    options: Options,
    shard: Option<String>,
    jobs: Option<usize>,
    quiet: bool,
) -> PyResult<String> {
    runtime::logging::start("warn");
    let path = experiment;
    let (experiment, options, path) = compute(py, move || {
        let experiment = options.load_missions(&path)?;
        PyResult::Ok((experiment, options, path))
    })??;
    let retry_failed = options.retry_failed;
    let engine = PlannersInProcess {
        engine: InProcess::default(),
        planners: options.placed,
    };
    engine.check(&experiment)?;
    let shard = shard.as_deref().map_or(Ok(Shard::WHOLE), Shard::parse);
    let interrupted = Arc::clone(&options.interruption.get().0);
    let run = RunOptions {
        jobs: jobs.unwrap_or_else(platform::machine::processors),
        shard: shard.map_err(|error| InvalidInput::new_err(error.to_string()))?,
        retry_failed,
        log: sweep::spec::LogPolicy::None,
        timeout: Duration::from_secs_f64(experiment.run.timeout_s),
        quiet,
        interrupted: Arc::clone(&interrupted),
    };
    let (ended, signal) = wait(py, &interrupted, || {
        let folder = path.parent().unwrap_or(Path::new(""));
        carry_out(&experiment, folder, &out, &engine, &run)
    })?;
    signal?;
    let (results, report) = ended.map_err(|error| raised(&error))?;
    Ok(summary::json(&results, Some(&report)).to_string())
}

fn carry_out(
    experiment: &Experiment,
    folder: &Path,
    out: &Path,
    engine: &PlannersInProcess,
    options: &RunOptions,
) -> Result<(Results, RunReport), SweepError> {
    let mut results = Results::open(out, &experiment.manifest(), &experiment.text)?;
    figures::keep_published(folder, &results)?;
    let ran = runner::run(experiment, &mut results, engine, options);
    // The tables are written also after an error.
    let written = results.write_tables();
    let report = ran?;
    written?;
    figures::write(&results)?;
    Ok((results, report))
}

/// Engine that runs every mission in one thread, with planners in Python.
struct PlannersInProcess {
    engine: InProcess,
    planners: Vec<Planned>,
}

impl PlannersInProcess {
    /// Checks that no process remains a program.
    fn check(&self, experiment: &Experiment) -> PyResult<()> {
        for cell in &experiment.cells {
            let scenario = cell.scenario(0);
            let scenario =
                scenario.map_err(|problems| InvalidInput::new_err(problems.to_string()))?;
            let kinds = kinds_of(&scenario, &self.planners).map_err(InvalidInput::new_err)?;
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
    fn execute(&self, scenario: &ResolvedScenario, call: &Call) -> Result<MissionReport, String> {
        let kinds = kinds_of(scenario, &self.planners)?;
        self.engine.execute_with(kinds, scenario, call)
    }

    fn needs_pinning(&self) -> bool {
        self.engine.needs_pinning()
    }
}
