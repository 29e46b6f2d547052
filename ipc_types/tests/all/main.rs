//! The crate from outside; one program, because linking five costs.

mod any_bus;
mod bus;
mod bus_in_memory;
mod cdr_python;
mod cdr_round_trip;

mod support;
