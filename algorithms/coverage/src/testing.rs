//! The empty workplace of the coverage papers, and paths driven over it.

use geometry::shape::Aabb;
use metrics::coverage::{CellGrid, SweptCells};
use nalgebra::Point2;

use crate::decomposition::Decomposition;
use crate::goal::GoalSource;
use crate::workplace::Workplace;

/// 10 m × 10 m for a robot of 0.1 m, without obstacles.
pub(crate) fn empty() -> (Workplace, Decomposition) {
    let bounds = Aabb {
        min: Point2::origin(),
        max: Point2::new(10.0, 10.0),
    };
    let workplace = Workplace::new(bounds, 0.1, &[], 0.01).unwrap();
    let parts = Decomposition::new(&workplace).unwrap();
    (workplace, parts)
}

/// Disc coverage after each of the lengths (m), in ascending order.
pub(crate) fn disc_coverage(
    workplace: &Workplace,
    planner: &mut dyn GoalSource,
    start: Point2<f64>,
    lengths: &[f64],
) -> Vec<f64> {
    let grid = CellGrid::new(&workplace.domain().unwrap(), 0.1).unwrap();
    let mut swept = SweptCells::new(grid, workplace.radius());
    let (mut from, mut length) = (start, 0.0);
    swept.sweep(from, from);
    let mut rates = Vec::new();
    while rates.len() < lengths.len() {
        let Some(goal) = planner.next_goal(from) else {
            rates.resize(lengths.len(), swept.rate());
            break;
        };
        let to = goal.waypoint.point;
        let leg = (to - from).norm();
        while let Some(&mark) = lengths.get(rates.len())
            && mark <= length + leg
        {
            let mut there = swept.clone();
            there.sweep(from, from + (to - from) * ((mark - length) / leg));
            rates.push(there.rate());
        }
        swept.sweep(from, to);
        length += leg;
        from = to;
    }
    rates
}

/// Means of the disc coverage at each length over `keys` planners, by number.
pub(crate) fn mean_coverage(
    keys: u8,
    lengths: &[f64],
    mut planner: impl FnMut(u8, &Workplace, &Decomposition) -> (Box<dyn GoalSource>, Point2<f64>),
) -> Vec<f64> {
    let (workplace, parts) = empty();
    let mut sums = vec![0.0; lengths.len()];
    for key in 0..keys {
        let (mut planner, start) = planner(key, &workplace, &parts);
        let rates = disc_coverage(&workplace, &mut *planner, start, lengths);
        for (sum, rate) in sums.iter_mut().zip(rates) {
            *sum += rate / f64::from(keys);
        }
    }
    sums
}
