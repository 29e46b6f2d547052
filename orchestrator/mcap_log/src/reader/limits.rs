//! Memory limits of the reader.

/// Maximum size of a record or chunk (bytes): slightly more than the largest map of a scenario.
pub const MAX_RECORD_BYTES: usize = 384 << 20;
/// Maximum total size of the descriptions of channels and schemas (bytes).
pub const MAX_DESCRIPTION_BYTES: usize = 64 << 20;
