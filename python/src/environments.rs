//! Environments for learning: many instances of a scenario, with arrays that steps write in place.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};

use draw::raster::pixels;
use environment::{
    ArraysMut, EVENT_NAMES, EVENTS, EnvironmentError, Environments as Inner, Options,
    RewardWeights, RunningEpisode, Start, Variant as Other, WhichEpisode,
};
use kinds::KINDS;
use numpy::{
    Element, IntoPyArray as _, PyArray3, PyArrayDyn, PyArrayMethods as _, PyReadonlyArrayDyn,
};
use pyo3::prelude::*;
use report::picture::{RunTrace, draw};
use scenario::kind::ConfiguredKind;
use scenario::{Draft, Loader, MapCache, Template};

use crate::log::image;
use crate::run::{CACHE, FunctionPlanner, kinds_of, place};
use python_algorithms::arguments::{invalid, refused};
use python_algorithms::error::{Error, InvalidInput};
use python_algorithms::interruptible::{compute, short, wait};

/// Begun episode: seed with its index, and scenario.
type EpisodeStart = (Option<(u64, usize)>, Option<Py<Variant>>);

/// The scenario with other values, for resets.
#[pyclass(frozen, module = "protean_robotics")]
pub struct Variant(Other);

/// Instances of a scenario whose agents Python steers. Its arrays are the same objects in all steps.
#[pyclass(frozen, module = "protean_robotics")]
pub struct Environments {
    inner: Mutex<Inner>,
    /// The scenario before values are given.
    draft: Draft<'static>,
    planners: Arc<Vec<FunctionPlanner>>,
    /// Pictures of the running episodes by their instance, with the seed of the episode.
    pictures: Mutex<BTreeMap<usize, (u64, RunTrace)>>,
    /// Names of the agents, in the order of the arrays.
    #[pyo3(get)]
    agents: Vec<String>,
    /// Names of the entries of the observation of each agent.
    #[pyo3(get)]
    entries: Vec<Vec<String>>,
    /// Names of the events, in the order of the array.
    #[pyo3(get)]
    event_names: Vec<String>,
    /// Length of a step (s).
    #[pyo3(get)]
    dt: f64,
    /// Observations, shape (instances, agents, entries).
    #[pyo3(get)]
    observations: Py<PyArrayDyn<f32>>,
    /// Last observations of ended episodes, shape (instances, agents, entries).
    #[pyo3(get)]
    final_observations: Py<PyArrayDyn<f32>>,
    /// Rewards by the weights, shape (instances, agents).
    #[pyo3(get)]
    rewards: Py<PyArrayDyn<f64>>,
    /// Sums of the rewards of all agents, shape (instances,).
    #[pyo3(get)]
    reward_sums: Py<PyArrayDyn<f64>>,
    /// Numbers of events, shape (instances, agents, events).
    #[pyo3(get)]
    events: Py<PyArrayDyn<f32>>,
    /// Status of the agents, shape (instances, agents).
    #[pyo3(get)]
    statuses: Py<PyArrayDyn<u8>>,
    /// `True` if the episode ended by the rules, shape (instances,).
    #[pyo3(get)]
    terminated: Py<PyArrayDyn<bool>>,
    /// `True` if the time limit ended the episode, shape (instances,).
    #[pyo3(get)]
    truncated: Py<PyArrayDyn<bool>>,
    /// Sums of the rewards of the episode, shape (instances, agents).
    #[pyo3(get)]
    returns: Py<PyArrayDyn<f64>>,
    /// Numbers of steps of the episode, shape (instances,).
    #[pyo3(get)]
    lengths: Py<PyArrayDyn<u64>>,
    /// Seeds of the running episodes, shape (instances,).
    #[pyo3(get)]
    seeds: Py<PyArrayDyn<u64>>,
}

