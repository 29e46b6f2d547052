//! Parameters of keyed coverage.

use sim_backend::params::{ParamsError, positive, require};

/// Most candidates per choice.
const MAX_CANDIDATES: usize = 4096;

/// How keyed coverage chooses its sub-goals.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct KeyedParams {
    /// Side of the cells in which coverage is remembered [m], > 0 and at most the radius of the disc that
    /// the robot covers.
    pub cell: f64,
    /// Orders drawn per sub-goal, of which the best is followed, in [1, 4]; 1.4 draws one or two by
    /// turns of the key. The trade-off: more cover faster and are easier to foretell.
    pub choices: f64,
    /// Points looked at per order, from 1 to 4096.
    pub candidates: usize,
    /// Share of the reachable cells at which a round ends and everything counts as fresh again, in
    /// (0, 1].
    pub round_at: f64,
}

impl Default for KeyedParams {
    fn default() -> Self {
        Self {
            cell: 0.1,
            choices: 1.4,
            candidates: 128,
            round_at: 0.99,
        }
    }
}

impl KeyedParams {
    /// Checks every value against its documented range.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        positive("cell", self.cell)?;
        require(
            (1.0..=4.0).contains(&self.choices),
            "choices",
            &self.choices,
            "a number between 1 and 4",
        )?;
        require(
            (1..=MAX_CANDIDATES).contains(&self.candidates),
            "candidates",
            &self.candidates,
            "a whole number between 1 and 4096",
        )?;
        require(
            self.round_at > 0.0 && self.round_at <= 1.0,
            "round_at",
            &self.round_at,
            "a number above 0 and up to 1",
        )
    }
}
