//! The instances, and their division over threads.

use std::sync::Arc;

use mission::in_process::Cache;
use observation::facts::RobotFacts;
use observation::layout::Layout;
use scenario::Template;

use crate::arrays::{ArraysMut, Shape};
use crate::backend::{Alone, WithProcesses};
use crate::chunk::Chunk;
use crate::episode::{Episode, WhichEpisode};
use crate::error::EnvironmentError;
use crate::options::{Options, Start};
use crate::replay::Replayer;
use crate::running::Running;
use crate::shared::Shared;
use crate::workers::Worker;

/// Many instances of one scenario.
///
/// The episode of an instance ends with its mission, or when no agent is in the game.
/// [`Autoreset`](crate::Autoreset) says what begins the next one. Seeds of episodes follow from the seed, the index of
/// the instance and the number of the episode.
#[derive(Debug)]
pub struct Environments {
    shared: Arc<Shared>,
    engine: Engine,
    /// `true` after the first reset.
    has_begun: bool,
}

#[derive(Debug)]
enum Engine {
    /// One thread, the caller's.
    Here(Box<Chunk<Alone>>),
    Threads(Vec<Worker>),
}

impl Environments {
    /// Creates the instances of a scenario; [`Self::reset`] begins their episodes. Pass the same `cache` to all
    /// environments.
    ///
    /// # Errors
    /// [`EnvironmentError`] names the invalid option, or the agent that lacks something.
    pub fn new(
        template: Template,
        options: Options,
        cache: Arc<Cache>,
    ) -> Result<Self, EnvironmentError> {
        let shared = Arc::new(Shared::new(template, options, cache)?);
        let are_alone = shared.agents.are_alone(shared.template.scenario())
            && !shared.options.observation.belief;
        let Options {
            instances, threads, ..
        } = shared.options;
        let engine = if are_alone && threads == 1 {
            let chunk = Chunk::new(Arc::clone(&shared), 0..instances);
            Engine::Here(Box::new(chunk))
        } else {
            let start = if are_alone {
                Worker::start::<Alone>
            } else {
                Worker::start::<WithProcesses>
            };
            let threads = threads.min(instances);
            let ranges = (0..threads)
                .map(|thread| thread * instances / threads..(thread + 1) * instances / threads);
            let workers = ranges.map(|range| start(&shared, range));
            Engine::Threads(workers.collect::<Result<_, _>>()?)
        };
        Ok(Self {
            shared,
            engine,
            has_begun: false,
        })
    }

    /// Returns the shape of the arrays.
    pub fn shape(&self) -> Shape {
        self.shared.shape
    }

    /// Returns the options.
    pub fn options(&self) -> &Options {
        &self.shared.options
    }

    /// Returns the agents, in the order of the arrays.
    pub fn agents(&self) -> impl Iterator<Item = &RobotFacts> {
        let robots = self.shared.agents.robots.iter();
        robots.filter_map(|&robot| self.shared.facts.get(robot))
    }

    /// Returns the observations of the agents, in the order of the arrays.
    pub fn layouts(&self) -> &[Layout] {
        &self.shared.layouts
    }

    /// Returns the length of a step (s).
    pub fn dt(&self) -> f64 {
        self.shared.dt.as_secs_f64() * f64::from(self.shared.options.ticks_per_action)
    }

    /// Begins new episodes in all instances: with a seed, the first ones of this seed; without, the next ones.
    ///
    /// # Errors
    /// [`EnvironmentError`] if an array has another length, or a run cannot begin.
    pub fn reset(
        &mut self,
        seed: Option<u64>,
        arrays: &mut ArraysMut<'_>,
    ) -> Result<(), EnvironmentError> {
        let start = |instance| seed.map_or(Start::Next, |seed| Start::First { seed, instance });
        let starts: Vec<Start> = (0..self.shared.shape.instances).map(start).collect();
        self.reset_each(&starts, arrays)
    }

