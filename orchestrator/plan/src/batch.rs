//! Many problems, several at once.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use super::answer::{Answer, solve};
use super::file::Element;
use super::options::PlanOptions;

/// How problems are planned.
#[derive(Debug, Clone)]
pub struct Settings {
    /// How plans are made.
    pub options: PlanOptions,
    /// Problems at once, > 0.
    pub jobs: usize,
    /// How often each is planned, for the sake of its CPU time, > 0.
    pub repeat: u32,
}

/// Plans all of them; `done` is told of each with its index as soon as it is over. Those that are
/// at work when `interrupted` is set are given up, and no other is begun.
///
/// # Errors
/// A thread could not be started; `done` has been told of what came before.
pub fn solve_all(
    elements: &[Element],
    settings: &Settings,
    interrupted: &AtomicBool,
    mut done: impl FnMut(usize, Answer),
) -> std::io::Result<()> {
    let next = AtomicUsize::new(0);
    let work = |tell: &mpsc::Sender<(usize, Answer)>| {
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
            if tell.send((index, answer)).is_err() {
                return;
            }
        }
    };
    let (tell, told) = mpsc::channel();
    std::thread::scope(|scope| {
        let work = &work;
        for worker in 0..settings.jobs.clamp(1, elements.len().max(1)) {
            let tell = tell.clone();
            std::thread::Builder::new()
                .name(format!("plan-{worker}"))
                .spawn_scoped(scope, move || work(&tell))?;
        }
        drop(tell);
        for (index, answer) in told {
            done(index, answer);
        }
        Ok(())
    })
}
