//! The kinds of missions that an experiment can have.

parameters::choice! {
    /// Kind of the missions of an experiment.
    pub enum Kind {
        /// Missions of robots.
        #[default]
        Missions,
        /// Plans of minimum-time trajectories.
        Planning,
    }
}

impl Kind {
    /// Returns `true` for the default kind.
    #[expect(
        clippy::trivially_copy_pass_by_ref,
        reason = "what serde calls it with"
    )]
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}
