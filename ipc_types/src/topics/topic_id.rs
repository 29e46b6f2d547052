//! Topics as values.

/// A topic as a value. Its order is that of the table of built-in topics, then that of registration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TopicId(u16);

impl TopicId {
    /// The topic at this place of the table and the registration.
    pub(super) const fn from_index(place: usize) -> Self {
        Self(place as u16)
    }

    /// Place among [`TopicId::all`].
    pub const fn rank(self) -> usize {
        self.0 as usize
    }
}
