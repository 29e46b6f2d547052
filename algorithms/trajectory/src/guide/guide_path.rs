//! The initial path of a method among the obstacles, leg by leg.

use geometry::math;
use nalgebra::{Point2, Vector2};
use navigation::tangent_graph::PathLeg;

/// A path of straight legs and arcs.
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    legs: Vec<PathLeg>,
    /// Length of the path up to each leg (m), and the total length.
    along: Vec<f64>,
}

impl Guide {
    /// Creates a path of these legs, each beginning where the last ended; `None` if it has no
    /// length.
    pub fn new(legs: Vec<PathLeg>) -> Option<Self> {
        let mut along = Vec::with_capacity(legs.len() + 1);
        let mut sum = 0.0;
        for leg in &legs {
            along.push(sum);
            sum += leg.length();
        }
        along.push(sum);
        (sum > 0.0).then_some(Self { legs, along })
    }

    /// Creates a path through these points (m); `None` if they coincide.
    pub fn through(points: &[Point2<f64>]) -> Option<Self> {
        let legs = points
            .windows(2)
            .filter(|pair| pair[0] != pair[1])
            .map(|pair| PathLeg::Segment {
                from: pair[0],
                to: pair[1],
            })
            .collect();
        Self::new(legs)
    }

    /// Length (m), > 0.
    pub fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    /// The legs, each with the length of the path before it (m).
    pub fn legs(&self) -> impl Iterator<Item = (f64, &PathLeg)> {
        self.along.iter().copied().zip(&self.legs)
    }

    /// The point after a fraction of the length, 0 at the start and 1 at the end (m).
    pub fn at(&self, part: f64) -> Point2<f64> {
        let (leg, part) = self.find(part);
        leg.at(part)
    }

    /// Unit vector of travel after a fraction of the length.
    pub fn heading(&self, part: f64) -> Vector2<f64> {
        let (leg, part) = self.find(part);
        leg.heading(part)
    }

    /// Direction of travel at the start (rad).
    pub fn start_heading(&self) -> f64 {
        let u = self.heading(0.0);
        math::atan2(u.y, u.x)
    }

    fn find(&self, part: f64) -> (&PathLeg, f64) {
        let s = part.clamp(0.0, 1.0) * self.length();
        let i = self.along.partition_point(|&along| along <= s);
        let i = i.clamp(1, self.legs.len()) - 1;
        let leg = &self.legs[i];
        let length = self.along[i + 1] - self.along[i];
        let within = if length > 0.0 {
            (s - self.along[i]) / length
        } else {
            0.0
        };
        (leg, within.clamp(0.0, 1.0))
    }
}
