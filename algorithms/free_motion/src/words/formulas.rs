//! The formulas of Reeds and Shepp, on circles of radius 1: from the origin along the x axis to (x, y)
//! with the heading φ.

use core::f64::consts::{FRAC_PI_2, PI};

use geometry::math;

use super::{Piece, Pieces, word};

fn left(angle: f64) -> Piece {
    (1.0, math::wrap_angle(angle))
}

fn right(angle: f64) -> Piece {
    (-1.0, math::wrap_angle(angle))
}

fn polar(x: f64, y: f64) -> (f64, f64) {
    (math::hypot(x, y), math::atan2(y, x))
}

/// Centre of the goal's circle to the left, relative to that of the start's.
fn to_left(x: f64, y: f64, phi: f64) -> (f64, f64) {
    let (sin, cos) = math::sincos(phi);
    (x - sin, y - 1.0 + cos)
}

/// Centre of the goal's circle to the right, relative to that of the start's to the left.
fn to_right(x: f64, y: f64, phi: f64) -> (f64, f64) {
    let (sin, cos) = math::sincos(phi);
    (x + sin, y - 1.0 - cos)
}

/// (8.1) L⁺S⁺L⁺.
pub fn lsl(x: f64, y: f64, phi: f64) -> Pieces {
    let (xi, eta) = to_left(x, y, phi);
    let (u, t) = polar(xi, eta);
    word([left(t), (0.0, u), left(phi - t)])
}

/// (8.2) L⁺S⁺R⁺.
pub fn lsr(x: f64, y: f64, phi: f64) -> Option<Pieces> {
    let (xi, eta) = to_right(x, y, phi);
    let (distance, angle) = polar(xi, eta);
    let u = (distance * distance - 4.0).max(0.0).sqrt();
    let t = angle + math::atan2(2.0, u);
    (distance >= 2.0).then(|| word([left(t), (0.0, u), right(t - phi)]))
}

/// (8.3) L⁺R⁻L⁺, with (8.4).
pub fn lrl(x: f64, y: f64, phi: f64) -> Option<Pieces> {
    let (xi, eta) = to_left(x, y, phi);
    let (distance, angle) = polar(xi, eta);
    let u = -2.0 * math::asin((0.25 * distance).min(1.0));
    let t = angle + 0.5 * u + PI;
    (distance <= 4.0).then(|| word([left(t), (-1.0, u), left(phi - t + u)]))
}

/// (8.7) L⁺R⁺L⁻R⁻, the middle arcs equal and of opposite directions.
pub fn lrlr_outer(x: f64, y: f64, phi: f64) -> Option<Pieces> {
    let (xi, eta) = to_right(x, y, phi);
    let rho = 0.25 * (2.0 + math::hypot(xi, eta));
    let u = math::acos(rho.min(1.0));
    let (t, v) = ends(u, -u, [xi, eta, phi]);
    (rho <= 1.0).then(|| word([left(t), (-1.0, u), (1.0, -u), right(v)]))
}

/// (8.8) L⁺R⁻L⁻R⁺, the middle arcs equal and of one direction.
pub fn lrlr_inner(x: f64, y: f64, phi: f64) -> Option<Pieces> {
    let (xi, eta) = to_right(x, y, phi);
    let rho = (20.0 - xi * xi - eta * eta) / 16.0;
    let u = -math::acos(rho.clamp(0.0, 1.0));
    let (t, v) = ends(u, u, [xi, eta, phi]);
    (0.0..=1.0)
        .contains(&rho)
        .then(|| word([left(t), (-1.0, u), (1.0, u), right(v)]))
}

/// The outer arcs of (8.7) and (8.8) for the inner ones.
fn ends(u: f64, v: f64, [xi, eta, phi]: [f64; 3]) -> (f64, f64) {
    let delta = u - v;
    let a = math::sin(u) - math::sin(delta);
    let b = math::cos(u) - math::cos(delta) - 1.0;
    let t = math::atan2(eta * a - xi * b, xi * a + eta * b);
    let turned = 2.0 * (math::cos(delta) - math::cos(v) - math::cos(u)) + 3.0 < 0.0;
    let t = if turned { t + PI } else { t };
    (t, t - u + v - phi)
}

/// (8.9) L⁺R⁻S⁻L⁻, the second arc a quarter.
pub fn lrsl(x: f64, y: f64, phi: f64) -> Option<Pieces> {
    let (xi, eta) = to_left(x, y, phi);
    let (distance, angle) = polar(xi, eta);
    let along = (distance * distance - 4.0).max(0.0).sqrt();
    let t = angle + math::atan2(along, -2.0);
    (distance >= 2.0).then(|| {
        word([
            left(t),
            (-1.0, -FRAC_PI_2),
            (0.0, 2.0 - along),
            left(phi - FRAC_PI_2 - t),
        ])
    })
}

/// (8.10) L⁺R⁻S⁻R⁻, the second arc a quarter.
pub fn lrsr(x: f64, y: f64, phi: f64) -> Option<Pieces> {
    let (xi, eta) = to_right(x, y, phi);
    let (distance, t) = polar(-eta, xi);
    (distance >= 2.0).then(|| {
        word([
            left(t),
            (-1.0, -FRAC_PI_2),
            (0.0, 2.0 - distance),
            right(t + FRAC_PI_2 - phi),
        ])
    })
}

/// (8.11) L⁺R⁻S⁻L⁻R⁺, the inner arcs quarters.
pub fn lrslr(x: f64, y: f64, phi: f64) -> Option<Pieces> {
    let (xi, eta) = to_right(x, y, phi);
    let distance = math::hypot(xi, eta);
    let u = 4.0 - (distance * distance - 4.0).max(0.0).sqrt();
    let t = math::atan2((4.0 - u) * xi - 2.0 * eta, -2.0 * xi + (u - 4.0) * eta);
    (distance >= 2.0).then(|| {
        word([
            left(t),
            (-1.0, -FRAC_PI_2),
            (0.0, u),
            (1.0, -FRAC_PI_2),
            right(t - phi),
        ])
    })
}
