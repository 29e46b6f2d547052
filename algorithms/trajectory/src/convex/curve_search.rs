//! Curve search by sequential convex programming.
//!
//! Each program minimises the energy ½∫|r'|² dτ, whose minimum over all curves is the shortest path
//! at constant speed. Its constraints are half-planes: at samples of τ near an obstacle, the curve
//! stays behind the line that touches the grown obstacle where the last curve was nearest to it.
//! Obstacles are convex, so the half-planes keep the curve out of all of them. Where positions are
//! linear in the variables, every solution of a program is free at its samples, and no trust region
//! is needed. Between samples the curve may sag into a round obstacle by h²/8R; a margin of that
//! size is kept.

use geometry::shape::{Contact, Convex};
use nalgebra::{Point2, Vector2};

use crate::convex::effort::Effort;
use crate::convex::obstacle_planes::{HalfPlane, NO_DEPTH, surface};
use crate::convex::quadratic_program::QuadraticProgram;
use crate::convex::scaling::{Scaling, UNITS};
use crate::guide::Guide;
use crate::obstacle_field::ObstacleField;
use curves::{Curve, Row};

/// Cost per unit of penetration of an obstacle.
const SLACK_COST: f64 = 10.0;
/// Maximum of this cost.
const MAX_SLACK_COST: f64 = 1e5;
/// Margin in addition to the sag (m).
const SAG_TOLERANCE: f64 = 3e-5;
/// Maximum sag (m) between samples: at first, and once the approximate curve is known.
const SAG: [f64; 2] = [5e-4, 1e-4];
/// Minimum distance of samples (m): at first, and once the approximate curve is known.
const MIN_SPACING: [f64; 2] = [0.01, 0.006];
/// Maximum distance of samples (m).
const MAX_SPACING: f64 = 0.04;
/// Penetration of a grown obstacle, as a fraction of its size, above which the nearest side may be
/// the wrong one.
const DEEP_PENETRATION: f64 = 0.15;
/// Growth of the margin per distance from an end of the path.
const GROWTH: f64 = 0.05;
/// Distance (m) from a grown obstacle within which its half-planes apply: at first, and once the
/// approximate curve is known.
const REACH: [f64; 2] = [0.15, 0.01];
/// Distance (m) from the edge within which its half-planes apply.
const EDGE_REACH: f64 = 0.2;
/// Relative change of the cost that ends the iteration.
const CONVERGED: f64 = 1e-4;
/// Maximum number of programs of one iteration.
const MAX_PROGRAMS: u32 = 25;
/// Minimum speed at the ends as a fraction of the mean speed, so that the curve has a direction
/// there.
const MIN_SPEED: f64 = 0.005;

/// A search for a curve.
pub struct CurveSearch<'a> {
    /// The obstacle field.
    pub obstacle_field: &'a ObstacleField,
    /// Guide path.
    pub guide: &'a Guide,
    /// The coordinates.
    pub frame: Scaling,
    /// The curves.
    pub curve: &'a dyn Curve,
    /// Additional margin of the path per obstacle (m).
    pub margins: Vec<f64>,
    /// Lower bound on the length of all curves (m).
    pub shortest: f64,
    /// A path known to be near the curve, if there is one.
    pub near: Option<&'a Guide>,
    /// The only values of τ at which obstacles are tested; `None` for all.
    pub only_at: Option<Vec<f64>>,
    effort: &'a Effort,
    slack_cost: f64,
}

/// A half-plane at a sample: the curve stays ahead of a line.
struct LineConstraint {
    at: f64,
    plane: HalfPlane,
    /// The obstacle, if penetration at a cost is allowed.
    obstacle: Option<usize>,
}

