//! Messages in ROS 2 CDR, decoded by the schema in the log and nothing else: ours and those of
//! ROS 2.

mod decode;
mod schema;

pub use decode::{Cdr, DecodeError, field_at};

pub use schema::{Count, Field, Kind, Number, Schema, SchemaError};
