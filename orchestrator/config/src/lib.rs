//! TOML values with the place of every value, so that errors point at it.
//!
//! The crate is independent of scenarios: it parses texts into [`Node`]s with an [`Origin`], reads them into
//! typed values with a `serde` deserializer that reports places of errors ([`fn@read`]), and collects
//! problems in [`Diagnostics`].

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
