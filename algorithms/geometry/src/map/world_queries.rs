//! Queries of a world map, answered by its pieces ([`ShapeMap`](super::ShapeMap)).

use nalgebra::{Point2, Vector2};

use super::WorldMap;
use crate::shape::Contact;

impl WorldMap {
    /// Distance (m) from a point to the nearest obstacle or the edge of the map; 0 in an obstacle,
    /// beyond the edge, and for a point that is not finite.
    pub fn distance(&self, p: Point2<f64>) -> f64 {
        self.shapes().distance(p)
    }

    /// As [`ShapeMap::clearance_at_least`](super::ShapeMap::clearance_at_least).
    #[inline]
    pub fn clearance_at_least(&self, p: Point2<f64>) -> f64 {
        self.shapes().clearance_at_least(p)
    }

    /// Returns `true` if a disc of this radius (m) about a point touches no obstacle.
    pub fn is_clear(&self, p: Point2<f64>, radius: f64) -> bool {
        self.shapes().is_clear(p, radius)
    }

    /// As [`ShapeMap::nearest_contact`](super::ShapeMap::nearest_contact).
    pub fn nearest_contact(&self, p: Point2<f64>) -> Contact {
        self.shapes().nearest_contact(p)
    }

    /// As [`ShapeMap::cast_ray`](super::ShapeMap::cast_ray).
    pub fn cast_ray(&self, origin: Point2<f64>, dir: Vector2<f64>, range: f64) -> Option<f64> {
        self.shapes().cast_ray(origin, dir, range)
    }

    /// As [`ShapeMap::line_of_sight`](super::ShapeMap::line_of_sight).
    pub fn line_of_sight(&self, from: Point2<f64>, to: Point2<f64>) -> bool {
        self.shapes().line_of_sight(from, to)
    }

    /// The four sides of the map's edge as surfaces.
    pub fn edge_contacts(&self, p: Point2<f64>) -> [Contact; 4] {
        self.shapes().edge_contacts(p)
    }

    /// As [`ShapeMap::parts_within`](super::ShapeMap::parts_within).
    pub fn parts_within<'a>(
        &'a self,
        p: Point2<f64>,
        reach: f64,
        buffer: &'a mut Vec<u32>,
    ) -> &'a [u32] {
        self.shapes().parts_within(p, reach, buffer)
    }

    /// Radius (m) within which [`Self::parts_within`] needs a single look-up.
    pub fn cheap_reach(&self) -> f64 {
        self.shapes().cheap_reach()
    }
}
