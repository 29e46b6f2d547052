//! Order in which robots pass each other where there is no room to do so side by side.
//!
//! The free space becomes a graph of places far enough from each other for a robot each. First, every robot
//! drives to a place near it. [`moves()`] brings the robots to their goals on it, one move at a time: always
//! one robot has the way, and the others make room for it, wherever they stand. A [`Schedule`] keeps only the order of moves whose ways
//! meet: a way is a token that one robot hands on to the next. Other robots drive at the same time, and since
//! the moves are possible one after another, no robot waits in a circle.
//!
//! Robots that compute this from equal positions and goals agree without a message.

mod assignment;
mod first_places;
mod lattice;
mod links;
mod moves;
mod places;
mod schedule;
mod spacing;

pub use first_places::Traveller;
pub use moves::{Move, moves};
pub use places::Places;
pub use schedule::Schedule;
pub use spacing::Spacing;
