//! Tests of the crate.

mod fixed_sums;
mod hostile;
mod models;
mod reference;
