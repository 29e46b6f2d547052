//! The conditions at the start and at the goal.

use nalgebra::Point2;

use crate::contract::Contract;
use crate::findings::Findings;
use crate::sample::{Sample, wrapped};
use crate::tolerances::Tolerances;
use crate::violation::{Excess, Violation};

/// Checks the first and the last sample against the contract.
pub fn check(
    contract: &Contract,
    [first, last]: [&Sample; 2],
    tolerances: &Tolerances,
    findings: &mut Findings,
) {
    findings.at_most(
        Violation::StartTime,
        first.t,
        first.t.abs(),
        tolerances.rounding,
    );

    let mut met = |kind: fn(Excess) -> Violation, at: &Sample, error: f64| {
        findings.at_most(kind, at.t, error.abs(), tolerances.boundary);
    };
    let [x, y, heading] = contract.start;
    met(
        Violation::Start,
        first,
        (first.position() - Point2::new(x, y)).norm(),
    );
    met(
        Violation::StartHeading,
        first,
        wrapped(first.theta - heading),
    );
    if let Some(speed) = contract.start_speed {
        met(Violation::StartSpeed, first, first.v - speed);
    }
    if let Some(rate) = contract.start_turn_rate {
        met(Violation::StartTurnRate, first, first.omega - rate);
    }
    let goal = Point2::from(contract.goal);
    met(Violation::Goal, last, (last.position() - goal).norm());
    if let Some(heading) = contract.goal_heading {
        met(Violation::GoalHeading, last, wrapped(last.theta - heading));
    }
    if let Some(speed) = contract.goal_speed {
        met(Violation::GoalSpeed, last, last.v - speed);
    }
}
