//! Observations and actions of learned policies as vectors of numbers: one code for learning and for the planners that
//! execute what was learned.
//!
//! - [`parts::Parts`]: the contents of an observation, named `state`, `scan`, `belief`, `path` or `state+scan`;
//! - [`layout::Layout`]: the entries of the observation of one robot, from a
//!   [`View`](planner_view::view::View);
//! - [`scene::Scene`]: distances and lines of sight of a tick, computed once for all robots;
//! - [`route_entries::RouteEntries`]: the entries of shortest paths, kept between ticks;
//! - [`action`]: from an action to a command;
//! - [`field_evader::FieldEvader`]: the potential-field evader that actions tune or correct.
//!
//! All entries are in −1..1. Lengths are divided by the diagonal of the map, so that they stay in range; each
//! relative position has its bearing and its *proximity* 1 / (1 + d) in addition, with the distance d (m), so that near
//! bodies differ.

pub mod action;
pub mod error;
pub mod facts;
pub mod field_evader;
pub mod layout;
pub mod parts;
pub mod relative;
pub mod route_entries;
pub mod scene;
