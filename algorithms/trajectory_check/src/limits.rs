//! The limits of the drive: by the stated controls, and by poses and times alone.

use crate::contract::Contract;
use crate::findings::{Change, Findings};
use crate::sample::{Sample, wrapped};
use crate::tolerances::Tolerances;
use crate::violation::Violation;

/// Checks speeds and accelerations, and stores the maximum speeds.
#[derive(Debug)]
pub struct Limits<'a> {
    contract: &'a Contract,
    tolerances: &'a Tolerances,
    /// Maximum speed, stated or implied (m/s).
    pub top_speed: f64,
    /// Maximum turning rate, stated or implied (rad/s).
    pub top_turn_rate: f64,
}

impl<'a> Limits<'a> {
    /// Starts without any motion.
    pub fn new(contract: &'a Contract, tolerances: &'a Tolerances) -> Self {
        Self {
            contract,
            tolerances,
            top_speed: 0.0,
            top_turn_rate: 0.0,
        }
    }

    /// Checks the stated speed and turning rate of a sample. Between samples both are linear and no
    /// larger.
    pub fn controls(&mut self, sample: &Sample, findings: &mut Findings) {
        let (v, omega) = (sample.v.abs(), sample.omega.abs());
        let allowed = 1.0 + self.tolerances.limit;
        let contract = self.contract;
        findings.at_most(
            Violation::Speed,
            sample.t,
            sample.v,
            contract.v_max * allowed,
        );
        let slack = self.tolerances.limit * contract.v_max;
        findings.at_most(
            Violation::ReverseSpeed,
            sample.t,
            -sample.v,
            slack - contract.v_min,
        );
        findings.at_most(
            Violation::TurnRate,
            sample.t,
            omega,
            contract.omega_max * allowed,
        );
        if let Some(wheel) = contract.wheel {
            let speed = wheel.faster(v, omega);
            findings.at_most(
                Violation::WheelSpeed,
                sample.t,
                speed,
                wheel.speed * allowed,
            );
        }
        self.top_speed = self.top_speed.max(v);
        self.top_turn_rate = self.top_turn_rate.max(omega);
    }

    /// Checks the speeds that follow from poses and times alone, regardless of the controls. (A chord
    /// is never longer than the path, nor a wrapped turn more than the turn: valid samples cannot
    /// fail.)
    pub fn poses(&mut self, a: &Sample, b: &Sample, findings: &mut Findings) {
        let (contract, rounding) = (self.contract, self.tolerances.rounding);
        let allowed = 1.0 + self.tolerances.limit;
        let dt = b.t - a.t;
        let change = |amount| Change {
            amount,
            dt,
            rounding,
        };
        let moved = (b.position() - a.position()).norm();
        let turned = wrapped(b.theta - a.theta).abs();
        let limit = contract.top_speed() * allowed;
        findings.rate_at_most(Violation::PoseSpeed, a.t, change(moved), limit);
        let limit = contract.omega_max * allowed;
        findings.rate_at_most(Violation::PoseTurnRate, a.t, change(turned), limit);
        if let Some(wheel) = contract.wheel {
            let limit = wheel.speed * allowed;
            let rolled = change(wheel.faster(moved, turned));
            findings.rate_at_most(Violation::PoseWheelSpeed, a.t, rolled, limit);
        }
        // A speed that rounding may explain does not count.
        self.top_speed = self.top_speed.max((moved - rounding) / dt);
        self.top_turn_rate = self.top_turn_rate.max((turned - rounding) / dt);
    }

    /// Checks the accelerations.
    pub fn changes(&self, a: &Sample, b: &Sample, findings: &mut Findings) {
        let change = |from: f64, to: f64| Change {
            amount: (to - from).abs(),
            dt: b.t - a.t,
            rounding: self.tolerances.rounding,
        };
        let allowed = 1.0 + self.tolerances.limit;
        if let Some(most) = self.contract.acceleration_max {
            let change = change(a.v, b.v);
            findings.rate_at_most(Violation::Acceleration, a.t, change, most * allowed);
        }
        if let Some(most) = self.contract.angular_acceleration_max {
            let change = change(a.omega, b.omega);
            findings.rate_at_most(Violation::AngularAcceleration, a.t, change, most * allowed);
        }
    }
}
