//! Tests of the Police against scripted evaders; one program saves link time.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod closing_in;
mod cutting_off;
mod police;
