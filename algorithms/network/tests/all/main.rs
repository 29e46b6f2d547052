//! Tests of the crate.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod fixed_sums;
mod hostile;
mod models;
mod reference;