    /// Begins new episodes in some instances: one [`Start`] for each. The arrays of the others do not change.
    ///
    /// # Errors
    /// [`EnvironmentError`] as [`Self::reset`]; also if the first reset leaves out an instance.
    pub fn reset_each(
        &mut self,
        starts: &[Start],
        arrays: &mut ArraysMut<'_>,
    ) -> Result<(), EnvironmentError> {
        let shape = &self.shared.shape;
        arrays.check(shape)?;
        check_length("starts", starts.len(), shape.instances)?;
        if !self.has_begun && starts.contains(&Start::Keep) {
            return Err(EnvironmentError::NotReset);
        }
        self.has_begun = true;
        match &mut self.engine {
            Engine::Here(chunk) => chunk.reset(starts, arrays),
            Engine::Threads(workers) => {
                let begin = |worker: &mut Worker| worker.begin_reset(starts);
                workers.iter_mut().try_for_each(begin)?;
                finish(workers, arrays)
            }
        }
    }

    /// Does a step with `actions` of shape (instances, agents, 2), which
    /// [`command`](observation::action::command) describes.
    ///
    /// # Errors
    /// [`EnvironmentError`] if an array has another length, an action is not finite, an instance has ended, or a process
    /// failed. After the latter two, the environments must be reset.
    pub fn step(
        &mut self,
        actions: &[f32],
        arrays: &mut ArraysMut<'_>,
    ) -> Result<(), EnvironmentError> {
        let shape = &self.shared.shape;
        arrays.check(shape)?;
        check_length("actions", actions.len(), shape.actions())?;
        if let Some(at) = actions.iter().position(|number| !number.is_finite()) {
            return Err(EnvironmentError::Action {
                instance: at / shape.with_instances(1).actions(),
                given: actions[at],
            });
        }
        match &mut self.engine {
            Engine::Here(chunk) => chunk.step(actions, arrays),
            Engine::Threads(workers) => {
                let begin = |worker: &mut Worker| worker.begin_step(actions);
                workers.iter_mut().try_for_each(begin)?;
                finish(workers, arrays)
            }
        }
    }

    /// Returns a recorded episode of an instance.
    ///
    /// # Errors
    /// [`EnvironmentError`] if there is none.
    pub fn episode(
        &self,
        instance: usize,
        which: WhichEpisode,
    ) -> Result<Episode, EnvironmentError> {
        let found = self.look(instance, move |seen| match which {
            WhichEpisode::Last => seen.last.cloned(),
            WhichEpisode::Running => Some(seen.running.clone()),
        });
        found?.ok_or(EnvironmentError::NoEpisode { instance })
    }

    /// Lets `look` see the running episode of an instance, in the thread that has it; returns what it returns.
    ///
    /// # Errors
    /// [`EnvironmentError`] if there is no episode.
    pub fn look<T: Send + 'static>(
        &self,
        instance: usize,
        look: impl FnOnce(&Running<'_>) -> T + Send + 'static,
    ) -> Result<T, EnvironmentError> {
        let (send, seen) = std::sync::mpsc::sync_channel(1);
        let look = Box::new(move |running: &Running<'_>| {
            // It is received below.
            let _ = send.send(look(running));
        });
        let instances = self.shared.shape.instances;
        let unknown = EnvironmentError::Instance {
            given: instance,
            instances,
        };
        match &self.engine {
            Engine::Here(_) if instance >= instances => return Err(unknown),
            Engine::Here(chunk) => chunk.look(instance, look)?,
            Engine::Threads(workers) => {
                let mut workers = workers.iter();
                let worker = workers.find(|worker| worker.range().contains(&instance));
                worker.ok_or(unknown)?.look(instance, look)?;
            }
        }
        let ended = |_| EnvironmentError::Thread("ended unexpectedly".to_owned());
        seen.recv().map_err(ended)
    }

    /// Returns what executes recorded episodes again.
    pub fn replayer(&self) -> Replayer {
        Replayer::new(Arc::clone(&self.shared))
    }
}

fn check_length(
    array: &'static str,
    given: usize,
    expected: usize,
) -> Result<(), EnvironmentError> {
    if given == expected {
        Ok(())
    } else {
        Err(EnvironmentError::Length {
            array,
            given,
            expected,
        })
    }
}

/// Waits for all threads, and returns the error of the first one.
fn finish(workers: &mut [Worker], arrays: &mut ArraysMut<'_>) -> Result<(), EnvironmentError> {
    let mut result = Ok(());
    for worker in workers {
        let finished = worker.finish(arrays);
        result = result.and(finished);
    }
    result
}
