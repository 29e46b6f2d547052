//! Parts of trails: the older, the thinner and paler.

use draw::palette;

use super::trace::RunTrace;
use super::trail::{TrailPoint, simplify};

/// Maximum number of points of all trails together.
const MAX_TRAIL_POINTS: usize = 5000;

/// Parts of a trail: their end (fraction of the time), width (px) and opacity.
pub const BANDS: [(f64, f64, f64); 3] = [(0.6, 2.0, 0.40), (0.85, 2.6, 0.65), (1.0, 3.4, 1.0)];

/// Parts of a trail; each begins at the last point of the one before.
pub type Bands = Parts<{ BANDS.len() }>;
/// Parts of a trail by the time since then, the oldest first, as [`palette::IDLENESS`] in reverse.
pub type Ages = Parts<{ palette::IDLENESS.len() }>;
type Parts<const N: usize> = [Vec<TrailPoint>; N];

/// Returns the parts of all trails, simplified for this scale (px/m).
pub fn bands(trace: &RunTrace, scale: f64) -> Vec<Bands> {
    parts(trace, scale, |first, last| {
        BANDS.map(|(part, _, _)| first + part * (last - first))
    })
}

/// Returns the parts of the trails of the robots that sweep, by the time since then; of the others nothing.
pub fn ages(trace: &RunTrace, scale: f64) -> Vec<Ages> {
    let [new, middle, old] = palette::idleness_bounds(trace.time_s);
    let now = trace.time_s;
    let ages = parts(trace, scale, |_, last| {
        [now - old, now - middle, now - new, last.max(now)]
    });
    let sweeps = trace.robots.iter().map(|robot| robot.sweeps.is_some());
    let all = ages.into_iter().zip(sweeps);
    all.map(|(ages, sweeps)| if sweeps { ages } else { Ages::default() })
        .collect()
}

/// Returns the parts of all trails up to times (s), which depend on the times of the first and the last point.
fn parts<const N: usize>(
    trace: &RunTrace,
    scale: f64,
    until_s: impl Fn(f64, f64) -> [f64; N],
) -> Vec<Parts<N>> {
    let robots = trace.robots.iter();
    let trails: Vec<Vec<TrailPoint>> = robots.map(|robot| robot.trail.points()).collect();
    // A third of a pixel is invisible; more only if there is too much to draw.
    let mut tolerance = 0.3 / scale;
    loop {
        let split = |trail: &Vec<TrailPoint>| match (trail.first(), trail.last()) {
            (Some(first), Some(last)) => {
                split(trail, until_s(first.time_s, last.time_s), tolerance)
            }
            _ => [const { Vec::new() }; N],
        };
        let parts: Vec<Parts<N>> = trails.iter().map(split).collect();
        let points: usize = parts.iter().flatten().map(Vec::len).sum();
        if points <= MAX_TRAIL_POINTS {
            return parts;
        }
        tolerance *= 1.5;
    }
}

/// Returns the parts of a trail up to these times (s), each simplified.
fn split<const N: usize>(trail: &[TrailPoint], until_s: [f64; N], tolerance: f64) -> Parts<N> {
    let mut from = 0;
    until_s.map(|until| {
        let to = trail.partition_point(|p| p.time_s <= until).max(from + 1);
        let band = trail.get(from..to.min(trail.len())).unwrap_or_default();
        // The next part begins at the last point of this one.
        from = to.min(trail.len()) - 1;
        simplify(band, tolerance)
    })
}
