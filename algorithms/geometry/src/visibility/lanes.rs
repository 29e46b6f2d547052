//! Integer line integrals over runs of cells, for rays that are longer *along* the lanes.
//!
//! A lane is a row (or, in the transposed table, a column). Coordinates here are `u` along the
//! lanes and `l` across them, in fixed point with [`POINT_BITS`] fractional bits.

use super::POINT_BITS;

/// Fractional bits of a crossing point along the lane.
const CROSS_BITS: u32 = 32;

/// A ray in canonical order: ascending across the lanes (then along them).
#[derive(Debug, Clone, Copy)]
pub struct Segment {
    start: (i32, i32),
    end: (i32, i32),
}

impl Segment {
    /// The segment between two points (along, across), in any order.
    #[inline]
    pub(super) fn new(a: (i32, i32), b: (i32, i32)) -> Self {
        let ordered = (a.1, a.0) <= (b.1, b.0);
        let (start, end) = if ordered { (a, b) } else { (b, a) };
        Self { start, end }
    }
}

/// Prefix sums of the cells' costs and the next obstacle, per lane.
#[derive(Debug, Clone)]
pub struct LaneTable {
    length: usize,
    /// `prefix[lane * (length + 1) + i]`: cost of the lane's first `i` cells, modulo 2^32.
    prefix: Vec<u32>,
    /// `next[lane * length + i]`: first occupied cell of the lane at or after `i`, `length` if none.
    next: Vec<u16>,
}

impl LaneTable {
    /// Builds the table from `cost(lane, position)`; `None` marks an occupied cell.
    pub(super) fn new(
        lanes: usize,
        length: usize,
        cost: impl Fn(usize, usize) -> Option<u32>,
    ) -> Self {
        let mut prefix = Vec::with_capacity(lanes * (length + 1));
        let mut next = vec![0; lanes * length];
        for lane in 0..lanes {
            let mut sum = 0_u32;
            prefix.push(sum);
            for i in 0..length {
                sum = sum.wrapping_add(cost(lane, i).unwrap_or(0));
                prefix.push(sum);
            }
            let mut obstacle = length as u16;
            for i in (0..length).rev() {
                if cost(lane, i).is_none() {
                    obstacle = i as u16;
                }
                next[lane * length + i] = obstacle;
            }
        }
        Self {
            length,
            prefix,
            next,
        }
    }

    /// Sum over the crossed cells of (cost) × (extent along the lane), with [`POINT_BITS`] more
    /// fractional bits than a cost; `None` if one of the cells is occupied.
    ///
    /// A cell that is only touched in a point or along its lower edge is not crossed.
    #[inline]
    pub(super) fn sum(&self, ray: Segment) -> Option<u64> {
        let (u0, l0) = ray.start;
        let (u1, l1) = ray.end;
        let (from, to) = (widen(u0), widen(u1));
        let first = (l0 >> POINT_BITS) as usize;
        if l0 == l1 {
            return self.run(first, from, to);
        }
        // The lane in which the ray ends exactly on the lower edge is not crossed.
        let last = ((l1 - 1) >> POINT_BITS) as usize;
        if first == last {
            return self.run(first, from, to);
        }
        // Along the lane per lane. |u1 − u0| ≥ l1 − l0 and both have at most 30 bits, so this has at
        // most 62; it is rounded towards 0, as the first crossing is: no crossing lies beyond `to`.
        let one = f64::from(1_u32 << POINT_BITS) * f64::from(1_u32 << (CROSS_BITS - POINT_BITS));
        let slope = (f64::from(u1 - u0) / f64::from(l1 - l0) * one) as i64;
        let ahead = (((first as i64) + 1) << POINT_BITS) - i64::from(l0);
        let mut crossing = from + ahead * slope / (1 << POINT_BITS);

        let mut blocked = self.is_blocked(first, from, crossing);
        let mut total = 0_u64.wrapping_sub(integral(self.lane(first), from));
        // Lower end and length of the run in each lane between the first and the last.
        let (back, length) = (slope.min(0), slope.abs());
        total = total.wrapping_add(self.step(first, crossing));
        for lane in first + 1..last {
            let low = crossing + back;
            blocked |= self.is_occupied(lane, low, low + length);
            crossing += slope;
            total = total.wrapping_add(self.step(lane, crossing));
        }
        blocked |= self.is_blocked(last, crossing, to);
        total = total.wrapping_add(integral(self.lane(last), to));
        (!blocked).then(|| settle(total))
    }

    /// The prefix sums of a lane.
    #[inline]
    fn lane(&self, lane: usize) -> &[u32] {
        &self.prefix[lane * (self.length + 1)..]
    }

    /// Cost up to a position in one lane less the cost up to it in the following lane, modulo 2^48.
    #[inline(always)]
    #[allow(clippy::inline_always)] // Measured: a call here costs 30 % of a clear ray.
    fn step(&self, lane: usize, position: i64) -> u64 {
        let i = (position >> CROSS_BITS) as usize;
        let stride = self.length + 1;
        let start = lane * stride + i;
        let window = &self.prefix[start..start + stride + 2];
        let fraction = (position as u64 & 0xffff_ffff) >> (CROSS_BITS - POINT_BITS);
        let here = window[0].wrapping_sub(window[stride]);
        let there = window[1].wrapping_sub(window[stride + 1]);
        let slope = there.wrapping_sub(here) as i32;
        (u64::from(here) << POINT_BITS)
            .wrapping_add((i64::from(slope) as u64).wrapping_mul(fraction))
    }

    /// Returns `true` if an occupied cell lies in a run of positive length.
    #[inline]
    fn is_occupied(&self, lane: usize, low: i64, high: i64) -> bool {
        let first = (low >> CROSS_BITS) as usize;
        i64::from(self.next[lane * self.length + first]) <= (high - 1) >> CROSS_BITS
    }

    fn run(&self, lane: usize, from: i64, to: i64) -> Option<u64> {
        (!self.is_blocked(lane, from, to)).then(|| settle(self.cost(lane, from, to)))
    }

    /// Returns `true` if a run between two positions along a lane crosses an occupied cell.
    #[inline]
    fn is_blocked(&self, lane: usize, a: i64, b: i64) -> bool {
        self.is_occupied(lane, a.min(b), a.max(b))
    }

    /// Signed cost from one position along a lane to another, modulo 2^48.
    #[inline]
    fn cost(&self, lane: usize, from: i64, to: i64) -> u64 {
        let prefix = self.lane(lane);
        integral(prefix, to).wrapping_sub(integral(prefix, from))
    }
}

/// Cost of a lane up to a position, modulo 2^48.
#[inline]
fn integral(prefix: &[u32], position: i64) -> u64 {
    let i = (position >> CROSS_BITS) as usize;
    let fraction = (position as u64 & 0xffff_ffff) >> (CROSS_BITS - POINT_BITS);
    let cell = prefix[i + 1].wrapping_sub(prefix[i]);
    (u64::from(prefix[i]) << POINT_BITS).wrapping_add(u64::from(cell) * fraction)
}

/// An end's coordinate as a crossing position.
#[inline]
fn widen(point: i32) -> i64 {
    i64::from(point) << (CROSS_BITS - POINT_BITS)
}

/// The magnitude of a sum modulo 2^48 (negative if the ray descends along the lane).
#[inline]
fn settle(total: u64) -> u64 {
    ((total << 16) as i64 >> 16).unsigned_abs()
}
