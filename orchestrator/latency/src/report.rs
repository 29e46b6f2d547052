//! The measurements as JSON.

use std::path::PathBuf;

use platform::machine::machine;
use serde_json::{Map, Value as Json, json};
use statistics::{Distribution, Percentiles};

use super::of_log::RunLatencies;
use super::{REACTION, Stage, TICK_JITTER, WHOLE};

/// Number of bins of a histogram per power of ten.
pub const PER_DECADE: u32 = 8;

/// Measurements of one mission, or of one log.
#[derive(Debug, Clone)]
pub struct Run {
    /// Latencies from its stamps.
    pub measured: RunLatencies,
    /// Path of its log, if it is kept.
    pub log: Option<PathBuf>,
    /// `true` if it was interrupted.
    pub interrupted: bool,
}

/// All measurements.
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// The missions, or the log.
    pub runs: Vec<Run>,
    /// Failed measurements.
    pub errors: Vec<String>,
    /// `true` if it was interrupted before everything was measured.
    pub interrupted: bool,
    /// Load averages over 1, 5 and 15 minutes at the start.
    pub load: [f64; 3],
}

impl Report {
    /// Returns an empty report with the current load.
    pub fn new() -> Self {
        Self {
            load: load(),
            ..Self::default()
        }
    }

    /// Returns the report as one JSON object.
    pub fn json(&self) -> Json {
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "machine": machine(),
            "load": self.load,
            "interrupted": self.interrupted,
            "errors": self.errors,
            "runs": self.runs.iter().map(Run::json).collect::<Vec<_>>(),
        })
    }
}

impl Run {
    /// Returns the rows of sense-to-act: every stage of the run, then the sums.
    pub fn stages(&self) -> Vec<(&'static str, Percentiles)> {
        let names = Stage::ALL.map(Stage::name);
        let names = names.into_iter().chain([REACTION, WHOLE]);
        names
            .filter_map(|name| Some((name, self.measured.stages.get(name)?.percentiles())))
            .collect()
    }

    /// Returns the mean time of every stage (us), in the order of [`Stage::ALL`], of the ticks with
    /// complete stamps. Their sum is the mean of the total.
    pub fn means(&self) -> [f64; 7] {
        let passages = &self.measured.passages;
        let count = passages.len().max(1) as f64;
        let mut means = [0.0; 7];
        for (stage, mean) in means.iter_mut().enumerate() {
            let all: u64 = passages.iter().filter_map(|p| p.stages.get(stage)).sum();
            *mean = all as f64 / 1e3 / count;
        }
        means
    }

    /// Returns the largest difference, over all ticks, between the sum of the stages and the total
    /// (ns).
    pub fn sum_error_ns(&self) -> u64 {
        let differences = self.measured.passages.iter().map(|passage| {
            let sum: u64 = passage.stages.iter().sum();
            sum.abs_diff(passage.whole_ns)
        });
        differences.max().unwrap_or(0)
    }

    /// Returns the share of the tick period that the reaction takes at its 99th percentile; `None`
    /// in lock-step.
    pub fn share_of_period(&self) -> Option<f64> {
        let period = self.measured.period_ns? as f64 / 1e3;
        let reaction = self.measured.stages.get(REACTION)?;
        Some(reaction.at(0.99) / period.max(1e-3))
    }

    fn json(&self) -> Json {
        let m = &self.measured;
        let means = self.means();
        let stages: Vec<Json> = Stage::ALL
            .into_iter()
            .zip(means)
            .filter_map(|(stage, mean)| {
                let own = m.stages.get(stage.name())?;
                let mut row = distribution(own);
                row["name"] = stage.name().into();
                row["mean_us"] = mean.into();
                Some(row)
            })
            .collect();
        json!({
            "scenario": m.scenario,
            "seed": m.seed,
            "version": m.version,
            "machine": m.machine,
            "mode": m.mode,
            "rate_hz": m.rate_hz,
            "period_us": m.period_ns.map(|ns| ns as f64 / 1e3),
            "log": self.log,
            "interrupted": self.interrupted,
            "deadlines": {
                "ticks": m.answers.ticks,
                "in_time": m.answers.in_time,
                "late": m.answers.late,
                "unanswered": m.answers.unanswered,
                "without_beliefs": m.answers.without_beliefs,
            },
            "overruns": m.overruns,
            "tick_off_its_time": m.period.get(TICK_JITTER).map(distribution),
            "sense_to_command": m.stages.get(REACTION).map(distribution),
            "sense_to_act": m.stages.get(WHOLE).map(distribution),
            "stages": stages,
            "followed_ticks": m.passages.len(),
            "largest_sum_error_ns": self.sum_error_ns(),
            "hops": named(m.hops.iter()),
            "turns": named(m.turns.iter()),
            "messages": m.sizes.iter().map(|(topic, sizes)| (topic.clone(), json!({
                "count": sizes.messages,
                "mean_bytes": sizes.mean(),
            }))).collect::<Map<_, _>>(),
            "per_decade": PER_DECADE,
        })
    }
}

fn distribution(own: &Distribution) -> Json {
    json!({ "us": own.percentiles(), "histogram": own.log_histogram(PER_DECADE) })
}

fn named<'a>(all: impl Iterator<Item = (&'a String, &'a Distribution)>) -> Map<String, Json> {
    all.map(|(name, own)| (name.clone(), distribution(own)))
        .collect()
}

/// Returns load averages over 1, 5 and 15 minutes.
pub fn load() -> [f64; 3] {
    let text = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    parse_load(&text)
}

fn parse_load(text: &str) -> [f64; 3] {
    let mut words = text.split_whitespace();
    [(); 3].map(|()| words.next().and_then(|w| w.parse().ok()).unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_load_is_read_from_the_first_three_words() {
        assert_eq!(
            parse_load("0.89 3.23 4.82 1/123 4567\n"),
            [0.89, 3.23, 4.82]
        );
        assert_eq!(parse_load(""), [0.0; 3]);
    }
}
