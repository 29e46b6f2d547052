//! Planning of many problems in parallel.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use super::answer::{Answer, solve};
use super::file::Element;
use trajectory_problem::Options;

/// Settings for planning many problems.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Options of the planner.
    pub options: Options,
    /// Number of problems planned in parallel, > 0.
    pub jobs: usize,
    /// Number of repetitions of each problem, to measure its CPU time, > 0.
    pub repeat: u32,
}

/// Plans all problems. Calls `done` with the index and the answer of each as soon as it is complete. When
/// `interrupted` is set, it abandons the current problems and starts no more.
///
/// # Errors
/// A thread could not be started; `done` was called for the problems before.
pub fn solve_all(
    elements: &[Element],
    settings: &Settings,
    interrupted: &AtomicBool,
    mut done: impl FnMut(usize, Answer),
) -> std::io::Result<()> {
    let next = AtomicUsize::new(0);
    let work = |answers: &mpsc::Sender<(usize, Answer)>| {
        while !interrupted.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(element) = elements.get(index) else {
                return;
            };
            let answer = match &element.instance {
                Ok(instance) => solve(instance, &settings.options, settings.repeat, interrupted),
                Err(error) => {
                    let method = settings.options.method;
                    Some(Answer::invalid(&element.id, method, error))
                }
            };
            let Some(answer) = answer else { return };
            if answers.send((index, answer)).is_err() {
                return;
            }
        }
    };
    let (answers, received) = mpsc::channel();
    std::thread::scope(|scope| {
        let work = &work;
        for worker in 0..settings.jobs.clamp(1, elements.len().max(1)) {
            let answers = answers.clone();
            std::thread::Builder::new()
                .name(format!("plan-{worker}"))
                .spawn_scoped(scope, move || work(&answers))?;
        }
        drop(answers);
        for (index, answer) in received {
            done(index, answer);
        }
        Ok(())
    })
}
