//! Tests of the Police against scripted evaders; one program saves link time.

#[path = "../../../../algorithms/planner_view/tests/support/mod.rs"]
mod support;

mod closing_in;
mod cutting_off;
mod police;
