//! Integration tests of the crate; one program saves link time.

mod inputs;
mod lockstep;
