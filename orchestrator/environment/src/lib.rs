//! Many instances of one scenario, in which a learner steers some robots, the *agents*. All other robots are driven by
//! the scenario's own processes.
//!
//! - [`Environments`]: the instances: reset, step, recorded episodes; [`Episode::replay`]: these as runs with a log;
//! - [`Options`], [`RewardWeights`]: number of instances, agents, observation, seed, threads, rewards;
//! - [`RunningEpisode`]: a look at the world of an instance;
//! - [`Arrays`], [`ArraysMut`], [`Shape`]: results of a step, written in place.
//!
//! Instances without any other steering process step the world alone and allocate no memory in a step. The others run
//! the processes of the scenario over a bus in memory, as [`mission::in_process`] does. The history of an episode is in
//! both cases that of a run whose planners send the commands of the actions.
//!
//! ```
//! use environment::{Arrays, Environments, Options};
//! use scenario::{Loader, MapCache};
//!
//! let draft = Loader::new(kinds::KINDS).draft("chase_exact")?;
//! let template = draft.template(&mut MapCache::default())?;
//! let agents = vec!["police".to_owned(), "evader".to_owned()];
//! let options = Options { instances: 2, agents, ..Options::default() };
//! let mut environments = Environments::new(template, options, Default::default())?;
//! let mut arrays = Arrays::new(environments.shape());
//! environments.reset(None, &mut arrays.as_mut())?;
//! let actions = vec![0.5; environments.shape().actions()];
//! environments.step(&actions, &mut arrays.as_mut())?;
//! assert!(arrays.rewards.iter().all(|&reward| reward == 0.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod agents;
mod arrays;
mod backend;
mod chunk;
mod commanded;
mod environments;
mod episode;
mod episode_seed;
mod error;
mod instance;
mod options;
mod remaining_path;
mod replay;
mod rewards;
mod running;
mod shared;
mod start;
mod workers;

pub use arrays::{Arrays, ArraysMut, Shape};
pub use environments::Environments;
pub use episode::{Episode, WhichEpisode};
pub use error::EnvironmentError;
pub use options::{Autoreset, Options};
pub use rewards::{EVENT_NAMES, EVENTS, RewardWeights};
pub use running::RunningEpisode;
pub use shared::Variant;
pub use start::Start;
