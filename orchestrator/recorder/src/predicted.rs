//! Accuracy of the predictions of observers over a run.

use std::collections::BTreeMap;

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::observer::Prediction;
use ipc_types::topics::{Predictions, TopicId};
use metrics::prediction::ErrorStatistics;

use super::summary::{OutcomePart, PredictionOutcome, Summary};

/// Maximum number of errors per method and horizon; later errors are only in the log.
const MAX_ERRORS: usize = 1_000_000;

/// Predictions of one method for one horizon.
#[derive(Debug, Default)]
struct Series {
    errors: Vec<f64>,
    goals_observed: u32,
    /// Time at which the key was first known (s), and the number of goals observed by then.
    recovered: Option<(f64, u32)>,
}

/// All predictions, by observer, robot, method and the bits of the horizon, which sort in numerical order.
#[derive(Debug, Default)]
pub(super) struct PredictionSeries(BTreeMap<(u32, u32, u8, u64), Series>);

impl Consumer for PredictionSeries {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::Predictions]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        if let Some((_, predictions)) = message.view::<Predictions>() {
            let observer = message.stamp.source;
            predictions.for_each(|p| self.add(observer, message.time_s(), &p));
        }
    }
}

impl OutcomePart for PredictionSeries {
    fn finish(self: Box<Self>, summary: &mut Summary) {
        let names: Vec<&str> = summary.robots.iter().map(|r| r.name.as_str()).collect();
        summary.predictions = self.outcomes(&names);
    }
}

impl PredictionSeries {
    /// Adds a prediction of an observer at a time (s).
    fn add(&mut self, observer: u32, time_s: f64, prediction: &Prediction) {
        let key = (
            observer,
            prediction.robot,
            prediction.method,
            prediction.horizon_s.to_bits(),
        );
        let series = self.0.entry(key).or_default();
        if prediction.due != 0 && series.errors.len() < MAX_ERRORS {
            series.errors.push(prediction.error);
        }
        series.goals_observed = prediction.goals_observed;
        if prediction.key_recovered != 0 && series.recovered.is_none() {
            series.recovered = Some((time_s, prediction.goals_observed));
        }
    }

    /// Returns the outcomes for robots with these names; `None` without an observer.
    fn outcomes(&self, robots: &[&str]) -> Option<Vec<PredictionOutcome>> {
        let outcomes: Vec<_> = self
            .0
            .iter()
            .filter_map(|(&(observer, robot, method, horizon), series)| {
                let statistics = ErrorStatistics::from_errors(&series.errors);
                let count = statistics.map_or(0, |s| s.count);
                Some(PredictionOutcome {
                    observer,
                    robot: (*robots.get(robot as usize)?).to_owned(),
                    method: Prediction::method_name(method).to_owned(),
                    horizon_s: f64::from_bits(horizon),
                    predictions: count as u64,
                    without: (series.errors.len() - count) as u64,
                    mean_m: statistics.map(|s| s.mean),
                    median_m: statistics.map(|s| s.median),
                    rms_m: statistics.map(|s| s.rms),
                    goals_observed: series.goals_observed,
                    key_recovered_s: series.recovered.map(|(time_s, _)| time_s),
                    key_recovered_after: series.recovered.map(|(_, goals)| goals),
                })
            })
            .collect();
        (!outcomes.is_empty()).then_some(outcomes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn prediction(method: u8, horizon_s: f64, error: Option<f64>, recovered: bool) -> Prediction {
        Prediction {
            horizon_s,
            error: error.unwrap_or(f64::INFINITY),
            robot: 1,
            goals_observed: 40,
            method,
            due: 1,
            key_recovered: u8::from(recovered),
            ..Prediction::default()
        }
    }

    #[test]
    fn errors_are_counted_by_method_and_horizon_and_the_key_when_first_known() {
        let mut predicted = PredictionSeries::default();
        let names = ["a", "b"];
        assert_eq!(predicted.outcomes(&names), None);
        let not_due = Prediction {
            due: 0,
            ..prediction(0, 0.5, None, false)
        };
        predicted.add(3, 0.0, &not_due);
        for (time_s, error) in [(1.0, 3.0), (2.0, 4.0), (3.0, 5.0)] {
            predicted.add(3, time_s, &prediction(0, 0.5, Some(error), false));
        }
        predicted.add(3, 1.0, &prediction(5, 2.0, None, false));
        predicted.add(3, 2.0, &prediction(5, 2.0, Some(0.1), true));
        predicted.add(3, 3.0, &prediction(5, 2.0, Some(0.3), true));
        // A robot that does not exist is ignored.
        let unknown = Prediction {
            robot: 9,
            ..prediction(0, 0.5, None, false)
        };
        predicted.add(3, 0.0, &unknown);
        let found = predicted.outcomes(&names).unwrap();
        assert_eq!(found.len(), 2);
        let kalman = &found[0];
        assert_eq!(
            (kalman.robot.as_str(), kalman.method.as_str()),
            ("b", "kalman")
        );
        assert_eq!((kalman.predictions, kalman.without), (3, 0));
        assert_eq!((kalman.mean_m, kalman.median_m), (Some(4.0), Some(4.0)));
        assert_eq!(kalman.key_recovered_s, None);
        let key = &found[1];
        assert_eq!(
            (key.method.as_str(), key.predictions, key.without),
            ("cat_key", 2, 1)
        );
        assert_eq!(
            (key.key_recovered_s, key.key_recovered_after),
            (Some(2.0), Some(40))
        );
        let json = serde_json::to_string(kalman).unwrap();
        assert!(!json.contains("key_recovered"), "{json}");
    }
}
