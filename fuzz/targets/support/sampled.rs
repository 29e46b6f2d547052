//! What is too slow to be done with every input.

use std::hash::Hasher as _;

/// Whether this input is the one of `of` with which the slow part is done too. It follows from the
/// bytes alone, so that an input does the same whenever it comes.
pub fn is_chosen(bytes: &[u8], of: u64) -> bool {
    let mut hasher = std::hash::DefaultHasher::new();
    hasher.write(bytes);
    hasher.finish().is_multiple_of(of)
}
