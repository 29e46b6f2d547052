//! The declarations of files: their schemas, and their reference.

mod cli;
mod ranges;
mod reference;
mod schema;
