//! Tests of the crate.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable)]

mod fixed_sums;
mod hostile;
mod models;
mod reference;
