//! The declarations of files: their schemas, and their reference.

mod reference;
mod schema;
