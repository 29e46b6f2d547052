//! The `protean` command as a library: [`main_with`] is its main function with the kinds of processes that a program
//! offers.

mod cli;

pub use cli::main_with;
pub use kinds;

#[cfg(test)]
mod tests;
