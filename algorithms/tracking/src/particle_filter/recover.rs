//! New beliefs: around a known pose, around a measurement, over the reachable space, or over the
//! whole map.

use nalgebra::Point2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::cloud::Cloud;
use crate::sighting::{Measurement, gaussian_pair};
use crate::space::Space;
use crate::watch::Watch;

/// Attempts per particle to draw a valid place before the last one is taken.
const ATTEMPTS: usize = 16;

/// Ranges from which velocities are drawn: minimum and maximum v (m/s), maximum |ω| (rad/s).
pub type Velocities = (f32, f32, f32);

/// Draws all headings and velocities uniformly.
fn draw_motion(cloud: &mut Cloud, (low, high, turn): Velocities, rng: &mut ChaCha8Rng) {
    for i in 0..cloud.len() {
        cloud.heading[i] = core::f32::consts::PI * (2.0 * rng.random::<f32>() - 1.0);
        cloud.v[i] = low + (high - low) * rng.random::<f32>();
        cloud.omega[i] = turn * (2.0 * rng.random::<f32>() - 1.0);
    }
}

/// Redraws the belief around a measurement: positions Gaussian within free space, headings as
/// measured or uniform, velocities uniform.
pub fn around_measurement(
    cloud: &mut Cloud,
    space: &Space,
    m: &Measurement,
    velocities: Velocities,
    rng: &mut ChaCha8Rng,
) {
    draw_motion(cloud, velocities, rng);
    for i in 0..cloud.len() {
        let mut p = m.position;
        for _ in 0..ATTEMPTS {
            let (nx, ny) = gaussian_pair(rng);
            p = Point2::new(m.position.x + m.sigma * nx, m.position.y + m.sigma * ny);
            if space.is_valid(p) {
                break;
            }
        }
        cloud.x[i] = p.x as f32;
        cloud.y[i] = p.y as f32;
        if let Some((theta, sigma)) = m.heading {
            let noise = if sigma > 0.0 {
                sigma * gaussian_pair(rng).0
            } else {
                0.0
            };
            cloud.heading[i] = crate::fast::wrap((theta + noise) as f32);
        }
    }
}

/// Redraws the belief uniformly over free space that no observer sees well (a place is accepted
/// with probability 1 − V): within `reach` = (centre, radius (m)) if any of that is free, else over
/// the whole map. Headings and velocities are uniform.
///
/// A map without free cells leaves the positions unchanged. `candidates` is working memory.
pub fn over_unseen(
    cloud: &mut Cloud,
    space: &Space,
    watch: &Watch,
    reach: Option<(Point2<f64>, f64)>,
    velocities: Velocities,
    candidates: &mut Vec<u32>,
    rng: &mut ChaCha8Rng,
) {
    draw_motion(cloud, velocities, rng);
    candidates.clear();
    if let Some((centre, radius)) = reach {
        let near = |&cell: &u32| (space.point_in(cell, 0.5, 0.5) - centre).norm() <= radius;
        candidates.extend(space.free_cells().iter().copied().filter(near));
    }
    let cells = if candidates.is_empty() {
        space.free_cells()
    } else {
        candidates.as_slice()
    };
    if cells.is_empty() {
        return;
    }
    let field = space.field();
    for i in 0..cloud.len() {
        for _ in 0..ATTEMPTS {
            let cell = cells[rng.random_range(0..cells.len())];
            let p = space.point_in(cell, rng.random::<f64>(), rng.random::<f64>());
            (cloud.x[i], cloud.y[i]) = (p.x as f32, p.y as f32);
            let seen = field
                .end(p)
                .map_or(1.0, |end| watch.visibility(field, p, end));
            if rng.random::<f32>() >= seen {
                break;
            }
        }
    }
}
