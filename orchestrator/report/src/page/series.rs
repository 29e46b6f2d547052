//! Figures of a run over time.

use std::collections::BTreeMap;

use geometry::math;
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::observer::Prediction;
use ipc_types::messages::perception::BeliefHeader;
use ipc_types::messages::referee::Verdict;
use ipc_types::messages::world::{CoverageState, RobotState};
use ipc_types::topics::{Belief, Coverage, Predictions, TopicId, Verdicts};

use super::thinning::ThinnedSeries;
use crate::run_model::LoggedRun;
use recorder::PatrolMeasurement;
use scenario::spec::MAX_ROBOTS;

/// Maximum number of values of one curve.
const VALUES: usize = 1500;
/// Maximum number of curves.
const CURVES: usize = 400;
/// Codes in [`RobotState`].
const PURSUER: u8 = 1;
const EVADER: u8 = 2;
const CAUGHT: u8 = 1;
const ESCAPED: u8 = 2;

/// Quantity of a plot; curves of the same quantity share a plot, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Figure {
    Outcome,
    Nearest,
    Coverage,
    Idleness,
    PlacesVisited,
    PatrolIdleness,
    BeliefError,
    BeliefSpread,
    SafeShare,
    /// By the bits of the horizon (s), which sort as the horizons do.
    PredictionError(u64),
    Distance,
    Speed,
}

