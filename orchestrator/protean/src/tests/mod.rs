//! The declarations of files: their schemas, and their reference.

mod cli;
mod reference;
mod schema;
