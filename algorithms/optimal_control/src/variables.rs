//! Indices of the variables of a stage, w = (s, u): the state and the controls.

/// Indices of the components of w.
pub const X: usize = 0;
pub const Y: usize = 1;
pub const THETA: usize = 2;
pub const V: usize = 3;
pub const OMEGA: usize = 4;
/// The duration T.
pub const TIME: usize = 5;
/// Change of V in the stage; V itself where it can step.
pub const P: usize = 6;
/// Change of ω in the stage; ω itself where it can step.
pub const Q: usize = 7;
