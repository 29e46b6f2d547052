//! Consistency of poses, controls, times and limits between two samples.

use nalgebra::Point2;

use crate::clearance::{Clearance, Span};
use crate::contract::Contract;
use crate::findings::Findings;
use crate::limits::Limits;
use crate::piece::{Piece, rotated};
use crate::sample::{Sample, wrapped};
use crate::tolerances::Tolerances;
use crate::violation::Violation;

/// Walks along a trajectory and checks each step.
#[derive(Debug)]
pub struct Walk<'a> {
    contract: &'a Contract,
    tolerances: &'a Tolerances,
    /// The limits of the drive, and the maximum speeds so far.
    pub limits: Limits<'a>,
    /// Position that follows from the controls alone since the start (m).
    led_to: Point2<f64>,
    /// Heading that follows from the controls alone (rad).
    led_heading: f64,
    /// Figures of the path so far.
    pub figures: Figures,
    /// The closest approach so far.
    pub clearance: Clearance,
}

/// Sums over a walk.
#[derive(Debug, Clone, Copy, Default)]
pub struct Figures {
    /// Length of the path (m).
    pub length: f64,
    /// Maximum distance of a sample from the position that follows from the controls alone since
    /// the start (m).
    pub drift: f64,
    /// Sum of the accepted distances between samples and the positions that follow from the
    /// controls since the previous sample (m).
    displacement: f64,
    /// The same sum of headings (rad).
    heading: f64,
}

impl<'a> Walk<'a> {
    /// Starts at the first sample.
    pub fn new(contract: &'a Contract, tolerances: &'a Tolerances, first: &Sample) -> Self {
        let mut clearance = Clearance::new(contract);
        clearance.visit(&Span {
            time: first.t,
            piece: Piece::between(first, first),
            end: first.position(),
            slack: 0.0,
        });
        Self {
            contract,
            tolerances,
            limits: Limits::new(contract, tolerances),
            led_to: first.position(),
            led_heading: first.theta,
            figures: Figures::default(),
            clearance,
        }
    }

    /// Checks the step from one sample to the next.
    pub fn step(&mut self, a: &Sample, b: &Sample, findings: &mut Findings) {
        let dt = b.t - a.t;
        if dt > 0.0 {
            self.limits.poses(a, b, findings);
            self.limits.changes(a, b, findings);
            self.motion(a, b, findings);
        } else if dt == 0.0 {
            self.instant(a, b, findings);
        } else {
            findings.at_most(Violation::TimeBackwards, a.t, -dt, 0.0);
        }
    }

    /// Checks the sums over the whole trajectory at its end.
    pub fn finish(&self, duration: f64, findings: &mut Findings) {
        let Tolerances {
            mismatch,
            mismatch_total,
            ..
        } = *self.tolerances;
        let limit = |highest: f64| mismatch * highest * duration.max(0.0) + mismatch_total;
        let displacement = self.figures.displacement;
        let most = limit(self.contract.top_speed());
        findings.at_most(Violation::TotalDisplacement, duration, displacement, most);
        let most = limit(self.contract.omega_max);
        findings.at_most(
            Violation::TotalHeading,
            duration,
            self.figures.heading,
            most,
        );
        self.clearance.report(self.tolerances, findings);
    }

    /// Checks two samples of the same time: only controls without a limit may differ.
    fn instant(&mut self, a: &Sample, b: &Sample, findings: &mut Findings) {
        let rounding = self.tolerances.rounding;
        let moved = (b.position() - a.position()).norm();
        let turned = wrapped(b.theta - a.theta).abs();
        findings.at_most(Violation::Jump, a.t, moved.max(turned), rounding);
        if moved.max(turned) <= rounding {
            self.figures.displacement += moved;
            self.figures.heading += turned;
        }
        if self.contract.acceleration_max.is_some() {
            findings.at_most(Violation::SpeedStep, a.t, (b.v - a.v).abs(), rounding);
        }
        if self.contract.angular_acceleration_max.is_some() {
            let step = (b.omega - a.omega).abs();
            findings.at_most(Violation::TurnRateStep, a.t, step, rounding);
        }
    }

    /// Checks that the controls lead from one pose to the other, and the clearance on the path.
    fn motion(&mut self, a: &Sample, b: &Sample, findings: &mut Findings) {
        let Tolerances {
            mismatch,
            mismatch_floor,
            rounding,
            spacing,
            ..
        } = *self.tolerances;
        let piece = Piece::between(a, b);
        let displacement = piece.displacement();
        let end = piece.start + rotated(displacement, piece.heading);

        let off = (end - b.position()).norm();
        let most_off = mismatch * self.contract.top_speed() * piece.dt + mismatch_floor;
        findings.at_most(Violation::Displacement, a.t, off, most_off);
        let turned_off = wrapped(a.theta + piece.turn() - b.theta).abs();
        let most_turned_off = mismatch * self.contract.omega_max * piece.dt + mismatch_floor;
        findings.at_most(Violation::Heading, a.t, turned_off, most_turned_off);

        let chord = (b.position() - a.position()).norm();
        let length = piece.length();
        findings.at_most(
            Violation::Spacing,
            a.t,
            chord.max(length),
            spacing + rounding,
        );

        self.led_to += rotated(displacement, self.led_heading);
        self.led_heading += piece.turn();
        let figures = &mut self.figures;
        figures.length += length;
        figures.drift = figures.drift.max((self.led_to - b.position()).norm());

        let followed = off <= most_off;
        if followed {
            figures.displacement += off;
        }
        if turned_off <= most_turned_off {
            figures.heading += turned_off;
        }
        self.clearance.visit(&if followed {
            Span {
                time: a.t,
                piece,
                end,
                slack: off,
            }
        } else {
            // The mismatch is recorded; it must not count as a collision as well.
            Span {
                time: a.t,
                piece: Piece::chord(a, b),
                end: b.position(),
                slack: 0.0,
            }
        });
    }
}
