//! Dominance regions: the places that each team reaches first, and the possibility of escape.
//!
//! An evader *safely reaches* a place if there is a path to it on which it is, everywhere, strictly
//! before any pursuer could have come within the capture radius. A wave finds the set of such
//! places: it starts at the evader and goes only where the pursuers' wave has not been. This is the
//! open-loop reach-avoid game of Z. Zhou, J. Ding, H. Huang, R. Takei and C. Tomlin, *Efficient path
//! planning algorithms in reach-avoid problems*, Automatica 89, 2018, §4. With evaders no faster
//! than pursuers the set is the geodesic Voronoi region weighted by speeds (in the open, the inside
//! of an Apollonius circle). With faster evaders it is the region that remains when paths are cut
//! off.
//!
//! Guarantee: if an exit is in the set, the evader escapes by that path whatever the pursuers do,
//! even if they know the path. If no exit is in the set, no path that the evader could choose *now*
//! is certain; pursuers that do not know which path it takes may still let it through.
//!
//! All robots move freely at top speed here: turning takes no time, and robots do not block each
//! other. The capture radius is measured along paths: for a pursuer behind a wall, the path around
//! the wall counts.

mod arena;
mod assess;
mod cells;
mod params;

pub use arena::Arena;
pub use assess::{Dominance, Runner, Verdict};
pub use cells::{Cell, Owner};
pub use params::DominanceParams;
