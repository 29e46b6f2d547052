//! Dominance cell by cell, for display.

/// Team that dominates a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Owner {
    /// Neither team: an obstacle, or a place that no robot reaches.
    #[default]
    Neither,
    /// The pursuers: one of them arrives no later than any evader.
    Police,
    /// An evader reaches it safely.
    Evader,
    /// An evader would be first, but pursuers can cut off every path on which it would.
    CutOff,
}

impl Owner {
    /// Number of the variant in messages: 0 to 3 in the order of the variants.
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
    /// Team that dominates the cell.
    pub owner: Owner,
    /// Index of the first evader in the list of evaders, or of the first pursuer in that of
    /// pursuers; 0 with [`Owner::Neither`].
    pub first: u32,
    /// Delay of the first pursuer after the first evader (s): negative where a pursuer is first (−∞
    /// if no evader arrives), ∞ where no pursuer arrives, 0 with [`Owner::Neither`].
    pub margin: f32,
}
