//! Views of a run from its log: one [`picture`] (SVG), and one [`page`] for a browser.

pub mod page;
pub mod picture;
mod run_model;
