//! The messages, by sender: the world, robots and their planners, perception, the referee, the
//! observer, attackers, the optimiser, the processes themselves.

pub mod attacker;
pub mod observer;
pub mod optimiser;
pub mod perception;
pub mod process;
pub mod referee;
pub mod robot;
pub mod world;
