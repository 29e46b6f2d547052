//! A lower bound on the time from a pose to a place.
//!
//! For any direction ψ, the robot must cover the distance D to the goal along ψ. Its progress along ψ is
//! at most V cos(θ − ψ), and at time t its heading θ is no farther than ω t from that of the start, so at
//! least δ − ω t from ψ, where δ is the angle between the heading at the start and ψ. So
//!
//! D ≤ V ∫ max(0, cos(max(0, δ − ω t))) dt over the duration,
//!
//! which bounds the duration from below: the robot turns on the spot until it is across ψ, turns into ψ on
//! an arc, and drives along ψ. With a heading at the goal, the same holds from there back in time. A robot
//! that reverses makes progress by |cos|: δ is the angle to ψ or to its opposite, whichever is nearer. The
//! bound holds for every ψ, and so does the largest of them. In free space it is the time itself wherever
//! the fastest motion is such a sequence with its line along ψ.
//!
//! With a heading at the goal, it also takes at least the time of the fastest Reeds–Shepp word: full speed
//! in either direction is optimal, and turns on the spot gain nothing over arcs forwards and backwards (the
//! set of speeds is convex, so that its ends suffice). All of this holds with obstacles too.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use geometry::math;
use geometry::pose::Pose2;
use nalgebra::{Point2, Vector2};

use crate::words;

/// Number of directions that are tried, and of bisections around the best.
const DIRECTIONS: (u32, u32) = (24, 20);
/// Relative error of the computed times.
const ROUNDING: f64 = 1e-9;

/// Limits of a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speeds {
    /// Maximum speed (m/s), > 0.
    pub v: f64,
    /// Maximum turning rate (rad/s), > 0.
    pub omega: f64,
    /// `true` if it may drive backwards, no faster than forwards.
    pub reverse: bool,
}

/// Heading at the goal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Heading {
    /// Any.
    Free,
    /// This one (rad).
    At(f64),
}

/// A lower bound (s) on the time from a pose to a place (m), with any obstacles.
pub fn least_time(speeds: &Speeds, from: &Pose2, to: Point2<f64>, heading: Heading) -> f64 {
    let offset = to - from.position();
    let along = |psi: f64| along(speeds, from.theta, offset, heading, psi);
    let (count, bisections) = DIRECTIONS;
    let mut step = TAU / f64::from(count);
    let better = |a: (f64, f64), psi: f64| {
        let found = along(psi);
        if found > a.0 { (found, psi) } else { a }
    };
    let bearing = math::atan2(offset.y, offset.x);
    let tried = (0..count).map(|i| bearing + step * f64::from(i));
    let mut best = tried.fold((0.0, bearing), better);
    for _ in 0..bisections {
        step *= 0.5;
        for psi in [best.1 - step, best.1 + step] {
            best = better(best, psi);
        }
    }
    let bound = best.0 * (1.0 - ROUNDING);
    let Heading::At(theta) = heading else {
        return bound;
    };
    let goal = Pose2::new(to.x, to.y, theta);
    let words = words::reeds_shepp(from, &goal, speeds.v / speeds.omega);
    let fastest = words.iter().map(words::Word::cost).min_by(f64::total_cmp);
    let both_ways = fastest.map_or(0.0, |cost| cost * (1.0 - ROUNDING) / speeds.v);
    // The search for the best direction can end at another one, where the place alone takes longer.
    let free = least_time(speeds, from, to, Heading::Free);
    bound.max(both_ways).max(free)
}

/// The bound (s) by the progress along one direction (rad).
fn along(speeds: &Speeds, start: f64, offset: Vector2<f64>, heading: Heading, psi: f64) -> f64 {
    let (sin, cos) = math::sincos(psi);
    let distance = offset.dot(&Vector2::new(cos, sin));
    if distance <= 0.0 {
        return 0.0;
    }
    let away = |theta: f64| {
        let angle = math::angle_difference(psi, theta).abs();
        if speeds.reverse {
            angle.min(PI - angle)
        } else {
            angle
        }
    };
    let Speeds { v, omega, .. } = *speeds;
    let radius = v / omega;
    let first = away(start);
    let from_start = one_end(speeds, distance, first);
    let Heading::At(theta) = heading else {
        return from_start;
    };
    let last = away(theta);
    let lengths = [first, last].map(|angle| radius * math::sin(angle.min(FRAC_PI_2)));
    let left = distance - (lengths[0] + lengths[1]);
    if left >= 0.0 {
        return (first + last) / omega + left / v;
    }
    // The robot turns back before it has turned into ψ: by no less than this angle.
    let nearest = math::asin((-0.5 * left / radius).clamp(0.0, 1.0));
    let both = (first + last - 2.0 * nearest.min(first).min(last)) / omega;
    from_start.max(one_end(speeds, distance, last)).max(both)
}

/// The time (s) in which a robot whose heading differs by this angle (rad) makes this progress (m).
fn one_end(speeds: &Speeds, distance: f64, angle: f64) -> f64 {
    let Speeds { v, omega, .. } = *speeds;
    let radius = v / omega;
    let arc = angle.min(FRAC_PI_2);
    let left = distance - radius * math::sin(arc);
    if left >= 0.0 {
        return angle / omega + left / v;
    }
    let turned = arc - math::asin((-left / radius).clamp(0.0, 1.0));
    (angle - arc + turned) / omega
}