impl<'a> CurveSearch<'a> {
    /// Creates a search whose work counts for `effort`.
    pub fn new(
        obstacle_field: &'a ObstacleField,
        guide: &'a Guide,
        frame: Scaling,
        curve: &'a dyn Curve,
        effort: &'a Effort,
    ) -> Self {
        Self {
            obstacle_field,
            guide,
            frame,
            curve,
            margins: vec![0.0; obstacle_field.obstacles.len()],
            shortest: guide.length(),
            near: None,
            only_at: None,
            effort,
            slack_cost: SLACK_COST,
        }
    }

    /// Iterates from a curve (`None`: from the guide) until the cost converges, or the curve's
    /// length exceeds the shortest by less than this share; `None` if a program has no solution.
    /// `stop` ends the search early with the current curve.
    pub fn run(
        &mut self,
        from: Option<Vec<f64>>,
        enough: f64,
        stop: &mut dyn FnMut() -> bool,
    ) -> Option<Vec<f64>> {
        let mut z = from;
        let mut last_cost = z.as_deref().map_or(f64::INFINITY, |z| self.energy(z));
        for round in 0..MAX_PROGRAMS {
            let start = z
                .clone()
                .unwrap_or_else(|| vec![0.0; self.curve.variables()]);
            let known = z.is_some();
            if round > 0 && stop() {
                return z;
            }
            let holds = self.holds(z.as_deref());
            let (program, obstacles) = self.program(&start, &holds, known);
            let solution = program.solve(self.effort)?;
            let variables = self.curve.variables();
            let depth = solution[variables..]
                .iter()
                .fold(0.0, |m: f64, s| m.max(*s));
            let next = solution[..variables].to_vec();
            let energy = self.energy(&next);
            let cost = energy
                + self.slack_cost
                    * solution[variables..]
                        .iter()
                        .map(|s| s.max(0.0))
                        .sum::<f64>();
            z = Some(next);
            let clean = depth * self.frame.unit() <= NO_DEPTH;
            // length² ≤ ∫|r'|² (Cauchy–Schwarz).
            let most = (2.0 * energy * UNITS).sqrt() * self.frame.unit();
            if clean && self.curve.is_linear() && most <= self.shortest * (1.0 + enough) {
                break;
            }
            if (last_cost - cost).abs() <= CONVERGED * cost {
                if clean || obstacles == 0 || self.slack_cost >= MAX_SLACK_COST {
                    break;
                }
                self.slack_cost *= 10.0;
            }
            last_cost = cost;
        }
        z
    }

    /// ½∫|r'|² (units).
    fn energy(&self, z: &[f64]) -> f64 {
        let mut row = Row::default();
        let mut sum = 0.0;
        self.quadrature(|at, weight| {
            self.curve.row(at, 1, z, &mut row);
            sum += 0.5 * weight * row.value.norm_squared();
        });
        sum / UNITS
    }

    /// Gauss points between the breaks.
    fn quadrature(&self, mut visit: impl FnMut(f64, f64)) {
        const NODES: [(f64, f64); 3] = [
            (-0.774_596_669_241_483_4, 5.0 / 9.0),
            (0.0, 8.0 / 9.0),
            (0.774_596_669_241_483_4, 5.0 / 9.0),
        ];
        // A curve that is not polynomial between breaks needs more points. Three points integrate
        // squares of velocities of degree 2 at most: a higher degree with few breaks could otherwise
        // oscillate between them at no cost.
        let fine = if self.curve.is_linear() && self.curve.degree() <= 3 {
            1.0
        } else {
            1.0 / 24.0
        };
        for pair in self.curve.breaks().windows(2) {
            let width = pair[1] - pair[0];
            let parts = (width / fine).ceil().max(1.0);
            let half = 0.5 * width / parts;
            for i in 0..parts as usize {
                let middle = pair[0] + half * (2 * i + 1) as f64;
                for (x, w) in NODES {
                    visit(middle + half * x, half * w);
                }
            }
        }
    }

