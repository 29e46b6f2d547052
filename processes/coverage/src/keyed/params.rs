//! Parameters of keyed coverage.

use guidance::params::{ParamsError, fraction, not_negative, positive};

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
    /// Strips into which the workplace is cut along each axis, from 2 to 16. An order names an axis
    /// and a strip.
    pub strips: usize,
    /// Legs beyond the next that are planned along with it, by orders that only the holder of the
    /// key knows; from 0 to 3. More cover faster and are no easier to foretell, but take time.
    pub foresight: usize,
    /// Points looked at per order, from 1 to 4096.
    pub candidates: usize,
    /// How much new ground a metre of path is worth, as a share of what it sweeps at most, ≥ 0;
    /// more makes shorter legs.
    pub thrift: f64,
    /// How much more the last fresh cell of a neighbourhood is worth than one among fresh ones,
    /// ≥ 0.
    pub rarity: f64,
    /// How far a sub-goal may lie off the axis through the one before, as a share of the
    /// workplace's side, in [0, 1].
    pub sideways: f64,
    /// Share of the reachable cells at which a round ends and everything counts as fresh again, in
    /// (0, 1].
    pub round_at: f64,
}

impl Default for KeyedParams {
    fn default() -> Self {
        Self {
            cell: 0.1,
            choices: 1.4,
            strips: 4,
            foresight: 2,
            candidates: 128,
            thrift: 0.65,
            rarity: 1.5,
            sideways: 0.1,
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
        let require = |holds: bool, field, value: &dyn ToString, expected| {
            if holds {
                Ok(())
            } else {
                Err(ParamsError::new(field, &value.to_string(), expected))
            }
        };
        require(
            (1.0..=4.0).contains(&self.choices),
            "choices",
            &self.choices,
            "a number between 1 and 4",
        )?;
        require(
            (2..=16).contains(&self.strips),
            "strips",
            &self.strips,
            "a whole number between 2 and 16",
        )?;
        require(
            self.foresight <= 3,
            "foresight",
            &self.foresight,
            "a whole number between 0 and 3",
        )?;
        require(
            (1..=MAX_CANDIDATES).contains(&self.candidates),
            "candidates",
            &self.candidates,
            "a whole number between 1 and 4096",
        )?;
        not_negative("thrift", self.thrift)?;
        not_negative("rarity", self.rarity)?;
        fraction("sideways", self.sideways)?;
        require(
            self.round_at > 0.0 && self.round_at <= 1.0,
            "round_at",
            &self.round_at,
            "a number above 0 and up to 1",
        )
    }
}
