//! The choice of inputs for checks that are too slow for every input.

use std::hash::Hasher as _;

/// Returns `true` for one input of `of`, for which the slow part runs too. It depends on the bytes
/// alone, so that an input always gets the same checks.
pub fn is_chosen(bytes: &[u8], of: u64) -> bool {
    let mut hasher = std::hash::DefaultHasher::new();
    hasher.write(bytes);
    hasher.finish().is_multiple_of(of)
}
