//! What a figure shows of a cell.

use super::row::Row;
use super::spec::Metric;
use crate::figures::Unit;
use crate::recorder::{LapFigures, WaypointOutcome};
use crate::statistics::{Mean, Sample, Z95};

/// The value of a cell's games and the ends of its 95 % interval; `None` if they have none.
///
/// Chances are shares of evaders with an interval that counts games ([`Sample::interval`]); the rest are
/// means over games with Student's interval, of the games that have the value.
pub(super) fn measure(metric: Metric, rows: &[&Row]) -> Option<(f64, Option<(f64, f64)>)> {
    match metric {
        Metric::EscapeChance => chance(rows, |r| r.escaped),
        Metric::CaptureChance => chance(rows, |r| r.caught),
        Metric::HeldOutChance => chance(rows, |r| r.held_out),
        Metric::GameTime => mean(rows, |r| Some(r.sim_time_s)),
        Metric::FirstCapture => mean(rows, |r| r.first_capture_s),
        Metric::FirstEscape => mean(rows, |r| r.first_escape_s),
        Metric::Contacts => mean(rows, |r| Some(f64::from(r.contacts))),
        Metric::EvaderMeanSpeed => mean(rows, |r| r.evader_mean_speed),
        Metric::EscapePossible => mean(rows, |r| r.escape_possible_fraction),
        Metric::LapLength => mean(rows, |r| laps(r, |w| Some(w.planned?.length_m))),
        Metric::LongestLap => mean(rows, |r| laps(r, |w| w.longest_lap_s)),
        Metric::PlannedMae => mean(rows, |r| planned(r, |f| f.mae_m)),
        Metric::DrivenMae => mean(rows, |r| driven(r, |f| f.mae_m)),
        Metric::PlannedMaa => mean(rows, |r| planned(r, |f| f.maa)),
        Metric::DrivenMaa => mean(rows, |r| driven(r, |f| f.maa)),
        Metric::LeftOut => mean(rows, |r| laps(r, |w| Some(w.left_out_share()))),
        Metric::Coverage => mean(rows, |r| Some(r.coverage.as_ref()?.coverable_fraction)),
    }
}

/// Mean over the robots of a mission that visit waypoints.
fn laps(row: &Row, value: impl Fn(&WaypointOutcome) -> Option<f64>) -> Option<f64> {
    let visits = row.robots.iter().filter_map(|r| r.waypoints.as_ref());
    let values: Vec<f64> = visits.filter_map(value).collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn planned(row: &Row, value: fn(&LapFigures) -> f64) -> Option<f64> {
    laps(row, |w| w.planned.as_ref().map(value))
}

fn driven(row: &Row, value: fn(&LapFigures) -> f64) -> Option<f64> {
    laps(row, |w| w.driven.as_ref().map(value))
}

fn chance(rows: &[&Row], hits: fn(&Row) -> u32) -> Option<(f64, Option<(f64, f64)>)> {
    let sample: Sample = rows.iter().map(|r| (hits(r), r.evaders)).collect();
    let interval = sample.interval(Z95);
    Some((sample.share()?, Some((interval.low, interval.high))))
}

fn mean(rows: &[&Row], value: fn(&Row) -> Option<f64>) -> Option<(f64, Option<(f64, f64)>)> {
    let values: Vec<f64> = rows.iter().filter_map(|r| value(r)).collect();
    let mean = Mean::of(&values)?;
    let interval = mean.interval();
    // One value says nothing of its error.
    let known = interval.low.is_finite() && interval.high.is_finite();
    Some((mean.value, known.then_some((interval.low, interval.high))))
}

impl Metric {
    /// Text along the axis.
    pub(super) fn label(self) -> &'static str {
        match self {
            Self::EscapeChance => "evaders that escape",
            Self::CaptureChance => "evaders that are caught",
            Self::HeldOutChance => "evaders that hold out",
            Self::GameTime => "length of a game [s]",
            Self::FirstCapture => "time of the first capture [s]",
            Self::FirstEscape => "time of the first escape [s]",
            Self::Contacts => "contacts per game",
            Self::EvaderMeanSpeed => "mean speed of the evaders [m/s]",
            Self::EscapePossible => "part of the game in which an escape is possible",
            Self::LapLength => "length of a lap [m]",
            Self::LongestLap => "longest lap [s]",
            Self::PlannedMae => "distance from the route, as planned (MAE) [m]",
            Self::DrivenMae => "distance from the route, as driven (MAE) [m]",
            Self::PlannedMaa => "change of direction, as planned (MAA) [rad]",
            Self::DrivenMaa => "change of direction, as driven (MAA) [rad]",
            Self::LeftOut => "waypoints left out",
            Self::Coverage => "area visited",
        }
    }

    /// How the axis is divided.
    pub(super) fn unit(self) -> Unit {
        match self {
            Self::EscapeChance
            | Self::CaptureChance
            | Self::HeldOutChance
            | Self::EscapePossible
            | Self::LeftOut
            | Self::Coverage => Unit::Share,
            _ => Unit::Number,
        }
    }
}