/// Subject of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Curve {
    /// A robot.
    Robot(u32),
    /// A robot and a prediction method.
    Method(u32, u8),
    /// A patrol by its index, and the name of one of its figures.
    Patrol(usize, &'static str),
    /// A name.
    Named(&'static str),
}

/// All curves read so far.
#[derive(Debug, Clone, Default)]
pub struct Series {
    pub(super) curves: BTreeMap<(Figure, Curve), ThinnedSeries<f64>>,
    /// Sum and number of prediction errors so far.
    errors: BTreeMap<(Figure, Curve), (f64, u64)>,
}

impl Consumer<LoggedRun> for Series {
    fn topics(&self) -> &[TopicId] {
        &[
            TopicId::WorldState,
            TopicId::Belief,
            TopicId::Predictions,
            TopicId::Coverage,
            TopicId::Verdicts,
        ]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, run: &mut LoggedRun) {
        let time_ns = message.time_ns;
        if message.topic == TopicId::WorldState {
            self.state(time_ns, &run.states);
            self.patrols(time_ns, &run.patrols);
        }
        if let Some((header, _)) = run.decode::<Belief>(message)
            && (header.robot as usize) < MAX_ROBOTS
        {
            let truth = run.states.iter().find(|s| s.robot == header.robot);
            self.belief(time_ns, &header, truth);
        }
        if let Some((_, predictions)) = run.decode::<Predictions>(message) {
            self.predictions(time_ns, &predictions);
        }
        if let Some((_, reports)) = run.decode::<Coverage>(message) {
            for report in &reports {
                self.coverage(time_ns, report);
            }
        }
        if let Some((_, verdicts)) = run.decode::<Verdicts>(message) {
            for verdict in &verdicts {
                self.verdict(time_ns, verdict);
            }
        }
    }
}

impl Series {
    fn add(&mut self, figure: Figure, curve: Curve, time_ns: u64, value: f64) {
        if self.curves.len() >= CURVES && !self.curves.contains_key(&(figure, curve)) {
            return;
        }
        self.curves
            .entry((figure, curve))
            .or_insert_with(|| ThinnedSeries::new(0, VALUES, |_| 1))
            .push(time_ns, 0, value);
    }

    fn state(&mut self, time_ns: u64, robots: &[RobotState]) {
        for s in robots {
            let curve = Curve::Robot(s.robot);
            self.add(Figure::Distance, curve, time_ns, s.distance);
            self.add(Figure::Speed, curve, time_ns, s.v);
        }
        let evaders = || robots.iter().filter(|s| s.team == EVADER);
        if evaders().count() == 0 {
            return;
        }
        for (name, status) in [("playing", 0), ("caught", CAUGHT), ("escaped", ESCAPED)] {
            let count = evaders().filter(|s| s.status == status).count();
            self.add(Figure::Outcome, Curve::Named(name), time_ns, count as f64);
        }
        for evader in evaders() {
            let pursuers = robots.iter().filter(|s| s.team == PURSUER && s.status == 0);
            let nearest = pursuers
                .map(|s| math::hypot(s.x - evader.x, s.y - evader.y))
                .fold(f64::INFINITY, f64::min);
            // An evader that has left the game has no nearest pursuer.
            let nearest = if evader.status == 0 {
                nearest
            } else {
                f64::INFINITY
            };
            self.add(
                Figure::Nearest,
                Curve::Robot(evader.robot),
                time_ns,
                nearest,
            );
        }
    }

    fn belief(&mut self, time_ns: u64, header: &BeliefHeader, truth: Option<&RobotState>) {
        let curve = Curve::Robot(header.robot);
        if let Some(s) = truth {
            let error = math::hypot(header.mean_x - s.x, header.mean_y - s.y);
            self.add(Figure::BeliefError, curve, time_ns, error);
        }
        let spread = (header.covariance_xx + header.covariance_yy)
            .max(0.0)
            .sqrt();
        self.add(Figure::BeliefSpread, curve, time_ns, spread);
    }

    fn coverage(&mut self, time_ns: u64, report: &CoverageState) {
        for (figure, name, value) in [
            (Figure::Coverage, "of the free area", report.fraction),
            (
                Figure::Coverage,
                "of what robots can visit",
                report.coverable_fraction,
            ),
            (Figure::Idleness, "mean", report.mean_idleness),
            (Figure::Idleness, "largest now", report.max_idleness),
            (Figure::Idleness, "worst so far", report.worst_idleness),
        ] {
            self.add(figure, Curve::Named(name), time_ns, value);
        }
    }

    fn patrols(&mut self, time_ns: u64, patrols: &[PatrolMeasurement]) {
        for (patrol, measurement) in patrols.iter().enumerate() {
            let now = measurement.places().now();
            for (figure, name, value) in [
                (Figure::PlacesVisited, "visited", now.visited),
                (Figure::PatrolIdleness, "mean", now.mean_s),
                (Figure::PatrolIdleness, "largest now", now.worst_s),
            ] {
                self.add(figure, Curve::Patrol(patrol, name), time_ns, value);
            }
        }
    }

    fn verdict(&mut self, time_ns: u64, verdict: &Verdict) {
        let curve = Curve::Robot(verdict.robot);
        self.add(Figure::SafeShare, curve, time_ns, verdict.area_share);
    }

    fn predictions(&mut self, time_ns: u64, predictions: &[Prediction]) {
        for prediction in predictions
            .iter()
            .filter(|p| p.due != 0 && p.horizon_s >= 0.0)
        {
            let figure = Figure::PredictionError(prediction.horizon_s.to_bits());
            let curve = Curve::Method(prediction.robot, prediction.method);
            let full = self.errors.len() >= CURVES && !self.errors.contains_key(&(figure, curve));
            if full || !prediction.error.is_finite() {
                continue;
            }
            // Single errors scatter too much to compare methods: plot the mean.
            let (sum, count) = self.errors.entry((figure, curve)).or_default();
            *sum += prediction.error;
            *count += 1;
            let mean = *sum / *count as f64;
            self.add(figure, curve, time_ns, mean);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(series: Series, figure: Figure, curve: Curve) -> Vec<f64> {
        let mut curves = series.curves;
        let curve = curves.remove(&(figure, curve)).unwrap();
        curve.finish().into_iter().map(|s| s.item).collect()
    }

    #[test]
    fn the_nearest_pursuer_is_still_in_the_game() {
        let robot = |robot, team, status, x| RobotState {
            robot,
            team,
            status,
            x,
            ..RobotState::default()
        };
        let mut series = Series::default();
        let evader = |status| robot(2, EVADER, status, 0.0);
        let (off, on) = (robot(0, PURSUER, 5, 1.0), robot(1, PURSUER, 0, 3.0));
        series.state(0, &[off, on, evader(0)]);
        series.state(1, &[off, on, evader(CAUGHT)]);
        assert_eq!(
            series
                .curves
                .keys()
                .filter(|k| k.0 == Figure::Outcome)
                .count(),
            3
        );
        let nearest = values(series, Figure::Nearest, Curve::Robot(2));
        assert_eq!(nearest, [3.0, f64::INFINITY]);
    }

    #[test]
    fn the_mean_is_of_the_errors_that_are_due() {
        let mut series = Series::default();
        for (time, due, error) in [(1, 0, 9.0), (2, 1, 0.5), (3, 1, f64::INFINITY), (4, 1, 1.5)] {
            let prediction = Prediction {
                horizon_s: 2.0,
                due,
                error,
                method: 3,
                ..Prediction::default()
            };
            series.predictions(time, &[prediction]);
        }
        let figure = Figure::PredictionError(2.0_f64.to_bits());
        assert_eq!(values(series, figure, Curve::Method(0, 3)), [0.5, 1.0]);
    }
}
