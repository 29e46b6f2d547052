//! Parts of trails: the older, the thinner and paler.

use super::trace::RunTrace;
use super::trail::{TrailPoint, simplify};

/// Maximum number of points of all trails together.
const MAX_TRAIL_POINTS: usize = 5000;

/// Parts of a trail: their end (fraction of the time), width (px) and opacity.
pub(super) const BANDS: [(f64, f64, f64); 3] =
    [(0.6, 2.0, 0.40), (0.85, 2.6, 0.65), (1.0, 3.4, 1.0)];

/// Parts of a trail; each begins at the last point of the one before.
pub(super) type Bands = [Vec<TrailPoint>; BANDS.len()];

/// Returns the parts of all trails, simplified for this scale (px/m).
pub(super) fn bands(trace: &RunTrace, scale: f64) -> Vec<Bands> {
    let robots = trace.robots.iter();
    let trails: Vec<Vec<TrailPoint>> = robots.map(|robot| robot.trail.points()).collect();
    // A third of a pixel is invisible; more only if there is too much to draw.
    let mut tolerance = 0.3 / scale;
    loop {
        let bands: Vec<Bands> = trails.iter().map(|trail| split(trail, tolerance)).collect();
        let points: usize = bands.iter().flatten().map(Vec::len).sum();
        if points <= MAX_TRAIL_POINTS {
            return bands;
        }
        tolerance *= 1.5;
    }
}

/// Returns the parts of a trail, each simplified.
fn split(trail: &[TrailPoint], tolerance: f64) -> Bands {
    let (Some(first), Some(last)) = (trail.first(), trail.last()) else {
        return Default::default();
    };
    let mut from = 0;
    BANDS.map(|(part, _, _)| {
        let until = first.time_s + part * (last.time_s - first.time_s);
        let to = trail.partition_point(|p| p.time_s <= until).max(from + 1);
        let band = trail.get(from..to.min(trail.len())).unwrap_or_default();
        // The next part begins at the last point of this one.
        from = to.min(trail.len()) - 1;
        simplify(band, tolerance)
    })
}
