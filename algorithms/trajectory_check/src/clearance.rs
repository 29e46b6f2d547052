//! How close the path comes to obstacles and bounds: the continuous path, not its samples.

use nalgebra::{Point2, center};

use crate::contract::Contract;
use crate::findings::Findings;
use crate::piece::Piece;
use crate::region::{Around, Grown, inside_box};
use crate::tolerances::Tolerances;
use crate::violation::{Excess, Violation};

/// A piece that comes closest so far is cut until its arc and its chord differ by no more (m).
const RESOLUTION: f64 = 1e-5;

/// How often a piece is cut in halves at most. Each time, arc and chord differ by a quarter.
const MAX_CUTS: u32 = 8;

/// Least distance so far (m), below it or exact to within [`RESOLUTION`].
#[derive(Debug, Clone, Copy)]
struct Least {
    distance: f64,
    time: f64,
}

impl Least {
    const NONE: Self = Self {
        distance: f64::INFINITY,
        time: 0.0,
    };
}

/// A piece with the end of its chord.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    /// Time of the start (s).
    pub time: f64,
    /// The motion from there.
    pub piece: Piece,
    /// Where it ends (m).
    pub end: Point2<f64>,
    /// How far (m) the samples are off the motion: a path through them may be nearer by so much.
    pub slack: f64,
}

/// The closest approach to the obstacles and the bounds of a contract.
#[derive(Debug)]
pub(crate) struct Clearance {
    /// Discs around the obstacles, apart from them: nearly always they are all that is looked at.
    around: Vec<Around>,
    obstacles: Vec<Grown>,
    bounds: Option<[f64; 4]>,
    to_obstacle: Least,
    nearest: usize,
    within_bounds: Least,
}

impl Clearance {
    /// Nothing of the path seen yet.
    pub fn new(contract: &Contract) -> Self {
        let grow = |obstacle| Grown::new(obstacle, contract.clearance);
        let (around, obstacles) = contract.obstacles.iter().map(grow).unzip();
        Self {
            around,
            obstacles,
            bounds: contract.bounds,
            to_obstacle: Least::NONE,
            nearest: 0,
            within_bounds: Least::NONE,
        }
    }

    /// Takes a span of the path into account.
    pub fn visit(&mut self, span: &Span) {
        if let Some(bounds) = self.bounds {
            let distance = |a, b| inside_box(bounds, a, b);
            lower(&mut self.within_bounds, span, MAX_CUTS, &distance);
        }
        let middle = center(&span.piece.start, &span.end);
        let half = (span.end - middle).norm() + span.piece.deviation() + span.slack;
        for (index, (around, obstacle)) in self.around.iter().zip(&self.obstacles).enumerate() {
            if around.is_farther(middle, half, self.to_obstacle.distance) {
                continue;
            }
            let before = self.to_obstacle.distance;
            let distance = |a, b| obstacle.distance(a, b);
            lower(&mut self.to_obstacle, span, MAX_CUTS, &distance);
            if self.to_obstacle.distance < before {
                self.nearest = index;
            }
        }
    }

    /// Least signed distance of the path to a grown obstacle (m); infinite without obstacles.
    pub fn to_obstacles(&self) -> f64 {
        self.to_obstacle.distance
    }

    /// Greatest depth in a grown obstacle or outside the bounds (m), 0 if there is none.
    pub fn deepest(&self) -> f64 {
        (-self.to_obstacle.distance.min(self.within_bounds.distance)).max(0.0)
    }

    /// Records depths above the tolerance.
    pub fn report(&self, tolerances: &Tolerances, findings: &mut Findings) {
        let obstacle = self.nearest;
        let inside = |excess: Excess| Violation::Penetration { obstacle, excess };
        let Least { distance, time } = self.to_obstacle;
        findings.at_most(inside, time, -distance, tolerances.penetration);
        let Least { distance, time } = self.within_bounds;
        findings.at_most(Violation::Bounds, time, -distance, tolerances.penetration);
    }
}

/// Lowers `least` if the span may come closer than it, by `distance` of a straight segment.
///
/// The arc is nowhere closer than its chord less its deviation from it. Where that matters, the span
/// is cut until the deviation does not: a chord across a round obstacle is inside of the arc around
/// it already, and subtracting the deviation as it is would count it twice.
fn lower(
    least: &mut Least,
    span: &Span,
    cuts: u32,
    distance: &impl Fn(Point2<f64>, Point2<f64>) -> f64,
) {
    let piece = &span.piece;
    let deviation = piece.deviation();
    let bound = distance(piece.start, span.end) - deviation - span.slack;
    if bound >= least.distance {
        return;
    }
    if cuts == 0 || deviation <= RESOLUTION {
        *least = Least {
            distance: bound,
            time: span.time + piece.dt / 2.0,
        };
        return;
    }
    let [first, second] = piece.halves();
    let first = Span {
        piece: first,
        end: second.start,
        ..*span
    };
    let second = Span {
        time: span.time + first.piece.dt,
        piece: second,
        ..*span
    };
    lower(least, &first, cuts - 1, distance);
    lower(least, &second, cuts - 1, distance);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::Obstacle;

    /// A quarter circle of radius 1 m around the origin, from (1, 0), at 1 m/s.
    fn quarter() -> Span {
        let piece = Piece {
            start: Point2::new(1.0, 0.0),
            heading: core::f64::consts::FRAC_PI_2,
            speed: [1.0; 2],
            rate: [1.0; 2],
            dt: core::f64::consts::FRAC_PI_2,
        };
        Span {
            time: 0.0,
            piece,
            end: piece.end(),
            slack: 0.0,
        }
    }

    fn closest(center: [f64; 2], radius: f64) -> f64 {
        let mut contract = Contract::new([0.0; 3], [1.0, 0.0], 1.0, 1.0);
        contract.obstacles = vec![Obstacle::Disc {
            center: Point2::from(center),
            radius,
        }];
        let mut clearance = Clearance::new(&contract);
        clearance.visit(&quarter());
        clearance.to_obstacles()
    }

    #[test]
    fn an_arc_around_a_disc_touches_it_although_its_chord_cuts_it() {
        let distance = closest([0.0, 0.0], 1.0);
        assert!(distance <= 1e-8 && distance > -1e-4, "{distance}");
    }

    #[test]
    fn an_arc_into_a_disc_is_seen_although_its_chord_misses_it() {
        let corner = 0.5_f64.sqrt();
        let distance = closest([corner, corner], 0.1);
        assert!((-0.1001..=-0.1 + 1e-8).contains(&distance), "{distance}");
    }
}
