//! Differences of `protean sweep` between missions of robots and plans.

use std::path::Path;

use platform::eprintln;
use serde_json::{Value as Json, json};

use super::sweep_args::SweepRunArgs;
use sweep::engine::{Engine, InProcess, Processes};
use sweep::planning::{self, Task};
use sweep::runner::RunReport;
use sweep::{
    Cell, ExperimentOf, Measure, Mission, Results, Subject, SweepError, published, summary,
};

/// An option does not fit the experiment.
#[derive(Debug, thiserror::Error)]
pub enum Unsuitable {
    #[error(
        "--in-process: the scenario of case `{0}` starts an external program, which needs its own process"
    )]
    External(String),
    #[error("--keep-logs: plans have no logs; remove the option")]
    Logs,
    #[error("--worst: plans have no missions to run again; remove the option")]
    Worst,
}

/// A kind of missions on the command line.
pub trait SweepKind: Subject {
    /// Name of the missions that would run.
    const TO_DO: &'static str;

    /// Checks that the arguments fit the experiment.
    ///
    /// # Errors
    /// [`Unsuitable`] names the option.
    fn check(experiment: &ExperimentOf<Self>, args: &SweepRunArgs) -> Result<(), Unsuitable>;

    /// Returns the engine that runs missions.
    fn engine(args: &SweepRunArgs) -> Box<Self::Engine>;

    /// Returns the fields of a cell in the list of a dry run, besides case and parameters.
    fn details(cell: &Cell<Self>) -> Json;

    /// Copies what figures need from the folder of the experiment to its results.
    ///
    /// # Errors
    /// [`SweepError`] if it cannot be copied.
    fn keep_published(_folder: &Path, _results: &Results<Self::Row>) -> Result<(), SweepError> {
        Ok(())
    }

    /// Returns the summary as JSON.
    fn json(
        results: &Results<Self::Row>,
        report: Option<&RunReport>,
        worst: Option<Measure>,
    ) -> Json;

    /// Returns the summary as text.
    fn text(
        results: &Results<Self::Row>,
        report: Option<&RunReport>,
        worst: Option<Measure>,
    ) -> String;
}

impl SweepKind for Mission {
    const TO_DO: &'static str = "missions to run";

    fn check(experiment: &ExperimentOf<Self>, args: &SweepRunArgs) -> Result<(), Unsuitable> {
        let mut cells = experiment.cells.iter();
        if let Some(cell) = cells.find(|cell| args.in_process && cell.external) {
            return Err(Unsuitable::External(cell.case.clone()));
        }
        for note in experiment.notes().into_iter().filter(|_| !args.quiet.quiet) {
            eprintln!("note: {note}");
        }
        Ok(())
    }

    fn engine(args: &SweepRunArgs) -> Box<dyn Engine> {
        if args.in_process {
            Box::new(InProcess::default())
        } else {
            Box::new(Processes::new(platform::descriptors::available()))
        }
    }

    fn details(cell: &Cell<Self>) -> Json {
        json!({ "scenario": cell.target, "set": cell.overrides })
    }

    fn keep_published(folder: &Path, results: &Results) -> Result<(), SweepError> {
        published::keep(folder, results)
    }

    fn json(results: &Results, report: Option<&RunReport>, worst: Option<Measure>) -> Json {
        summary::json(results, report, worst)
    }

    fn text(results: &Results, report: Option<&RunReport>, worst: Option<Measure>) -> String {
        summary::text(results, report, worst)
    }
}

impl SweepKind for Task {
    const TO_DO: &'static str = "plans to make";

    fn check(_: &ExperimentOf<Self>, args: &SweepRunArgs) -> Result<(), Unsuitable> {
        if args.keep_logs.is_some() {
            return Err(Unsuitable::Logs);
        }
        if args.worst.is_some() {
            return Err(Unsuitable::Worst);
        }
        Ok(())
    }

    fn engine(_: &SweepRunArgs) -> Box<()> {
        // A panic of a planner becomes the error of its row.
        std::panic::set_hook(Box::new(|_| ()));
        Box::new(())
    }

    fn details(cell: &Cell<Self>) -> Json {
        json!({ "task": cell.subject })
    }

    fn json(results: &Results<Self::Row>, report: Option<&RunReport>, _: Option<Measure>) -> Json {
        planning::summary::json(results, report)
    }

    fn text(
        results: &Results<Self::Row>,
        report: Option<&RunReport>,
        _: Option<Measure>,
    ) -> String {
        planning::summary::text(results, report)
    }
}
