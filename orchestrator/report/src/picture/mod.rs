//! One picture of a run, drawn from its log: the map, the trails, where everybody is, who was
//! caught and who got away.
//!
//! * [`RunTrace::read`] takes from a log what the picture needs, in bounded memory;
//! * [`fn@draw`] is the picture, as a pure function;
//! * `save` puts it into a file, whole or not at all.

mod draw;
mod draw_layers;
mod labels;
mod layers;
mod layout;
mod legend;
pub(crate) mod log_facts;
pub(crate) mod log_run;
pub(crate) mod logged;
mod read;
mod signs;
pub(crate) mod static_scene;
mod trace;
mod trail;

#[cfg(test)]
mod tests;

pub use draw::draw;
pub use layers::{DominanceTrace, PlanTrace, TreeTrace};
pub use static_scene::{Cells, Standing, StaticScene};
pub use trace::{BeliefTrace, Mark, MarkKind, RobotTrace, RunTrace};
pub use trail::{Trail, TrailPoint};
