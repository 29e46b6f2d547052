//! Remarks on a patrol before it starts: parts without protection, and waypoints
//! where the robot does not fit.

use nalgebra::Point2;
use thiserror::Error;

use crate::alpha::LAPS;
use crate::awg::Awg;
use crate::danger::{DangerZones, Stretch};
use crate::mission::Mission;
use crate::room::Room;

/// A defect of a patrol that does not prevent it.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Remark {
    /// A zone that protects nothing.
    #[error("`danger_zones[{index}]` touches no part of the contour: move one of the two")]
    ZoneApart {
        /// Index of the zone.
        index: usize,
    },
    /// A zone whose part of the contour gets no additional waypoint.
    #[error(
        "`danger_zones[{index}]` holds {length:.3} m of the contour, too little for an additional \
         waypoint: enlarge it, or give `t_max` more time"
    )]
    ZoneTooShort {
        /// Index of the zone.
        index: usize,
        /// Length of the contour in it (m).
        length: f64,
    },
    /// A patrol without a zig-zag.
    #[error(
        "the patrol is unprotected: no part of the contour gets an additional waypoint{}",
        if *.zones { "" } else { "; give `t_max` more seconds than the contour has segments" }
    )]
    Unprotected {
        /// `true` if there are danger zones.
        zones: bool,
    },
    /// Waypoints where the robot does not fit.
    #[error(
        "in the first {laps} laps the robot does not fit at {} of {all} waypoints ({outside} beyond \
         the edge of the map or too near it, {blocked} in obstacles or too near them), the first of \
         them number {number} at ({:.3}, {:.3}): it leaves them out if it cannot reach them; give a \
         smaller `alpha` or move the contour",
        .outside + .blocked, .at.x, .at.y
    )]
    Misfits {
        /// Number of laps.
        laps: u32,
        /// Number of waypoints beyond the edge of the map, or nearer to it than the robot's radius.
        outside: u64,
        /// Number of the others in obstacles, or nearer to one than the robot's radius.
        blocked: u64,
        /// Number of all waypoints.
        all: u64,
        /// Number of the first one.
        number: u64,
        /// Its position (m).
        at: Point2<f64>,
    },
}

/// Returns the remarks about a patrol with a zig-zag in a map; `room` has all obstacles of the map,
/// known to the robot or not.
pub fn of_zig_zag(mission: &Mission, room: &Room<'_>) -> Vec<Remark> {
    let mut remarks = of_zones(mission, |inside| {
        inside
            .iter()
            .any(|stretch| has_waypoints(&mission.awg, stretch))
    });
    if mission.awg.steps_per_lap() == 0 {
        let zones = !mission.danger_zones.0.is_empty();
        remarks.push(Remark::Unprotected { zones });
    }
    remarks.extend(of_waypoints(mission, room));
    remarks
}

/// Returns the remarks about a patrol along its contour, protected without waypoints.
pub fn of_contour(mission: &Mission) -> Vec<Remark> {
    of_zones(mission, |_| true)
}

/// Returns the remarks about the zones that do not protect their parts of the contour.
fn of_zones(mission: &Mission, protects: impl Fn(&[Stretch]) -> bool) -> Vec<Remark> {
    let mut remarks = Vec::new();
    for (index, zone) in mission.danger_zones.0.iter().enumerate() {
        let alone = DangerZones(vec![zone.clone()]);
        // A zone without an area has been refused.
        let mut inside = alone.cut(&mission.contour).unwrap_or_default();
        inside.retain(|stretch| stretch.threatened);
        if inside.is_empty() {
            remarks.push(Remark::ZoneApart { index });
        } else if !protects(&inside) {
            let length = inside.iter().map(|stretch| stretch.segment.length).sum();
            remarks.push(Remark::ZoneTooShort { index, length });
        }
    }
    remarks
}

/// Returns `true` if the leg with the middle of a stretch has additional waypoints.
fn has_waypoints(awg: &Awg, stretch: &Stretch) -> bool {
    let segment = &stretch.segment;
    let middle = nalgebra::center(&segment.from, &segment.to);
    awg.legs(0)
        .iter()
        .filter(|leg| leg.stretch.part_of == stretch.part_of)
        .find(|leg| {
            let whole = &leg.stretch.segment;
            let along = (middle - whole.from).dot(&whole.along);
            (0.0..=whole.length).contains(&along)
        })
        .is_some_and(|leg| leg.inserted > 0)
}

/// Returns the remark about the waypoints of the first laps where the robot does not fit.
fn of_waypoints(mission: &Mission, room: &Room<'_>) -> Option<Remark> {
    let awg = &mission.awg;
    // An invalid key has been refused.
    let mut source = mission.key.source().ok()?;
    let (mut outside, mut blocked, mut first) = (0, 0, None);
    let mut waypoints = Vec::new();
    for lap in 0..LAPS {
        waypoints.clear();
        awg.lap_into(lap, &mut source, &mut waypoints);
        for waypoint in waypoints.iter().filter(|w| !room.fits(w.point)) {
            if room.is_inside(waypoint.point) {
                blocked += 1;
            } else {
                outside += 1;
            }
            first = first.or(Some(*waypoint));
        }
    }
    let all = u64::from(LAPS) * awg.waypoints_per_lap();
    first.map(|waypoint| Remark::Misfits {
        laps: LAPS,
        outside,
        blocked,
        all,
        number: waypoint.number,
        at: waypoint.point,
    })
}

#[cfg(test)]
mod tests;
