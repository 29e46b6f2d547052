//! Small logs, whole and broken.

mod broken;
mod foreign;
mod lz4;
mod parts;
mod still;
mod tables;

// Each crate that includes them uses parts of them.
#[allow(dead_code)]
#[path = "../../../recorder/src/tests/made_up.rs"]
mod made_up;
#[allow(dead_code)]
mod support;
