//! Evader that plans its way to an exit with RRT*.
//!
//! [`search`] grows the tree; [`motion`] has its two primitives, [`cost`] what edges cost,
//! [`bound`] and [`sampler`] where samples are worth drawing, [`index`] who is near. [`evader`]
//! decides when to plan, waits for its plans as long as they take in simulated time, and follows
//! them. The chasing-game paper's planner (§III-G) is [`RrtStarParams::paper`].

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

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
