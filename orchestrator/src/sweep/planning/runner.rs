//! Carrying out plans, several at once.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Instant;

use super::PlanResults;
use super::experiment::PlanExperiment;
use super::row::PlanRow;
use crate::planning::solve;
use crate::sweep::error::SweepError;
use crate::sweep::progress::Progress;
use crate::sweep::results::MissionId;
use crate::sweep::runner::{RunOptions, RunReport, to_do_of};
use crate::sweep::shard::Shard;

/// The missions of a shard that are still to be carried out, in the order of the results, and how
/// many are done.
pub fn to_do(
    experiment: &PlanExperiment,
    results: Option<&PlanResults>,
    shard: Shard,
    retry_failed: bool,
) -> (Vec<MissionId>, usize) {
    let size = (experiment.cells.len(), &experiment.seeds);
    to_do_of(size, results, shard, retry_failed)
}

/// A mission that is over.
struct Done {
    mission: MissionId,
    row: PlanRow,
    cpu_ms: Option<f64>,
    wall_s: f64,
}

/// Carries out a mission; `None` if it was interrupted.
fn carry_out(
    experiment: &PlanExperiment,
    mission: MissionId,
    interrupted: &AtomicBool,
) -> Option<Done> {
    let task = &experiment.cells.get(mission.cell)?.task;
    let begin = Instant::now();
    let id = mission.seed.to_string();
    let instance = task.instances.instance(id, mission.seed);
    let answer = solve(&instance, &task.options, 1, interrupted)?;
    Some(Done {
        mission,
        row: PlanRow::of(&answer, instance.obstacles.len()),
        cpu_ms: answer.cpu_ms,
        wall_s: begin.elapsed().as_secs_f64(),
    })
}

/// Carries out the missions that are not done yet and records each as soon as it is over.
///
/// # Errors
/// [`SweepError`] if the results cannot be kept; everything recorded before is.
pub fn run(
    experiment: &PlanExperiment,
    results: &mut PlanResults,
    options: &RunOptions,
) -> Result<RunReport, SweepError> {
    let begin = Instant::now();
    let (open, known) = to_do(
        experiment,
        Some(results),
        options.shard,
        options.retry_failed,
    );
    let mut progress = Progress::of(open.len(), known, options.quiet, "plans");
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let mut carried_out = 0;
    let (tell, told) = mpsc::channel::<Done>();
    let work = |tell: &mpsc::Sender<Done>| {
        let stopped =
            || stop.load(Ordering::Relaxed) || options.interrupted.load(Ordering::Relaxed);
        while !stopped() {
            let Some(&mission) = open.get(next.fetch_add(1, Ordering::Relaxed)) else {
                return;
            };
            let Some(done) = carry_out(experiment, mission, &options.interrupted) else {
                return;
            };
            if tell.send(done).is_err() {
                return;
            }
        }
    };
    let outcome = std::thread::scope(|scope| -> Result<(), SweepError> {
        let work = &work;
        for worker in 0..options.jobs.clamp(1, open.len().max(1)) {
            let tell = tell.clone();
            let spawned = std::thread::Builder::new()
                .name(format!("sweep-{worker}"))
                .spawn_scoped(scope, move || work(&tell));
            if let Err(source) = spawned {
                stop.store(true, Ordering::Relaxed);
                return Err(SweepError::Resource {
                    what: format!("cannot start thread {worker}: {source}"),
                    help: "; choose fewer --jobs",
                });
            }
        }
        drop(tell);
        for done in told {
            let failed = crate::sweep::Record::is_failed(&done.row);
            progress.done(failed, || {
                format!(
                    "{} failed: {}",
                    results.describe(done.mission),
                    done.row.error
                )
            });
            let kept = results.record_timed(done.mission, done.row, done.wall_s, done.cpu_ms);
            if kept.is_err() {
                stop.store(true, Ordering::Relaxed);
            }
            kept?;
            carried_out += 1;
        }
        Ok(())
    });
    progress.finish();
    outcome?;
    Ok(RunReport {
        carried_out,
        known,
        wall_time_s: begin.elapsed().as_secs_f64(),
        interrupted: options.interrupted.load(Ordering::SeqCst),
        missing: to_do(experiment, Some(results), options.shard, false).0,
    })
}
