//! The result of one plan of an experiment.

use serde::{Deserialize, Serialize};

use crate::columns::{Part, ResultColumn, ResultTable, columns};
use crate::kind::Kind;
use crate::row::{RESULTS, Record};
use plan::{Answer, Outcome};

/// The result of one plan. It does not depend on the machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanRow {
    /// Outcome.
    pub outcome: Outcome,
    /// `true` if the plan passes the trajectory check; `None` without a plan.
    pub honest: Option<bool>,
    /// Obstacles of the problem.
    pub obstacles: u32,
    /// Duration of the plan (s).
    pub t_s: Option<f64>,
    /// Lower bound of the duration of any plan (s).
    pub lower_bound_s: Option<f64>,
    /// Duration above the lower bound, relative to it.
    pub gap: Option<f64>,
    /// Length of its path (px).
    pub length_px: Option<f64>,
    /// Smallest distance of the path from a grown obstacle (px).
    pub min_clearance_px: Option<f64>,
    /// Convex programs solved.
    pub iterations: Option<u32>,
    /// Degrees of freedom of the curve.
    pub control_points: Option<u32>,
    /// Reason for which there is no plan, or the fault of the plan.
    pub error: String,
}

impl PlanRow {
    /// Returns the row of an answer to a problem with this number of obstacles.
    pub fn from_answer(answer: &Answer, obstacles: usize) -> Self {
        Self {
            outcome: answer.status,
            honest: answer.honest,
            obstacles: obstacles as u32,
            t_s: answer.t_s,
            lower_bound_s: answer.lower_bound_s,
            gap: answer.gap,
            length_px: answer.length,
            min_clearance_px: answer.min_clearance,
            iterations: answer.iterations,
            control_points: answer.control_points,
            error: answer.error.clone().unwrap_or_default(),
        }
    }

    /// Returns `true` if the problem has no solution.
    pub fn is_unsolvable(&self) -> bool {
        matches!(self.outcome, Outcome::NoPath | Outcome::Infeasible)
    }

    /// Returns `true` if there is a plan that passes the trajectory check.
    pub fn is_valid(&self) -> bool {
        self.honest == Some(true)
    }
}

impl Record for PlanRow {
    const KIND: Kind = Kind::Planning;

    const TABLES: &'static [ResultTable<Self>] = &[ResultTable::from_part::<Self>()];

    fn failed(error: String) -> Self {
        Self {
            outcome: Outcome::Failed,
            honest: None,
            obstacles: 0,
            t_s: None,
            lower_bound_s: None,
            gap: None,
            length_px: None,
            min_clearance_px: None,
            iterations: None,
            control_points: None,
            error,
        }
    }

    fn error(&self) -> &str {
        &self.error
    }

    fn is_failed(&self) -> bool {
        matches!(self.outcome, Outcome::Invalid | Outcome::Failed)
    }
}

impl Part<Self> for PlanRow {
    const TABLE: &'static str = RESULTS;
    const REFERENCE: [&'static str; 2] = ["Plans", "one row per plan"];

    const COLUMNS: &'static [ResultColumn<Self>] = columns! { r;
        Text "outcome",
            "Status of the plan, as in the [answers](plans.md) of `protean plan`; `failed` without an answer."
            => r.outcome.name();
        Bool "honest", "True if the plan passes the trajectory check; empty without a plan." => r.honest;
        Int "obstacles", "Obstacles of the problem." => r.obstacles;
        F64 "t_s", "Duration of the plan (s)." => r.t_s;
        F64 "lower_bound_s", "Lower bound of the duration of any plan (s)." => r.lower_bound_s;
        F64 "gap", "Duration above the lower bound, relative to it." => r.gap;
        F64 "length_px", "Length of the path (px)." => r.length_px;
        F64 "min_clearance_px", "Smallest distance of the path from a grown obstacle (px)." => r.min_clearance_px;
        Int "iterations", "Convex programs solved." => r.iterations;
        Int "control_points", "Degrees of freedom of the curve." => r.control_points;
        Text "error", "Reason for which there is no plan, or the fault of the plan." => r.error.as_str();
    };

    fn rows(row: &Self) -> &[Self] {
        std::slice::from_ref(row)
    }
}
