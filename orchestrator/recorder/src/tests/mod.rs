//! The recorder as a whole, with made-up runs.

mod bus;
mod derived;
mod kill;
mod round_trip;
mod unknown_sources;

// Each crate that includes it uses parts of it.
#[allow(dead_code)]
mod made_up;
