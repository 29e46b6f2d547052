//! Evader that plans its path to an exit with RRT*.
//!
//! [`search`] grows the tree with the two primitives of [`motion`], the edge costs of [`cost`], the
//! bounds and samples of [`bound`] and [`sampler`], and the neighbours of [`index`]. [`evader`]
//! decides when to plan, delays its plans by their simulated computing time, and follows them. The
//! chasing-game paper's planner (§III-G) is [`RrtStarParams::paper`].

pub mod bound;
pub mod collision_map;
pub mod cost;
pub mod evader;
pub mod follow;
pub mod index;
pub mod motion;
pub mod params;
pub mod planning;
pub mod process;
pub mod replan;
pub mod route;
pub mod sampler;
pub mod search;
pub mod tree;

pub use evader::RrtStarEvader;
pub use params::RrtStarParams;
