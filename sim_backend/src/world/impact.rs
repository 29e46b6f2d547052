//! Collision of a robot's disc with an obstacle or another disc, and the remaining velocity.

use nalgebra::{Point2, Vector2};

use geometry::map::WorldMap;

/// Gap (m) that is kept at a contact: far above the rounding of positions, far below a millimetre.
const SKIN: f64 = 1e-7;
/// Gap (m) below which advancement ends.
const HIT: f64 = 1.5 * SKIN;
/// Gap (m) below which bodies touch.
pub const TOUCH: f64 = 2.0 * SKIN;
/// Closing speed, relative to the speed, below which motion counts as along a surface.
const ALONG: f64 = 1e-10;
/// Maximum number of steps of one advancement; after them the robot stops short, which is safe.
const MAX_ADVANCES: usize = 64;

/// A robot with a possible contact in this step.
#[derive(Debug, Clone, Copy)]
pub struct Mover {
    pub robot: usize,
    pub radius: f64,
    pub position: Point2<f64>,
    /// Velocity of its twist (m/s).
    pub desired: Vector2<f64>,
    /// Velocity that its contacts allow (m/s).
    pub velocity: Vector2<f64>,
    /// Distance driven in this step (m).
    pub path: f64,
}

/// Returns `true` if a velocity does not lead into the surface with this normal.
pub fn leads_away(velocity: Vector2<f64>, normal: Vector2<f64>) -> bool {
    velocity.dot(&normal) >= -ALONG * velocity.norm()
}

/// The velocity nearest to the desired one that leads into none of the surfaces: the velocity
/// itself, its part along one of them, or zero.
pub fn slide(desired: Vector2<f64>, normals: &[Vector2<f64>]) -> Vector2<f64> {
    if normals.iter().all(|n| leads_away(desired, *n)) {
        return desired;
    }
    let mut best = Vector2::zeros();
    let mut best_speed = 0.0;
    for normal in normals {
        let along = Vector2::new(-normal.y, normal.x);
        let speed = desired.dot(&along);
        // Against a surface head-on, the part along it is rounding.
        let candidate = along * speed;
        if speed.abs() > best_speed
            && speed.abs() > 1e-9 * desired.norm()
            && normals.iter().all(|n| leads_away(candidate, *n))
        {
            best = candidate;
            best_speed = speed.abs();
        }
    }
    best
}

/// Distance (m) that a mover covers in the unit direction `dir` before it hits an obstacle; `None`
/// if it covers `length`.
///
/// Conservative advancement: from each piece's nearest point, the whole (convex) piece lies behind
/// the line across the normal, so the path to that line is free of it. Along flat walls this takes
/// one step. At corners and discs it is Newton's method on a convex function, which never
/// overshoots.
pub fn sweep(
    map: &WorldMap,
    mover: &Mover,
    dir: Vector2<f64>,
    length: f64,
    buffer: &mut Vec<u32>,
) -> Option<f64> {
    let Mover {
        radius,
        position: start,
        ..
    } = *mover;
    if map.clearance_at_least(start) >= radius + length + SKIN {
        return None;
    }
    let reach = map
        .cheap_reach()
        .max(radius + TOUCH + 0.5 * map.cheap_reach());
    let stride = reach - radius - TOUCH;
    let mut done = 0.0;
    while done < length {
        let piece_start = start + dir * done;
        let piece = (length - done).min(stride);
        let parts = map.parts_within(piece_start, reach, buffer);
        let mut moved = 0.0;
        let mut complete = false;
        for _ in 0..MAX_ADVANCES {
            let p = piece_start + dir * moved;
            let mut advance = piece - moved;
            let surfaces = parts.iter().map(|&i| map.parts()[i as usize].contact(p));
            for contact in surfaces.chain(map.edge_contacts(p)) {
                let closing = -dir.dot(&contact.normal);
                if closing <= ALONG {
                    continue;
                }
                let gap = contact.distance - radius;
                if gap <= HIT {
                    return Some(done + moved);
                }
                advance = advance.min((gap - SKIN) / closing);
            }
            if advance >= piece - moved {
                complete = true;
                break;
            }
            moved += advance;
        }
        if !complete {
            return Some(done + moved);
        }
        done += piece;
    }
    None
}

/// Time (s) until two movers' discs come within the skin of each other at their current velocities;
/// infinite if they do not, or if they touch already without closing.
pub fn time_to_impact(a: &Mover, b: &Mover) -> f64 {
    let (offset, velocity) = (a.position - b.position, a.velocity - b.velocity);
    let closing = -offset.dot(&velocity);
    let speed_squared = velocity.norm_squared();
    let radii = a.radius + b.radius;
    if closing <= ALONG * (speed_squared * offset.norm_squared()).sqrt() {
        return f64::INFINITY;
    }
    if offset.norm_squared() <= (radii + HIT) * (radii + HIT) {
        return 0.0;
    }
    let gap = offset.norm_squared() - (radii + SKIN) * (radii + SKIN);
    let discriminant = closing * closing - speed_squared * gap;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    (gap / (closing + discriminant.sqrt())).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sliding_keeps_the_part_along_the_wall() {
        let up = Vector2::y();
        let down_right = Vector2::new(1.0, -1.0);
        assert_eq!(slide(down_right, &[up]), Vector2::new(1.0, 0.0));
        assert_eq!(slide(-down_right, &[up]), -down_right);
        // In a corner the velocity is zero.
        assert_eq!(slide(down_right, &[up, -Vector2::x()]), Vector2::zeros());
        // Head-on the velocity is zero, without rounding errors.
        assert_eq!(slide(Vector2::new(1e-17, -1.0), &[up]), Vector2::zeros());
    }

    #[test]
    fn discs_meet_when_their_gap_closes() {
        let mover = |x: f64, v: f64| Mover {
            robot: 0,
            radius: 0.5,
            position: Point2::new(x, 0.0),
            desired: Vector2::zeros(),
            velocity: Vector2::new(v, 0.0),
            path: 0.0,
        };
        let time = time_to_impact(&mover(0.0, 2.0), &mover(4.0, -1.0));
        assert!((time - 1.0).abs() < 1e-6);
        assert_eq!(
            time_to_impact(&mover(0.0, 1.0), &mover(4.0, 1.0)),
            f64::INFINITY
        );
        assert_eq!(
            time_to_impact(&mover(0.0, -1.0), &mover(4.0, 1.0)),
            f64::INFINITY
        );
    }
}
