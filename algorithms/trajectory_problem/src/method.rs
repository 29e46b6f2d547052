//! Methods of planning: curves, initial paths, and points at which obstacles are tested.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Planning method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// The path is a cubic B-spline.
    #[default]
    Bspline,
    /// The path pursues a virtual prey that moves on a B-spline (Eq. 1–14 of the paper).
    Lp,
    /// The path hides in front of a virtual prey on a B-spline: it stays on the line from the prey
    /// to a reference point (Eq. 16–22 of the paper).
    Vmc,
    /// The exact shortest path: straight lines and arcs, with turns on the spot where necessary.
    Tangent,
}

impl Method {
    /// All methods, by wire code.
    pub const ALL: [Self; 4] = [Self::Bspline, Self::Lp, Self::Vmc, Self::Tangent];

    /// The method with this wire code, as sent in messages; `None` for an unknown code.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.get(code as usize).copied()
    }

    /// The wire code of the method.
    pub const fn code(self) -> u32 {
        self as u32
    }

    /// The name in requests and commands.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bspline => "bspline",
            Self::Lp => "lp",
            Self::Vmc => "vmc",
            Self::Tangent => "tangent",
        }
    }

    /// The method with this name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}

parameters::choice! {
    /// Initial path of a method.
    pub enum Guess {
        /// The exact shortest path.
        #[default]
        Tangent,
        /// The wavefront on a grid (the paper's), pulled taut.
        Wavefront,
    }
}

impl Guess {
    /// All initial paths, by wire code.
    pub const ALL: [Self; 2] = [Self::Tangent, Self::Wavefront];

    /// The initial path with this wire code, as sent in messages; `None` for an unknown code.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.get(code as usize).copied()
    }

    /// The wire code of the initial path.
    pub const fn code(self) -> u32 {
        self as u32
    }
}

parameters::choice! {
    /// Points of the curve at which obstacles are tested.
    pub enum Constraints {
        /// Everywhere, dense enough to miss none.
        #[default]
        Dense,
        /// Only at the N + 1 Legendre–Gauss–Lobatto nodes, as in the paper. Obstacles between two nodes
        /// are not detected: most such curves hit one, and are then rejected.
        Nodes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_names_map_back() {
        for method in Method::ALL {
            assert_eq!(Method::from_code(method.code()), Some(method));
            assert_eq!(Method::by_name(method.name()), Some(method));
        }
        for guess in Guess::ALL {
            assert_eq!(Guess::from_code(guess.code()), Some(guess));
        }
        assert_eq!((Method::from_code(4), Guess::from_code(2)), (None, None));
    }
}
