//! Decoder of ROS 2 CDR messages, of this project or of ROS 2, by the schema in the log only.

mod decode;
mod schema;
#[cfg(test)]
mod tests;

pub use decode::{Cdr, DecodeError, field_at};

pub use schema::{Count, Field, Kind, Primitive, Schema, SchemaError};
