//! Assessment of the game by a referee: dominance, and possible escapes.

use crate::message::ZeroCopySend;

use crate::headers;
use crate::message;
use crate::stamp::Stamp;

message! {
    /// Verdict on the escape of one evader, in `world/verdict`; one per evader that still plays.
    pub struct Verdict = "protean/Verdict" {
        margin: f64 = "how much earlier than any pursuer the evader is at the exit [s]; infinite without a pursuer, -infinite without an exit; positive though no escape is possible: the way can be cut off",
        time: f64 = "time of the safe way to the exit [s]; infinite if there is none",
        area_share: f64 = "share of all places where a robot fits that the evader reaches safely, 0..1",
        robot: u32 = "index of the evader",
        exit: u32 = "index of the exit with the greatest margin, or 4294967295",
        escape_possible: u8 = "1 if the evader reaches an exit whatever the pursuers do",
        reserved: [u8; 7] = "always 0",
    }
}

message! {
    /// Header of `world/dominance`.
    pub struct DominanceHeader = "protean/DominanceHeader" {
        stamp: Stamp = "the state of the world that was judged",
        resolution: f64 = "side of a cell [m]",
        origin_x: f64 = "outer corner of cell (0, 0), x [m]",
        origin_y: f64 = "outer corner of cell (0, 0), y [m]",
        width: u32 = "columns (cells along x)",
        height: u32 = "rows (cells along y)",
        revision: u32 = "revision of the map that was judged by",
        police_cells: u32 = "cells where a pursuer is first",
        evader_cells: u32 = "cells that an evader reaches safely",
        cut_off_cells: u32 = "cells where an evader would be first, but not safely",
    }
}

message! {
    /// One cell of `world/dominance`, row by row from the smallest y, columns along +x.
    pub struct DominanceCell = "protean/DominanceCell" {
        margin: f32 = "how much later than the first evader the first pursuer is there [s], in steps of 1/64 s; infinite where only one side comes, 0 where nobody does",
        robot: u16 = "index of the robot that dominates the cell, or 65535",
        owner: u8 = "0 nobody (an obstacle), 1 the police, 2 an evader safely, 3 an evader would be first, but not safely",
        reserved: u8 = "always 0",
    }
}

impl Verdict {
    /// Value for "no exit".
    pub const NONE: u32 = u32::MAX;
}

impl DominanceCell {
    /// Value for "no robot".
    pub const NO_ROBOT: u16 = u16::MAX;
}

headers!(DominanceHeader);