    /// The half-planes for the curve, or, before there is a curve, for the guide or the path known
    /// to be near.
    fn holds(&self, z: Option<&[f64]>) -> Vec<LineConstraint> {
        let length = self.guide.length();
        let known = usize::from(z.is_some() || self.near.is_some());
        let mut holds = Vec::new();
        let mut row = Row::default();
        let mut place = |at: f64| match z {
            Some(z) => {
                self.curve.row(at, 0, z, &mut row);
                self.frame.outward(row.value)
            }
            None => self.near.unwrap_or(self.guide).at(at),
        };
        // Positions on a coarse grid select the relevant obstacles for each stretch.
        let count = (length / MAX_SPACING).ceil().max(8.0) as usize;
        let grid: Vec<Point2<f64>> = (0..=count)
            .map(|i| place(i as f64 / count as f64))
            .collect();
        let steps = grid.windows(2).map(|p| (p[1] - p[0]).norm());
        let step = steps.fold(0.0, f64::max);
        let clearance = self.obstacle_field.clearance;
        for (index, obstacle) in self.obstacle_field.obstacles.iter().enumerate() {
            if let Some(places) = &self.only_at {
                for &at in places {
                    holds.push(self.hold(index, at, place(at), 0.0));
                }
                continue;
            }
            let radius = match obstacle {
                Convex::Disc { radius, .. } => radius + clearance,
                _ => clearance,
            };
            let spacing = (8.0 * SAG[known] * radius / 1.1)
                .sqrt()
                .clamp(MIN_SPACING[known], MAX_SPACING);
            let sag = 1.1 * spacing * spacing / (8.0 * radius);
            let margin = SAG_TOLERANCE + sag.min(SAG[0]) + self.margins[index];
            let parts = (length / count as f64 / spacing).ceil().max(1.0) as usize;
            for (i, p) in grid.iter().enumerate().take(count) {
                if obstacle.distance(*p) - clearance > REACH[known] + step {
                    continue;
                }
                for part in usize::from(i == 0)..parts {
                    let at = (i as f64 + part as f64 / parts as f64) / count as f64;
                    let p = if part == 0 { *p } else { place(at) };
                    if obstacle.distance(p) - clearance <= REACH[known] {
                        holds.push(self.hold(index, at, p, margin));
                    }
                }
            }
        }
        self.hold_in_bounds(&grid, &mut holds);
        holds
    }

    /// The half-plane that keeps the point `p` of the curve at a margin (m) from an obstacle.
    fn hold(&self, index: usize, at: f64, p: Point2<f64>, margin: f64) -> LineConstraint {
        let obstacle = &self.obstacle_field.obstacles[index];
        let clearance = self.obstacle_field.clearance;
        let (p, contact) = self.outside(obstacle, p, at);
        let surface = surface(p, &contact);
        // The ends may lie on the obstacle: the margin grows with the distance from them.
        let near = at.min(1.0 - at);
        let end = self.guide.at(if at < 0.5 { 0.0 } else { 1.0 });
        let height = (end - surface).dot(&contact.normal) - clearance;
        let most = height.max(0.0) + GROWTH * near * self.guide.length();
        let grown = clearance + margin.min(most);
        LineConstraint {
            at,
            plane: HalfPlane::ahead_of(surface, contact.normal, grown, &self.frame),
            obstacle: Some(index),
        }
    }

    /// The nearest side of an obstacle. For a point deep inside it may be the wrong one; then the
    /// side on which the guide passes.
    fn outside(&self, obstacle: &Convex, p: Point2<f64>, at: f64) -> (Point2<f64>, Contact) {
        let contact = obstacle.contact(p);
        let size = match obstacle {
            Convex::Disc { radius, .. } => *radius + self.obstacle_field.clearance,
            other => {
                let around = other.aabb();
                0.5 * (around.max - around.min).norm() + self.obstacle_field.clearance
            }
        };
        if contact.distance - self.obstacle_field.clearance > -DEEP_PENETRATION * size {
            return (p, contact);
        }
        let guide = self.guide.at(at);
        (guide, obstacle.contact(guide))
    }

