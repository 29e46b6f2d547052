//! The messages, by sender: the world, robots and their planners, perception, the referee, the
//! observer, the optimiser, the processes themselves.

pub mod observer;
pub mod optimiser;
pub mod perception;
pub mod process;
pub mod referee;
pub mod robot;
pub mod world;
