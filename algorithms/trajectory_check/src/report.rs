//! Result of a check.

use core::fmt;

use crate::boundary;
use crate::contract::Contract;
use crate::findings::Findings;
use crate::motion::Walk;
use crate::sample::Sample;
use crate::tolerances::Tolerances;
use crate::validity;
use crate::violation::Violation;

/// Result of [`check`]. All figures are NaN if the contract or the samples cannot be checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Time from the first sample to the last (s).
    pub duration: f64,
    /// Length of the path by the stated speeds (m), forwards and backwards alike.
    pub length: f64,
    /// Minimum signed distance (m) of the continuous path to an obstacle grown by the clearance;
    /// negative inside. Never above the true value, and usually 10 µm or less below; infinite
    /// without obstacles.
    pub min_clearance: f64,
    /// Maximum depth inside a grown obstacle or outside the bounds (m), 0 if there is none.
    pub deepest: f64,
    /// Maximum speed (m/s), of the stated ones and those that follow from poses and times.
    pub top_speed: f64,
    /// Maximum turning rate (rad/s), of the stated ones and those that follow from poses and times.
    pub top_turn_rate: f64,
    /// Maximum distance (m) of a sample from the position that follows from the stated controls
    /// alone since the first one. For information: it sums up the allowed differences between
    /// samples.
    pub drift: f64,
    /// Violations: the worst of each kind.
    pub violations: Vec<Violation>,
}

impl Report {
    /// Returns `true` if the trajectory keeps the contract and matches its stated controls.
    pub fn is_valid(&self) -> bool {
        self.violations.is_empty()
    }

    fn refused(findings: Findings) -> Self {
        Self {
            duration: f64::NAN,
            length: f64::NAN,
            min_clearance: f64::NAN,
            deepest: f64::NAN,
            top_speed: f64::NAN,
            top_turn_rate: f64::NAN,
            drift: f64::NAN,
            violations: findings.into_violations(),
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_valid() {
            return write!(f, "valid: {:.3} s, {:.3} m", self.duration, self.length);
        }
        f.write_str("not valid")?;
        for (k, violation) in self.violations.iter().enumerate() {
            write!(f, "{} {violation}", if k == 0 { ":" } else { ";" })?;
        }
        Ok(())
    }
}

/// Checks samples against the problem they claim to solve, with [`Tolerances::STANDARD`].
pub fn check(contract: &Contract, samples: &[Sample]) -> Report {
    check_with(contract, samples, &Tolerances::STANDARD)
}

/// Checks samples against the problem they claim to solve, with the given tolerances.
pub fn check_with(contract: &Contract, samples: &[Sample], tolerances: &Tolerances) -> Report {
    let mut findings = Findings::default();
    validity::check(contract, samples, &mut findings);
    let (Some(first), Some(last), true) = (samples.first(), samples.last(), findings.is_empty())
    else {
        return Report::refused(findings);
    };
    boundary::check(contract, [first, last], tolerances, &mut findings);

    let mut walk = Walk::new(contract, tolerances, first);
    walk.limits.controls(first, &mut findings);
    for pair in samples.windows(2) {
        walk.limits.controls(&pair[1], &mut findings);
        walk.step(&pair[0], &pair[1], &mut findings);
    }
    let duration = last.t - first.t;
    walk.finish(duration, &mut findings);
    Report {
        duration,
        length: walk.figures.length,
        min_clearance: walk.clearance.to_obstacles(),
        deepest: walk.clearance.deepest(),
        top_speed: walk.limits.top_speed,
        top_turn_rate: walk.limits.top_turn_rate,
        drift: walk.figures.drift,
        violations: findings.into_violations(),
    }
}
