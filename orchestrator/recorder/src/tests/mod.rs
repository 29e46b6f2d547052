//! Tests of the whole recorder with synthetic runs.

mod bus;
mod derived;
mod kill;
mod round_trip;
mod unknown_sources;

// Each including crate uses a part.
#[allow(dead_code)]
mod made_up;
