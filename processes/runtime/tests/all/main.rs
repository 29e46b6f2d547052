//! Integration tests of the crate; one program saves link time.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod inputs;
mod lockstep;
