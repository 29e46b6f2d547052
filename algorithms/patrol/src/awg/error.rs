//! Why there is no zig-zag.

use thiserror::Error;

use super::MAX_T_MAX;
use crate::danger::DangerZoneError;

/// Why a zig-zag cannot be made, and what to change.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum AwgError {
    /// A time that is none.
    #[error("`t_max` is {value}, but must be a number above 0 and of at most {MAX_T_MAX} (s)")]
    TMax {
        /// The time given (s).
        value: f64,
    },
    /// A width that is none.
    #[error(
        "`alpha` is {value}, but must be a finite number above 0 (m); leave it out to have it chosen"
    )]
    Alpha {
        /// The width given (m).
        value: f64,
    },
    /// A clock that does not run, or runs late.
    #[error("the tempo is {value}, but must be a number above 0 and of at most 1")]
    Tempo {
        /// The tempo given.
        value: f64,
    },
    /// A contour so short, or so long, for its time that its speed is no number.
    #[error(
        "`contour` is {length} m long, which in `t_max` = {t_max} s is no speed that can be \
         computed with: give coordinates in metres and the time in seconds"
    )]
    Speed {
        /// Length of the contour (m).
        length: f64,
        /// Time for it (s).
        t_max: f64,
    },
    /// A contour that is too long for the time, even without a zig-zag.
    #[error(
        "`t_max` is {t_max} s, but the contour of {length:.3} m takes at least {least:.3} s at \
         the robot's {v_max} m/s: give it more time, a shorter contour or a faster robot"
    )]
    TooShort {
        /// Time for a lap (s).
        t_max: f64,
        /// Length of the contour (m).
        length: f64,
        /// Greatest speed of the robot (m/s).
        v_max: f64,
        /// Least time that would do (s).
        least: f64,
    },
    /// A danger zone that is no area.
    #[error(transparent)]
    Zone(#[from] DangerZoneError),
}