    fn hold_in_bounds(&self, grid: &[Point2<f64>], holds: &mut Vec<LineConstraint>) {
        let bounds = &self.obstacle_field.bounds;
        let (min, max) = (self.frame.inward(bounds.min), self.frame.inward(bounds.max));
        let count = grid.len() - 1;
        for (i, p) in grid.iter().enumerate().take(count).skip(1) {
            let at = i as f64 / count as f64;
            let sides = [
                (p.x - bounds.min.x, Vector2::x(), min.x),
                (p.y - bounds.min.y, Vector2::y(), min.y),
                (bounds.max.x - p.x, -Vector2::x(), -max.x),
                (bounds.max.y - p.y, -Vector2::y(), -max.y),
            ];
            for (distance, normal, line) in sides {
                if distance < EDGE_REACH {
                    holds.push(LineConstraint {
                        at,
                        plane: HalfPlane { normal, line },
                        obstacle: None,
                    });
                }
            }
        }
    }

    /// The program around a curve; the variables after the curve's are the penetrations of
    /// obstacles. Also returns the number of these.
    fn program(
        &self,
        z: &[f64],
        holds: &[LineConstraint],
        known: bool,
    ) -> (QuadraticProgram, usize) {
        let variables = self.curve.variables();
        let mut slack_of = vec![None; self.obstacle_field.obstacles.len()];
        let mut slacks = 0;
        for hold in holds {
            if let Some(index) = hold.obstacle
                && slack_of[index].is_none()
            {
                slack_of[index] = Some(variables + slacks);
                slacks += 1;
            }
        }
        let mut program = QuadraticProgram::new(variables + slacks);
        let mut row = Row::default();
        self.quadrature(|at, weight| {
            self.curve.row(at, 1, z, &mut row);
            let constant = row.constant(z);
            let terms = merged(&mut row.terms);
            let weight = weight / UNITS;
            for (i, (var, a)) in terms.iter().enumerate() {
                program.add_linear(*var, weight * a.dot(&constant));
                for (other, b) in &terms[i..] {
                    let value = a.dot(b);
                    if value != 0.0 {
                        program.add_quadratic(*var, *other, weight * value);
                    }
                }
            }
        });
        for (var, cost) in self.curve.own_costs() {
            program.add_quadratic(var, var, cost / UNITS);
        }
        for slack in variables..variables + slacks {
            program.add_linear(slack, self.slack_cost);
            program.at_most([(slack, -1.0)], 0.0);
        }
        for var in [self.curve.start_speed(), self.curve.goal_speed()]
            .into_iter()
            .flatten()
        {
            program.at_most([(var, -1.0)], -MIN_SPEED * UNITS);
        }
        if known {
            for (var, most) in self.curve.step_bounds() {
                program.at_most([(var, 1.0)], z[var] + most);
                program.at_most([(var, -1.0)], most - z[var]);
            }
        }
        for hold in holds {
            self.curve.row(hold.at, 0, z, &mut row);
            let constant = row.constant(z).dot(&hold.plane.normal);
            let terms = merged(&mut row.terms);
            let slack = hold
                .obstacle
                .and_then(|index| slack_of[index])
                .map(|slack| (slack, -1.0));
            let terms = terms
                .iter()
                .map(|(var, term)| (*var, -term.dot(&hold.plane.normal)))
                .filter(|(_, c)| *c != 0.0)
                .chain(slack);
            program.at_most(terms, constant - hold.plane.line);
        }
        (program, slacks)
    }
}

/// Merges the terms so that every variable occurs once, in order.
fn merged(terms: &mut Vec<(usize, Vector2<f64>)>) -> &[(usize, Vector2<f64>)] {
    terms.sort_by_key(|(var, _)| *var);
    terms.dedup_by(|b, a| {
        let same = a.0 == b.0;
        if same {
            a.1 += b.1;
        }
        same
    });
    terms
}