#[pymethods]
impl Environments {
    #[new]
    #[pyo3(signature = (
        scenario, *, overrides, agents, observation, action, instances, seed, autoreset_mode, ticks_per_action, threads, weights, planners, record, allow_outside
    ))]
    #[expect(
        clippy::too_many_arguments,
        reason = "the options of the Python classes"
    )]
    fn new(
        py: Python<'_>,
        scenario: String,
        overrides: Vec<String>,
        agents: Vec<String>,
        observation: String,
        action: String,
        instances: usize,
        seed: u64,
        autoreset_mode: String,
        ticks_per_action: u32,
        threads: usize,
        weights: Vec<(String, f64)>,
        planners: Vec<FunctionPlanner>,
        record: bool,
        allow_outside: bool,
    ) -> PyResult<Self> {
        let mut options = Options {
            instances,
            agents,
            observation: observation.parse().map_err(|error| invalid(&error))?,
            action: action.parse().map_err(|error| invalid(&error))?,
            seed,
            autoreset: autoreset_mode.parse().map_err(raised)?,
            ticks_per_action,
            threads,
            rewards: rewards(&weights)?,
            record,
            programs: BTreeMap::new(),
        };
        let (draft, planners, inner) = compute(py, move || {
            runtime::logging::start("warn");
            let loader = Loader::new(KINDS).allow_outside(allow_outside);
            let draft = loader.draft(&scenario);
            let draft = draft.map_err(|problems| raised(problems.into()))?;
            let (template, programs) = filled(draft.clone(), &overrides, &planners)?;
            options.programs = programs;
            let inner = Inner::new(template, options, Arc::clone(&CACHE));
            Ok::<_, PyErr>((draft, planners, inner.map_err(raised)?))
        })??;
        let shape = inner.shape();
        let (n, agents, length) = (shape.instances, shape.agents, shape.observation);
        let layouts = inner.layouts().iter();
        Ok(Self {
            agents: inner.agents().map(|agent| agent.name.clone()).collect(),
            entries: layouts.map(|layout| layout.names().to_vec()).collect(),
            event_names: EVENT_NAMES.map(str::to_owned).to_vec(),
            dt: inner.dt(),
            inner: Mutex::new(inner),
            draft,
            planners: Arc::new(planners),
            pictures: Mutex::default(),
            observations: zeros(py, &[n, agents, length]),
            final_observations: zeros(py, &[n, agents, length]),
            rewards: zeros(py, &[n, agents]),
            reward_sums: zeros(py, &[n]),
            events: zeros(py, &[n, agents, EVENTS]),
            statuses: zeros(py, &[n, agents]),
            terminated: zeros(py, &[n]),
            truncated: zeros(py, &[n]),
            returns: zeros(py, &[n, agents]),
            lengths: zeros(py, &[n]),
            seeds: zeros(py, &[n]),
        })
    }

    /// Returns the scenario with these values.
    fn variant(&self, py: Python<'_>, overrides: Vec<String>) -> PyResult<Variant> {
        let unchanged = self.lock()?.variant();
        let (draft, planners) = (self.draft.clone(), Arc::clone(&self.planners));
        compute(py, move || {
            let (template, programs) = filled(draft, &overrides, &planners)?;
            let variant = unchanged.with(template, programs);
            variant.map(Variant).map_err(raised)
        })?
    }

    /// Begins new episodes in the instances with a start, which may have a seed with its index, and a scenario; None lets
    /// an episode go on.
    fn reset_each(&self, py: Python<'_>, starts: Vec<Option<EpisodeStart>>) -> PyResult<()> {
        let start = |(first, variant): EpisodeStart| Start {
            first,
            variant: variant.map(|variant| variant.get().0.clone()),
        };
        let starts: Vec<_> = starts.into_iter().map(|given| given.map(start)).collect();
        self.write(py, false, |inner, arrays| inner.reset_each(&starts, arrays))
    }

    /// Does a step with actions of shape (instances, agents, 2); returns `True` if an episode ended.
    fn step(&self, py: Python<'_>, actions: PyReadonlyArrayDyn<'_, f32>) -> PyResult<bool> {
        let actions = actions.as_slice().map_err(|error| invalid(&error))?;
        self.write(py, true, |inner, arrays| {
            inner.step(actions, arrays)?;
            let mut ends = arrays.terminated.iter().chain(arrays.truncated.iter());
            Ok(ends.any(|&ended| ended))
        })
    }

    /// Does several steps in one call, with actions of shape (steps, instances, agents, 2).
    fn steps(&self, py: Python<'_>, actions: PyReadonlyArrayDyn<'_, f32>) -> PyResult<()> {
        let actions = actions.as_slice().map_err(|error| invalid(&error))?;
        self.write(py, false, |inner, arrays| {
            let mut steps = actions.chunks(inner.shape().actions().max(1));
            steps.try_for_each(|actions| inner.step(actions, arrays))
        })
    }

    /// Returns seed and actions, shape (steps, agents, 2), of the last completed or of the running episode.
    fn episode<'py>(
        &self,
        py: Python<'py>,
        instance: usize,
        running: bool,
    ) -> PyResult<(u64, Bound<'py, PyArrayDyn<f32>>)> {
        let episode = self.lock()?.episode(instance, which(running));
        let episode = episode.map_err(raised)?;
        let shape = [episode.steps as usize, self.agents.len(), 2];
        let actions = episode.actions.into_pyarray(py).reshape(shape)?;
        Ok((episode.seed, actions.to_dyn().clone()))
    }

    /// Draws the running episode of an instance; returns pixels of shape (height, width, 3), of a size (px) if given.
    #[pyo3(signature = (instance, size=None))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        instance: usize,
        size: Option<[u32; 2]>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let trace = short(py, || self.look(instance))?;
        let pixels = compute(py, move || pixels(&draw(&trace), size))?;
        let pixels = pixels.map_err(|error| invalid(&error))?;
        image(py, pixels)
    }

    /// Executes an episode again as a run, with a log if there is a path; returns its report as JSON.
    #[pyo3(signature = (instance, running, out=None, force=false))]
    fn replay(
        &self,
        py: Python<'_>,
        instance: usize,
        running: bool,
        out: Option<PathBuf>,
        force: bool,
    ) -> PyResult<String> {
        let episode = self.lock()?.episode(instance, which(running));
        let episode = episode.map_err(raised)?;
        let interrupted = Arc::default();
        let (run, signal) = wait(py, &interrupted, || {
            episode.replay(out, force, &interrupted)
        })?;
        signal?;
        let (scenario, report) = run.map_err(raised)?;
        Ok(report.json(&scenario, &scenario.remarks()).to_string())
    }
}

