//! Evaders in the city and other places; one program, because linking several takes minutes.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod certain_escape;
mod escape;
