//! Views of a run from its log: one [`picture`] (SVG), and one [`page`] for a browser.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod page;
pub mod picture;
mod run_model;