impl Environments {
    /// Returns the picture of the running episode of an instance, with the trails since its first picture.
    fn look(&self, instance: usize) -> PyResult<RunTrace> {
        let before = self.pictures().remove(&instance);
        let look = move |running: &RunningEpisode<'_>| {
            let now = running.world.time().as_secs_f64();
            let is_same =
                |(seed, trace): &(u64, RunTrace)| *seed == running.seed && trace.time_s <= now;
            let mut trace = if let Some((_, trace)) = before.filter(is_same) {
                trace
            } else {
                RunTrace::before_run(&running.scenario()?)?
            };
            trace.show(running.world);
            Ok((running.seed, trace))
        };
        let seen: Result<_, Box<dyn core::error::Error + Send + Sync>> =
            self.lock()?.look(instance, look).map_err(raised)?;
        let (seed, trace) = seen.map_err(|error| Error::new_err(error.to_string()))?;
        self.pictures().insert(instance, (seed, trace.clone()));
        Ok(trace)
    }

    fn pictures(&self) -> MutexGuard<'_, BTreeMap<usize, (u64, RunTrace)>> {
        self.pictures.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the instances, which one thread at a time may use.
    fn lock(&self) -> PyResult<MutexGuard<'_, Inner>> {
        // Waiting would stop the thread that has them, which needs the interpreter to go on.
        self.inner.try_lock().map_err(|error| {
            Error::new_err(match error {
                TryLockError::WouldBlock => "the environments are in use by another thread",
                TryLockError::Poisoned(_) => "an earlier call panicked: create new environments",
            })
        })
    }

    /// Does work that writes all arrays, a step or something longer, while other threads may run.
    fn write<T: Send>(
        &self,
        py: Python<'_>,
        is_step: bool,
        work: impl FnOnce(&mut Inner, &mut ArraysMut<'_>) -> Result<T, EnvironmentError> + Send,
    ) -> PyResult<T> {
        macro_rules! borrow {
            ($($name:ident),*) => {{
                $(let mut $name = self.$name.bind(py).try_readwrite().map_err(|error| invalid(&error))?;)*
                let mut arrays = ArraysMut {
                    $($name: $name.as_slice_mut().map_err(|error| invalid(&error))?,)*
                };
                let mut guard = self.lock()?;
                let inner = &mut *guard;
                if is_step && inner.steps_are_short() {
                    return short(py, || work(inner, &mut arrays)).map_err(raised);
                }
                let interrupted = inner.interruption();
                interrupted.store(false, Ordering::Relaxed);
                let (done, signal) = wait(py, &interrupted, || work(inner, &mut arrays))?;
                // It stays interrupted for no longer than this call.
                interrupted.store(false, Ordering::Relaxed);
                signal?;
                done.map_err(raised)
            }};
        }
        borrow!(
            observations,
            final_observations,
            rewards,
            reward_sums,
            events,
            statuses,
            terminated,
            truncated,
            returns,
            lengths,
            seeds
        )
    }
}

