//! Missions: one TOML file says everything.
//!
//! [`Loader`] turns the path of a scenario, or the name of a built-in one, into a
//! [`ResolvedScenario`]: teams and defaults inherited, `--set` overrides applied, the map read and
//! written out, starts drawn, parameters of every process typed and complete, everything checked.
//! What is wrong comes back as [`Diagnostics`](config::Diagnostics), each with file, line, field,
//! value and what was expected. [`ResolvedScenario::to_toml`] writes the whole into one text that
//! loads to the same, which is what a log stores.
//!
//! A new kind of process is one implementation of [`runtime::ProcessKind`] and one line in
//! the list of a program's kinds.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod builtin;
mod context;
mod draft;
pub mod events;
mod failure;
mod feasibility;
pub mod files;
pub mod jitter;
pub mod kind;
mod load;
mod overrides;
mod processes;
mod resolve;
mod resolved;
mod robots;
pub mod schema;
pub mod spec;
mod template;
mod world;

#[cfg(test)]
mod tests;

pub use context::refusal;
pub use draft::Draft;
pub use events::{EventSpec, Moment};
pub use failure::Supervision;
pub use load::{Listed, Loader, list};
pub use resolved::{ProcessSpec, Program, ResolvedScenario};
pub use spec::OnFailure;
pub use template::{MapCache, Template};
