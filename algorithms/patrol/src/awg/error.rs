//! Errors of a zig-zag.

use thiserror::Error;

use super::MAX_T_MAX;
use crate::danger::DangerZoneError;

/// Reason why a zig-zag is impossible, with the remedy.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum AwgError {
    /// An invalid time.
    #[error("`t_max` is {value}: expected a number above 0 and of at most {MAX_T_MAX} (s)")]
    TMax {
        /// Actual time (s).
        value: f64,
    },
    /// An invalid width.
    #[error(
        "`alpha` is {value}: expected a finite number above 0 (m); omit it for an automatic choice"
    )]
    Alpha {
        /// Actual width (m).
        value: f64,
    },
    /// A clock that stands still or is too slow.
    #[error("the tempo is {value}: expected a number above 0 and of at most 1")]
    Tempo {
        /// Actual tempo.
        value: f64,
    },
    /// A contour too short, or too long, for its time, so that the speed is not a number.
    #[error(
        "`contour` is {length} m long, which in `t_max` = {t_max} s gives an invalid speed: \
         give coordinates in metres and the time in seconds"
    )]
    Speed {
        /// Length of the contour (m).
        length: f64,
        /// Time limit (s).
        t_max: f64,
    },
    /// A contour that is too long for the time, even without a zig-zag.
    #[error(
        "`t_max` is {t_max} s, but the contour of {length:.3} m takes at least {least:.3} s at \
         the robot's {v_max} m/s: give it more time, a shorter contour or a faster robot"
    )]
    TooShort {
        /// Time limit of a lap (s).
        t_max: f64,
        /// Length of the contour (m).
        length: f64,
        /// Maximum speed of the robot (m/s).
        v_max: f64,
        /// Minimum time (s).
        least: f64,
    },
    /// A danger zone without an area.
    #[error(transparent)]
    Zone(#[from] DangerZoneError),
}
