//! The optimiser as a whole: from problems to plans.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod backwards;
mod bad_input;
mod ends;
mod inertia;
mod methods;
mod problems;
mod random;
mod repeated_searches;
