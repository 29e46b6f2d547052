//! The `protean` command as a library: [`main_with`] is its main function with the kinds of processes that a program
//! offers.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod cli;

pub use cli::main_with;
pub use kinds;

#[cfg(test)]
mod tests;
