//! Loss of free space by the conversion of obstacles to rectangles.

use geometry::shape::{Aabb, Convex};

/// Minimum number of lines for the measurement of areas.
const LINES: f64 = 1024.0;

/// Free space for the robot's centre that is lost because obstacles became rectangles.
///
/// Measured against the obstacles themselves, grown by the same edge expansion (r on each side);
/// exactly 0 if all of them are axis-aligned rectangles. Integrated over at least 1024 lines, so
/// that the share is exact to about 10⁻⁴.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ConversionLoss {
    /// Lost area (m²), ≥ 0.
    pub area: f64,
    /// The same as a share of the free area without the conversion, from 0 to 1; 1 if none is left.
    pub share: f64,
}

/// Compares pieces and the rectangles that represent them within `free`.
pub fn of_conversion(
    free: &Aabb,
    radius: f64,
    parts: &[Convex],
    rectangles: &[Aabb],
) -> ConversionLoss {
    if parts.iter().all(|part| matches!(part, Convex::Box(_))) {
        return ConversionLoss::default();
    }
    let boxes: Vec<Convex> = rectangles.iter().copied().map(Convex::Box).collect();
    // Between the ends of rectangles, so that their own area is exact.
    let ends = rectangles
        .iter()
        .flat_map(|r| [r.min.y - radius, r.max.y + radius]);
    let mut heights: Vec<f64> = ends
        .filter(|&y| y > free.min.y && y < free.max.y)
        .chain([free.min.y, free.max.y])
        .collect();
    heights.sort_by(f64::total_cmp);
    let thickest = (free.max.y - free.min.y) / LINES;
    let mut intervals = Vec::new();
    let (mut lost, mut open) = (0.0, 0.0);
    for (&low, &high) in heights.iter().zip(heights.iter().skip(1)) {
        let lines = ((high - low) / thickest).ceil();
        let thickness = (high - low) / lines;
        for line in 0..lines as u32 {
            let y = low + (f64::from(line) + 0.5) * thickness;
            let truly = blocked(free, radius, parts, y, &mut intervals);
            let blocked = blocked(free, radius, &boxes, y, &mut intervals);
            // Rectangles contain the obstacles that they represent; a negative difference is
            // rounding.
            lost += (blocked - truly).max(0.0) * thickness;
            open += (free.max.x - free.min.x - truly) * thickness;
        }
    }
    let share = if open > 0.0 { lost / open } else { 0.0 };
    ConversionLoss {
        area: lost,
        share: share.min(1.0),
    }
}

/// Length of a line across `free` that lies in pieces grown by the radius on each side.
fn blocked(
    free: &Aabb,
    radius: f64,
    parts: &[Convex],
    y: f64,
    intervals: &mut Vec<(f64, f64)>,
) -> f64 {
    intervals.clear();
    intervals.extend(parts.iter().filter_map(|part| {
        let (low, high) = part.extent_in_band(1, y - radius, y + radius)?;
        let (low, high) = (
            (low - radius).max(free.min.x),
            (high + radius).min(free.max.x),
        );
        (low < high).then_some((low, high))
    }));
    intervals.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut length, mut reached) = (0.0, f64::NEG_INFINITY);
    for &(low, high) in intervals.iter() {
        length += (high - low.max(reached)).max(0.0);
        reached = reached.max(high);
    }
    length
}
