//! Tests of the public interface; one program, because linking five takes time.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod any_bus;
mod bus;
mod bus_in_memory;
mod cdr_python;
mod cdr_round_trip;

mod support;
