//! The instances, and their division over threads.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use mission::in_process::Cache;
use observation::facts::RobotFacts;
use observation::layout::Layout;
use scenario::Template;

use crate::arrays::{ArraysMut, Shape};
use crate::backend::{WithProcesses, WorldBackend};
use crate::chunk::Chunk;
use crate::episode::{Episode, WhichEpisode};
use crate::error::EnvironmentError;
use crate::options::Options;
use crate::running::RunningEpisode;
use crate::shared::{SharedData, Variant};
use crate::start::Start;
use crate::workers::Worker;

/// Maximum number of numbers, in the observations of all ticks, of a step that is short.
const SHORT: usize = 1 << 16;

/// Many instances of one scenario.
///
/// The episode of an instance ends with its mission, or when no agent is in the game.
/// [`Autoreset`](crate::Autoreset) says what begins the next one. Seeds of episodes follow from the seed, the index of
/// the instance and the number of the episode.
#[derive(Debug)]
pub struct Environments {
    shared: Arc<SharedData>,
    engine: Engine,
    /// `true` after the first reset.
    has_begun: bool,
}

#[derive(Debug)]
enum Engine {
    /// One thread, the caller's.
    Here(Box<Chunk<WorldBackend>>),
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
        let shared = Arc::new(SharedData::new(template, options, cache)?);
        let are_alone = shared.are_alone;
        let Options {
            instances, threads, ..
        } = shared.options;
        let engine = if are_alone && threads == 1 {
            let chunk = Chunk::new(Arc::clone(&shared), 0..instances);
            Engine::Here(Box::new(chunk))
        } else {
            let start = if are_alone {
                Worker::start::<WorldBackend>
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
        let start = |instance| {
            let first = seed.map(|seed| (seed, instance));
            Some(Start {
                first,
                ..Start::default()
            })
        };
        let starts: Vec<_> = (0..self.shared.shape.instances).map(start).collect();
        self.reset_each(&starts, arrays)
    }

    /// Begins new episodes in some instances: one [`Start`] for each, `None` where the episode goes on. The arrays of
    /// the others do not change.
    ///
    /// # Errors
    /// [`EnvironmentError`] as [`Self::reset`]; also if the first reset leaves out an instance.
    pub fn reset_each(
        &mut self,
        starts: &[Option<Start>],
        arrays: &mut ArraysMut<'_>,
    ) -> Result<(), EnvironmentError> {
        let shape = &self.shared.shape;
        arrays.check(shape)?;
        check_length("starts", starts.len(), shape.instances)?;
        if !self.has_begun && starts.iter().any(Option::is_none) {
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
    /// [`EnvironmentError`] if there is none, or none is recorded.
    pub fn episode(
        &self,
        instance: usize,
        which: WhichEpisode,
    ) -> Result<Episode, EnvironmentError> {
        if !self.shared.options.record {
            return Err(EnvironmentError::NotRecorded);
        }
        let found = self.look(instance, move |seen| match which {
            WhichEpisode::Last => seen.last.cloned(),
            WhichEpisode::Running => Some(seen.episode.clone()),
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
        look: impl FnOnce(&RunningEpisode<'_>) -> T + Send + 'static,
    ) -> Result<T, EnvironmentError> {
        let (send, seen) = std::sync::mpsc::sync_channel(1);
        let look = Box::new(move |running: &RunningEpisode<'_>| {
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

    /// Returns what ends a reset or a step: as long as it is `true`, they fail with [`EnvironmentError::Interrupted`].
    /// The environments must be reset then.
    pub fn interruption(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.shared.interrupted)
    }

    /// Returns `true` if a step takes far less than a second: few instances, which have the world alone.
    pub fn steps_are_short(&self) -> bool {
        let shape = self.shape();
        let numbers = shape.instances * shape.agents * shape.observation.max(1);
        let ticks = self.shared.options.ticks_per_action as usize;
        matches!(self.engine, Engine::Here(_))
            && self.shared.planner_map.is_none()
            && numbers.saturating_mul(ticks) <= SHORT
    }

    /// Returns the scenario of the episodes, from which resets can have others.
    pub fn variant(&self) -> Variant {
        Variant(Arc::clone(&self.shared))
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