/// Fills in the values and planners of a scenario.
fn filled(
    mut draft: Draft<'static>,
    overrides: &[String],
    planners: &[FunctionPlanner],
) -> PyResult<(Template, BTreeMap<String, ConfiguredKind>)> {
    for argument in overrides {
        draft.apply("--set", argument);
    }
    let template = draft.template(&mut MapCache::default());
    let mut template = template.map_err(|problems| raised(problems.into()))?;
    let placed = template.change(|scenario| place(scenario, planners));
    placed.map_err(|error| invalid(&error))?;
    let programs = kinds_of(template.scenario(), planners);
    Ok((template, programs.map_err(|error| invalid(&error))?))
}

fn zeros<T: Element>(py: Python<'_>, shape: &[usize]) -> Py<PyArrayDyn<T>> {
    PyArrayDyn::zeros(py, shape, false).unbind()
}

fn which(running: bool) -> WhichEpisode {
    if running {
        WhichEpisode::Running
    } else {
        WhichEpisode::Last
    }
}

/// Reads weights by their names; absent ones are the defaults.
fn rewards(given: &[(String, f64)]) -> PyResult<RewardWeights> {
    let mut weights = RewardWeights::default();
    for (name, value) in given {
        let weight = match name.as_str() {
            "escape" => &mut weights.escape,
            "caught" => &mut weights.caught,
            "capture" => &mut weights.capture,
            "lost" => &mut weights.lost,
            "arrival" => &mut weights.arrival,
            "contact" => &mut weights.contact,
            "time" => &mut weights.time,
            "progress" => &mut weights.progress,
            _ => {
                return Err(InvalidInput::new_err(format!(
                    "reward: no weight {name:?}: expected one of {}, time, progress",
                    EVENT_NAMES.join(", ")
                )));
            }
        };
        *weight = *value;
    }
    Ok(weights)
}

fn raised(error: EnvironmentError) -> PyErr {
    if let EnvironmentError::Option {
        option: "instances",
        given,
        expected,
    } = &error
    {
        return refused("num_envs", given, expected);
    }
    let text = error.to_string();
    if error.is_refusal() {
        InvalidInput::new_err(text.trim_start_matches("error: ").to_owned())
    } else {
        Error::new_err(text)
    }
}
