//! How much of a log is taken into memory at once, whatever it claims.

/// Longest record or chunk that is read (bytes): the largest map that a scenario may have, and a
/// little.
pub(super) const LIMIT: usize = 384 << 20;
/// Most bytes that the descriptions of channels and schemas may take together.
pub(super) const DESCRIPTIONS_LIMIT: usize = 64 << 20;
