//! Dominance cell by cell, for people to look at.

/// Who dominates a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Owner {
    /// Neither: an obstacle, or a place that nobody reaches.
    #[default]
    Neither,
    /// The pursuers: one of them is there no later than any evader.
    Police,
    /// An evader reaches it safely.
    Evader,
    /// An evader would be first, but pursuers can cut off every way on which it would.
    CutOff,
}

impl Owner {
    /// The number that stands for it in messages: 0 to 3 in the order of the variants.
    pub const fn code(self) -> u8 {
        match self {
            Self::Neither => 0,
            Self::Police => 1,
            Self::Evader => 2,
            Self::CutOff => 3,
        }
    }
}

/// One cell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cell {
    /// Who dominates it.
    pub owner: Owner,
    /// Place of the first evader in the list of evaders, of the first pursuer in that of pursuers;
    /// 0 with [`Owner::Neither`].
    pub first: u32,
    /// How much later than the first evader the first pursuer is there (s): negative where a
    /// pursuer is first (−∞ if no evader comes), ∞ where no pursuer comes, 0 with
    /// [`Owner::Neither`].
    pub margin: f32,
}
