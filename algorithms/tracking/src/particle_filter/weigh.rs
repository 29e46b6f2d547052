//! Weights: likelihood of the sighting, or of no sighting, under each hypothesis.

use geometry::math;
use nalgebra::Point2;

use super::cloud::Stretch;
use crate::fast;
use crate::sighting::Measurement;
use crate::space::Space;
use crate::watch::Watch;

/// A seen opponent's likelihood: Gaussian in x, y and, if measured, in the heading.
#[derive(Debug, Clone, Copy)]
pub struct SeenLikelihood {
    x: f32,
    y: f32,
    /// 1/(2σ²) of the position (1/m²).
    precision: f32,
    heading: f32,
    /// 1/(2σ²) of the heading (1/rad²); 0 if it is not measured.
    heading_precision: f32,
}

impl SeenLikelihood {
    /// Creates it from a measurement and the extra widths (m, rad) of the likelihood before
    /// snapping. A quantity with a total width of zero has no weight.
    pub fn new(m: &Measurement, extra: f64, extra_heading: f64) -> Self {
        let precision = |variance: f64| {
            if variance > 0.0 {
                (0.5 / variance) as f32
            } else {
                0.0
            }
        };
        let (heading, heading_precision) = m.heading.map_or((0.0, 0.0), |(theta, sigma)| {
            (
                theta as f32,
                precision(sigma * sigma + extra_heading * extra_heading),
            )
        });
        Self {
            x: m.position.x as f32,
            y: m.position.y as f32,
            precision: precision(m.sigma * m.sigma + extra * extra),
            heading,
            heading_precision,
        }
    }

    /// Multiplies the weights by the likelihood, at most 1. Validity is looked up in `places`.
    pub fn weigh(&self, particles: &Stretch<'_>, weights: &mut [f32]) {
        let n = weights.len();
        let (x, y) = (&particles.x[..n], &particles.y[..n]);
        for i in 0..n {
            let (dx, dy) = (x[i] - self.x, y[i] - self.y);
            weights[i] *= fast::exp_neg((dx * dx + dy * dy) * self.precision);
        }
        if self.heading_precision > 0.0 {
            let heading = &particles.heading[..n];
            for i in 0..n {
                let d = fast::wrap(heading[i] - self.heading);
                weights[i] *= fast::exp_neg(d * d * self.heading_precision);
            }
        }
    }
}

/// An unseen opponent's likelihood: (1 − V)^exponent, V being the best visibility from any observer.
pub struct UnseenLikelihood<'a> {
    pub space: &'a Space,
    pub watch: &'a Watch,
    /// Number of times that the factor 1 − V applies in this tick; 1 at the paper's tick rate.
    pub exponent: f64,
}

impl UnseenLikelihood<'_> {
    /// Multiplies the weights by the likelihood, 0 for invalid particles.
    pub fn weigh(&self, particles: &Stretch<'_>, weights: &mut [f32]) {
        let points = particles.x.iter().zip(particles.y.iter());
        let field = self.space.field();
        for ((&x, &y), w) in points.zip(weights) {
            let p = Point2::new(f64::from(x), f64::from(y));
            let end = field.end(p);
            *w *= end.map_or(0.0, |end| self.hidden(self.watch.visibility(field, p, end)));
        }
    }

    #[inline]
    fn hidden(&self, visibility: f32) -> f32 {
        let hidden = 1.0 - visibility;
        if visibility == 0.0 || self.exponent == 1.0 {
            hidden
        } else {
            math::pow(f64::from(hidden), self.exponent) as f32
        }
    }
}

/// Sets the weights of particles in obstacles or outside the grid to 0.
pub fn drop_invalid(
    space: &Space,
    particles: &Stretch<'_>,
    weights: &mut [f32],
    places: &mut [u32],
) {
    let places = &mut places[..weights.len()];
    space.locate(particles.x, particles.y, places);
    for (w, &place) in weights.iter_mut().zip(places.iter()) {
        *w *= f32::from(space.valid_at(place));
    }
}

/// Sum and sum of squares of the weights, in a fixed order for every vector width.
pub fn totals(weights: &[f32]) -> (f64, f64) {
    const LANES: usize = 8;
    let (mut sums, mut squares) = ([0.0_f64; LANES], [0.0_f64; LANES]);
    let (chunks, rest) = weights.as_chunks::<LANES>();
    for chunk in chunks {
        for lane in 0..LANES {
            let w = f64::from(chunk[lane]);
            sums[lane] += w;
            squares[lane] += w * w;
        }
    }
    for (lane, &w) in rest.iter().enumerate() {
        sums[lane] += f64::from(w);
        squares[lane] += f64::from(w) * f64::from(w);
    }
    (sums.iter().sum(), squares.iter().sum())
}
