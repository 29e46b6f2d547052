//! The figures, as a table and as JSON.

use crate::spread::Spread;
use latency::load;
use platform::machine::machine;
use serde_json::{Value as Json, json};

/// Baseline of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Baseline {
    /// Name.
    pub name: String,
    /// Value, in the figure's unit.
    pub value: f64,
}

/// Goal of a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// Minimum multiple of the baseline.
    RatioAtLeast(f64),
    /// Maximum, in the figure's unit.
    AtMost(f64),
    /// Minimum, in the figure's unit.
    AtLeast(f64),
}

/// One measured figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Item of the bench.
    pub item: &'static str,
    /// Measured quantity.
    pub name: String,
    /// Median (or the only value) with the extremes of the repetitions.
    pub value: Spread,
    /// Unit of the value.
    pub unit: &'static str,
    /// Baseline, measured in the same run.
    pub baseline: Option<Baseline>,
    /// Value over baseline: the median over pairs measured back to back, if there are pairs.
    pub ratio: Option<f64>,
    /// Goal.
    pub goal: Option<Goal>,
}

impl Figure {
    /// Returns a figure without a baseline.
    pub fn new(
        item: &'static str,
        name: impl Into<String>,
        value: Spread,
        unit: &'static str,
    ) -> Self {
        Self {
            item,
            name: name.into(),
            value,
            unit,
            baseline: None,
            ratio: None,
            goal: None,
        }
    }

    /// Returns a figure measured once.
    pub fn once(
        item: &'static str,
        name: impl Into<String>,
        value: f64,
        unit: &'static str,
    ) -> Self {
        let spread = Spread {
            median: value,
            min: value,
            max: value,
        };
        Self::new(item, name, spread, unit)
    }

    /// Adds a baseline; the ratio is that of the medians.
    #[must_use]
    pub fn against(mut self, name: impl Into<String>, value: f64) -> Self {
        self.ratio = (value > 0.0).then(|| self.value.median / value);
        self.baseline = Some(Baseline {
            name: name.into(),
            value,
        });
        self
    }

    /// Sets a ratio measured pair by pair.
    #[must_use]
    pub fn with_ratio(mut self, ratio: f64) -> Self {
        self.ratio = Some(ratio);
        self
    }

    /// Adds a goal.
    #[must_use]
    pub fn with_goal(mut self, goal: Goal) -> Self {
        self.goal = Some(goal);
        self
    }

    /// Returns `true` if the goal is reached; `None` without a goal or without the ratio that it
    /// needs.
    pub fn met(&self) -> Option<bool> {
        Some(match self.goal? {
            Goal::RatioAtLeast(least) => self.ratio? >= least,
            Goal::AtMost(most) => self.value.median <= most,
            Goal::AtLeast(least) => self.value.median >= least,
        })
    }

    fn goal_words(&self) -> String {
        let words = match self.goal {
            None => return String::new(),
            Some(Goal::RatioAtLeast(least)) => format!("≥ {least}×"),
            Some(Goal::AtMost(most)) => format!("≤ {most} {}", self.unit),
            Some(Goal::AtLeast(least)) => format!("≥ {least} {}", self.unit),
        };
        match self.met() {
            Some(true) => format!("{words} met"),
            Some(false) => format!("{words} MISSED"),
            None => words,
        }
    }

    fn json(&self) -> Json {
        json!({
            "item": self.item,
            "name": self.name,
            "value": self.value.median,
            "min": self.value.min,
            "max": self.value.max,
            "unit": self.unit,
            "baseline": self.baseline.as_ref().map(|b| json!({ "name": b.name, "value": b.value })),
            "ratio": self.ratio,
            "goal": self.goal.map(|goal| match goal {
                Goal::RatioAtLeast(least) => json!({ "ratio_at_least": least }),
                Goal::AtMost(most) => json!({ "at_most": most }),
                Goal::AtLeast(least) => json!({ "at_least": least }),
            }),
            "met": self.met(),
        })
    }
}

/// All measurements.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Report {
    /// The figures, in the order of measurement.
    pub figures: Vec<Figure>,
    /// Items that failed, with the reason.
    pub errors: Vec<(&'static str, String)>,
    /// Load averages over 1, 5 and 15 minutes at the start.
    pub load: [f64; 3],
}

