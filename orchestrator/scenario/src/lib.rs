//! Scenarios: one TOML file describes a whole mission.
//!
//! [`Loader`] turns the path of a scenario, or the name of a built-in one, into a
//! [`ResolvedScenario`]. It applies teams, defaults and `--set` overrides, reads the map and writes it
//! out, draws the starts, completes the typed parameters of every process, and checks everything.
//! Problems are [`Diagnostics`](config::Diagnostics), each with file, line, field, value and expected
//! value. [`ResolvedScenario::to_toml`] writes a self-contained text that loads to the same scenario; logs
//! store this text.
//!
//! A new kind of process is one implementation of [`runtime::ProcessKind`] and one entry in a program's
//! list of kinds.

mod context;
mod draft;
pub mod events;
pub mod expect;
mod failure;
mod feasibility;
pub mod kind;
mod links;
mod load;
mod overrides;
mod processes;
mod remarks;
mod resolve;
mod resolved;
mod robots;
pub mod schema;
pub mod spec;
pub mod starts;
mod template;
mod unusual;
mod world;

#[cfg(test)]
mod tests;

pub use context::refusal;
pub use draft::Draft;
pub use events::{EventSpec, Moment};
pub use failure::Supervision;
pub use load::{Loader, ScenarioEntry, list};
pub use remarks::{ScenarioRemark, remark_lines};
pub use resolved::{ProcessSpec, Program, ProgramDeclaration, ResolvedScenario};
pub use scenario_files::{builtin, files};
pub use spec::OnFailure;
pub use template::{MapCache, Template};
