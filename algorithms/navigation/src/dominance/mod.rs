//! Who reaches what first: dominance regions and whether an escape is still possible.
//!
//! An evader *safely reaches* a place if there is a way to it on which it is, everywhere, strictly
//! before any pursuer could have come within the capture radius. The set of such places is found by
//! a wave that starts at the evader and goes only where the pursuers' wave has not been: the
//! open-loop reach-avoid game of Z. Zhou, J. Ding, H. Huang, R. Takei and C. Tomlin, *Efficient path
//! planning algorithms in reach-avoid problems*, Automatica 89, 2018, §4. With evaders no faster
//! than pursuers it is the geodesic Voronoi region weighted by speeds (in the open, the inside of an
//! Apollonius circle); with faster ones what is left when ways are cut off.
//!
//! What it says, and what not: if an exit is in the set, the evader escapes by that way whatever the
//! pursuers do, even if they know the way. If none is, then no way that it could choose *now* is
//! certain; pursuers that do not know which one it takes may still let it through.
//!
//! Everybody moves freely at top speed here, evaders and pursuers alike: turning takes no time, and
//! robots do not block each other. The capture radius is measured along ways: a pursuer behind a
//! wall is as far off as its way round.

mod arena;
mod assess;
mod cells;
mod params;

pub use arena::Arena;
pub use assess::{Dominance, Runner, Verdict};
pub use cells::{Cell, Owner};
pub use params::DominanceParams;