impl Report {
    pub fn new() -> Self {
        Self {
            load: load(),
            ..Self::default()
        }
    }

    /// Returns the JSON object of `--json`.
    pub fn json(&self) -> Json {
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "machine": machine(),
            "load": self.load,
            "figures": self.figures.iter().map(Figure::json).collect::<Vec<_>>(),
            "errors": self
                .errors
                .iter()
                .map(|(item, error)| json!({ "item": item, "error": error }))
                .collect::<Vec<_>>(),
        })
    }

    /// Returns the table.
    pub fn text(&self) -> String {
        let columns = [
            ("item", 0),
            ("figure", 0),
            ("median", 0),
            ("min", 4),
            ("max", 4),
            ("unit", 0),
            ("baseline", 3),
            ("ratio", 1),
            ("goal", 2),
        ];
        let mut table = tables::TerminalTable::new(columns, 2);
        for figure in &self.figures {
            let ends = figure.value.min < figure.value.max;
            let end = |value: f64| {
                if ends { amount(value) } else { String::new() }
            };
            table.add_row([
                figure.item.to_owned(),
                figure.name.clone(),
                amount(figure.value.median),
                end(figure.value.min),
                end(figure.value.max),
                figure.unit.to_owned(),
                figure
                    .baseline
                    .as_ref()
                    .map(|b| format!("{}: {}", b.name, amount(b.value)))
                    .unwrap_or_default(),
                figure
                    .ratio
                    .map(|ratio| format!("{}×", amount(ratio)))
                    .unwrap_or_default(),
                figure.goal_words(),
            ]);
        }
        let [one, five, fifteen] = self.load;
        let mut text = format!(
            "{}; load {one:.1} {five:.1} {fifteen:.1}\n{table}",
            machine()
        );
        for (item, error) in &self.errors {
            text += &format!("\n{item}: FAILED: {error}");
        }
        text
    }
}

/// Formats a number with three or more significant digits.
fn amount(value: f64) -> String {
    match value.abs() {
        v if v >= 100.0 => format!("{value:.0}"),
        v if v >= 10.0 => format!("{value:.1}"),
        v if v >= 1.0 || v == 0.0 => format!("{value:.2}"),
        _ => format!("{value:.4}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_are_judged_by_the_ratio_or_the_value() {
        let figure = Figure::once("ticks", "runtime", 90.0, "1/s").against("raw", 100.0);
        assert_eq!(figure.met(), None, "no goal, no result");
        let least = figure.clone().with_goal(Goal::RatioAtLeast(0.8));
        assert_eq!(least.met(), Some(true));
        assert_eq!(least.with_ratio(0.7).met(), Some(false));
        let most = figure.with_goal(Goal::AtMost(80.0));
        assert_eq!(most.met(), Some(false));
        let start = Figure::once("start", "first tick", 0.4, "s").with_goal(Goal::AtMost(0.5));
        assert_eq!(start.met(), Some(true));
    }

    #[test]
    fn a_figure_with_a_zero_baseline_has_no_ratio() {
        let figure = Figure::once("hop", "64 B", 1.0, "us").against("raw", 0.0);
        assert_eq!(figure.ratio, None);
        assert_eq!(figure.with_goal(Goal::RatioAtLeast(0.8)).met(), None);
    }

    #[test]
    fn the_table_and_the_json_show_the_same_figures_and_errors() {
        let report = Report {
            figures: vec![
                Figure::once("hop", "64 B p50", 1.25, "us")
                    .against("raw", 1.0)
                    .with_goal(Goal::AtMost(1.2)),
            ],
            errors: vec![("ticks", "no room".into())],
            load: [0.0; 3],
        };
        let text = report.text();
        for part in ["64 B p50", "1.25×", "MISSED", "ticks: FAILED: no room"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let json = report.json();
        assert_eq!(json["figures"][0]["ratio"], 1.25);
        assert_eq!(json["figures"][0]["met"], false);
        assert_eq!(json["figures"][0]["baseline"]["name"], "raw");
        assert_eq!(json["errors"][0]["item"], "ticks");
    }
}
