//! Distance of the path from obstacles and bounds, along the continuous path and not only at its
//! samples.

use nalgebra::{Point2, center};

use crate::contract::Contract;
use crate::findings::Findings;
use crate::piece::Piece;
use crate::region::{EnclosingDisc, GrownObstacle, inside_box};
use crate::tolerances::Tolerances;
use crate::violation::{Excess, Violation};

/// Maximum difference (m) between arc and chord of the piece that comes closest; a larger piece is
/// cut.
const RESOLUTION: f64 = 1e-5;

/// Maximum number of times that a piece is halved. Each time, the difference between arc and chord
/// falls to a quarter.
const MAX_CUTS: u32 = 8;

/// Minimum distance so far (m), exact to within [`RESOLUTION`] or below the true value.
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
pub struct Span {
    /// Time of the start (s).
    pub time: f64,
    /// The motion from there.
    pub piece: Piece,
    /// End (m).
    pub end: Point2<f64>,
    /// Distance (m) of the samples from the motion: a path through them may be nearer by this.
    pub slack: f64,
}

/// The closest approach to the obstacles and the bounds of a contract.
#[derive(Debug)]
pub struct Clearance {
    /// Discs around the obstacles, in a list of their own: they nearly always suffice for the test.
    around: Vec<EnclosingDisc>,
    obstacles: Vec<GrownObstacle>,
    bounds: Option<[f64; 4]>,
    to_obstacle: Least,
    nearest: usize,
    within_bounds: Least,
}

impl Clearance {
    /// Starts without any part of the path.
    pub fn new(contract: &Contract) -> Self {
        let grow = |obstacle| GrownObstacle::new(obstacle, contract.clearance);
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

    /// Minimum signed distance of the path to a grown obstacle (m); infinite without obstacles.
    pub fn to_obstacles(&self) -> f64 {
        self.to_obstacle.distance
    }

    /// Maximum depth in a grown obstacle or outside the bounds (m), 0 if there is none.
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

/// Lowers `least` if the span may come closer, with `distance` as the distance of a straight
/// segment.
///
/// The arc is nowhere closer than its chord less its deviation from it. Where that matters, the span
/// is cut until the deviation does not: a chord across a round obstacle is already inside the arc
/// around it, and subtracting the full deviation would count it twice.
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
