//! TOML that remembers where every value came from, so that every error can point at it.
//!
//! Nothing here knows what a scenario is: texts are parsed into [`Node`]s with an [`Origin`], read
//! into typed values by a `serde` deserializer that reports *where* it failed ([`fn@read`]), and
//! problems are collected in [`Diagnostics`].

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod deserialize;
mod diagnostic;
mod node;
mod parse;
mod path;
mod read;
mod source;
mod suggest;
mod write;

pub use deserialize::{ReadError, ReadFault};
pub use diagnostic::{Code, Diagnostic, Diagnostics, Place};
pub use node::{Entry, Node, Table, Value, render_float};
pub use parse::{parse_document, parse_string, parse_value};
pub use path::{FieldPath, Step};
pub use read::{describe, problem_at, read, read_once, suggest};
pub use source::{Origin, SourceKind, Sources};
pub use suggest::{list_choices, nearest};
pub use write::{write_document, write_value};
