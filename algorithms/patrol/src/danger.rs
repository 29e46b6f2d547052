//! Danger zones: the threatened parts of a contour (cat-map patrol paper, §5.1, remark (c) and Fig.
//! 8).

use geometry::shape::{Convex, Shape, ShapeError};
use nalgebra::Point2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::contour::{Contour, Segment};

/// Minimum length of stretches of a contour (m), inside or between zones; shorter ones count with
/// their neighbours. An adversary cannot enter and leave within them, and they would make waypoints
/// that coincide.
pub const MIN_STRETCH: f64 = 1e-6;

/// Areas in which a patrol is under threat.
///
/// In TOML a list of shapes, see [`Shape`]: `[{ circle = { center = [5, 5], radius = 2 } }]`. An
/// empty list means everywhere.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct DangerZones(pub Vec<Shape>);

/// A zone without an area.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("`danger_zones[{index}]`: {source}")]
pub struct DangerZoneError {
    /// Index of the zone.
    pub index: usize,
    /// Error of its shape.
    #[source]
    pub source: ShapeError,
}

/// A segment of a contour after a cut at the points of entry to and exit from danger zones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// The segment.
    pub segment: Segment,
    /// Index of the contour's own segment that contains it.
    pub part_of: usize,
    /// `true` if it lies in a danger zone.
    pub threatened: bool,
}

impl DangerZones {
    /// Cuts a contour at the points of entry and exit of the zones; the border of a zone is inside.
    /// Without zones, the whole contour is threatened.
    ///
    /// The stretches are in the order of the segments, and the sum of their lengths is the same.
    ///
    /// # Errors
    /// [`DangerZoneError`] for the first zone without an area.
    pub fn cut(&self, contour: &Contour) -> Result<Vec<Stretch>, DangerZoneError> {
        let zones = self.parts()?;
        let mut stretches = Vec::with_capacity(contour.segments().len());
        for (part_of, segment) in contour.segments().iter().enumerate() {
            let threatened = if self.0.is_empty() {
                vec![(0.0, segment.length)]
            } else {
                inside(segment, &zones)
            };
            cut(segment, part_of, &threatened, &mut stretches);
        }
        Ok(stretches)
    }

    /// Returns `true` if a point (m) lies in a zone or on its border; `true` everywhere without
    /// zones.
    ///
    /// # Errors
    /// [`DangerZoneError`] for the first zone without an area.
    pub fn contains(&self, p: Point2<f64>) -> Result<bool, DangerZoneError> {
        Ok(self.0.is_empty() || self.parts()?.iter().any(|zone| zone.distance(p) <= 0.0))
    }

    /// The convex parts of all zones.
    ///
    /// # Errors
    /// [`DangerZoneError`] for the first zone without an area.
    pub fn parts(&self) -> Result<Vec<Convex>, DangerZoneError> {
        let mut parts = Vec::with_capacity(self.0.len());
        for (index, zone) in self.0.iter().enumerate() {
            let of_zone = zone
                .parts()
                .map_err(|source| DangerZoneError { index, source })?;
            parts.extend(of_zone);
        }
        Ok(parts)
    }
}

/// The parts of a segment inside convex pieces, as distances from its start (m): in order, disjoint
/// and longer than [`MIN_STRETCH`].
fn inside(segment: &Segment, zones: &[Convex]) -> Vec<(f64, f64)> {
    let length = segment.length;
    let mut found: Vec<(f64, f64)> = zones
        .iter()
        .filter_map(|zone| {
            // The exit of a convex piece is the entry from the other end.
            let enter = zone.ray(segment.from, segment.along)?;
            let back = zone.ray(segment.to, -segment.along)?;
            Some((enter, length - back))
        })
        .filter(|(enter, leave)| *enter < length && *leave > 0.0 && enter < leave)
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut merged: Vec<(f64, f64)> = Vec::with_capacity(found.len());
    for (enter, leave) in found {
        match merged.last_mut() {
            Some(last) if enter - last.1 <= MIN_STRETCH => last.1 = last.1.max(leave),
            _ => merged.push((enter, leave)),
        }
    }
    // A gap at an end that is too short goes to the zone; a zone as short goes to the gap.
    for (enter, leave) in &mut merged {
        if *enter <= MIN_STRETCH {
            *enter = 0.0;
        }
        if length - *leave <= MIN_STRETCH {
            *leave = length;
        }
    }
    merged.retain(|(enter, leave)| leave - enter > MIN_STRETCH.min(0.5 * length));
    merged
}

/// Appends the stretches of a segment with these threatened parts.
fn cut(segment: &Segment, part_of: usize, threatened: &[(f64, f64)], out: &mut Vec<Stretch>) {
    let at = |distance: f64| {
        // The ends themselves, bit for bit.
        if distance <= 0.0 {
            segment.from
        } else if distance >= segment.length {
            segment.to
        } else {
            segment.from + segment.along * distance
        }
    };
    let mut push = |from: f64, to: f64, threatened: bool| {
        // A whole segment keeps its numbers unchanged; a part keeps the direction.
        if to > from {
            out.push(Stretch {
                segment: Segment {
                    from: at(from),
                    to: at(to),
                    along: segment.along,
                    length: to - from,
                },
                part_of,
                threatened,
            });
        }
    };
    let mut done = 0.0;
    for &(enter, leave) in threatened {
        push(done, enter, false);
        push(enter, leave, true);
        done = leave;
    }
    push(done, segment.length, false);
}

#[cfg(test)]
mod tests;
