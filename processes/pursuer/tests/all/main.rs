//! The Police against evaders that move by the book; one program, to be linked once.

#[path = "../../../../algorithms/planner_view/tests/support/mod.rs"]
mod support;

mod closing_in;
mod police;
mod tactics;
