//! Tests of the public interface; one program, because linking five takes time.

mod any_bus;
mod bus;
mod bus_in_memory;
mod cdr_python;
mod cdr_round_trip;

mod support;
