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
//! If an exit is in the set, an evader that turns at once and follows the path exactly escapes by it
//! whatever the pursuers do, even if they know the path; `pursuit_evasion::escape` takes the drive of a real
//! evader into account. If no exit is in the set, no path that the evader could choose *now* is
//! safe; pursuers that do not know which path it takes may still let it through.
//!
//! Pursuers move freely at top speed, do not block each other, and stop an evader within their reach in
//! a straight line, also through walls.

mod arena;
mod assess;
mod cells;
mod params;

pub use arena::Arena;
pub use assess::{Dominance, Runner, Verdict};
pub use cells::{Cell, Owner};
pub use params::DominanceParams;
