//! Summary of many plans.

use statistics::quantile;
use tables::TerminalTable;

use super::answer::{Answer, Outcome};

/// Summary of many plans.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Summary {
    /// Number of answered problems.
    pub answered: usize,
    /// Number of answers by outcome, in the order of [`Outcome::ALL`].
    pub outcomes: [usize; Outcome::ALL.len()],
    /// Number of searches in the controls that failed.
    pub failed_searches: u32,
    /// Number of plans that pass the check.
    pub honest: usize,
    /// CPU times of plans that pass the check (ms); sorted in [`Summary::text`].
    cpu_ms: Vec<f64>,
    /// Gaps of plans that pass the check.
    gaps: Vec<f64>,
}

impl Summary {
    /// Adds an answer.
    pub fn add(&mut self, answer: &Answer) {
        self.answered += 1;
        let place = Outcome::ALL.iter().position(|&o| o == answer.status);
        if let Some(count) = place.and_then(|i| self.outcomes.get_mut(i)) {
            *count += 1;
        }
        self.failed_searches += answer.failed_searches.unwrap_or(0);
        if answer.honest == Some(true) {
            self.honest += 1;
            self.cpu_ms.extend(answer.cpu_ms);
            self.gaps.extend(answer.gap);
        }
    }

    /// Returns the number of answers with this outcome.
    pub fn count(&self, outcome: Outcome) -> usize {
        let place = Outcome::ALL.iter().position(|&o| o == outcome);
        let count = place.and_then(|i| self.outcomes.get(i));
        count.copied().unwrap_or_default()
    }

    /// Returns the table as text; `name` is the name of the problems and the method.
    pub fn text(&mut self, name: [&str; 2]) -> String {
        self.cpu_ms.sort_by(f64::total_cmp);
        self.gaps.sort_by(f64::total_cmp);
        let shares = |values: &[f64], shares: [f64; 3], factor: f64, digits: usize| {
            let text = shares.map(|share| {
                quantile(values, share).map_or_else(
                    || "-".to_owned(),
                    |value| format!("{:.digits$}", factor * value),
                )
            });
            text.join(" / ")
        };
        let columns = [
            ("instances", 0),
            ("method", 4),
            ("honest", 0),
            ("CPU (ms) median / p95 / p99", 2),
            ("gap (%) median / p95 / max", 1),
            ("curve", 3),
            ("fallback", 3),
            ("failed searches", 3),
            ("no path", 3),
            ("no plan", 3),
            ("invalid", 3),
        ];
        let mut table = TerminalTable::new(columns, 2);
        let none = [
            Outcome::Infeasible,
            Outcome::InvalidTrajectory,
            Outcome::Failed,
        ];
        let without: usize = none.into_iter().map(|o| self.count(o)).sum();
        table.add_row([
            name[0].to_owned(),
            name[1].to_owned(),
            format!("{}/{}", self.honest, self.answered),
            shares(&self.cpu_ms, [0.5, 0.95, 0.99], 1.0, 2),
            shares(&self.gaps, [0.5, 0.95, 1.0], 100.0, 4),
            self.count(Outcome::Curve).to_string(),
            self.count(Outcome::Fallback).to_string(),
            self.failed_searches.to_string(),
            self.count(Outcome::NoPath).to_string(),
            without.to_string(),
            self.count(Outcome::Invalid).to_string(),
        ]);
        table.to_string()
    }
}
