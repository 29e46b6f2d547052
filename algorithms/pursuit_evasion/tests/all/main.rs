//! Evaders in the city and other places, and the Police against scripted evaders; one program, because linking several
//! takes minutes.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod certain_escape;
mod closing_in;
mod cutting_off;
mod escape;
mod police;
