//! Conversion of a path to legs.

use core::f64::consts::TAU;

use nalgebra::Point2;

use super::PathLeg;
use super::graph::{self, Graph};
use planner_view::free_space::Arc;

/// Legs shorter than this (m) are left out: they are joints that result from rounding.
const MIN_LEG: f64 = 1e-12;

/// Adds the straight legs through these points.
pub fn straight(points: &[Point2<f64>], path: &mut Vec<PathLeg>) {
    for pair in points.windows(2) {
        if let &[from, to] = pair
            && (to - from).norm() > MIN_LEG
        {
            path.push(PathLeg::Segment { from, to });
        }
    }
}

/// Adds the arc on a track from one position to another.
pub fn arc(graph: &Graph, (track, from): (u32, f64), to: f64, path: &mut Vec<PathLeg>) {
    let site = graph.site(track);
    let angle = graph.arc(track, from, to).unwrap_or(0.0);
    if angle * site.radius > MIN_LEG {
        let turn = graph::turn(track);
        let place = if turn > 0.0 {
            from
        } else {
            (site.width - from).rem_euclid(TAU)
        };
        path.push(PathLeg::Arc(Arc {
            center: site.center,
            radius: site.radius,
            start: site.start_angle + place,
            sweep: turn * angle,
        }));
    }
}
