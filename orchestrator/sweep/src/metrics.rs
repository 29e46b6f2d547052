//! Metrics of figures: name, unit, axis label and value of each in one place.

use draw::figures::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use statistics::{Mean, Sample, Z95};

use super::row::Row;
use recorder::{LapFigures, WaypointOutcome};

/// Function of a metric over the rows of a cell.
enum Value {
    /// Share of evaders: the function counts those of a row.
    Chance(fn(&Row) -> u32),
    /// Mean over the rows that have a value.
    Mean(fn(&Row) -> Option<f64>),
}

/// A metric: division and label of its axis, and its function of rows.
struct Definition {
    unit: Unit,
    label: &'static str,
    value: Value,
}

macro_rules! metrics {
    ($($(#[$attribute:meta])* $name:ident: $unit:ident, $label:literal, $value:expr;)*) => {
        /// Quantity of each cell that a figure shows.
        #[derive(
            Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema,
        )]
        #[serde(rename_all = "snake_case")]
        pub enum Metric {
            $($(#[$attribute])* $name,)*
        }

        impl Metric {
            fn definition(self) -> Definition {
                use Value::{Chance, Mean};
                match self {
                    $(Self::$name => Definition {
                        unit: Unit::$unit,
                        label: $label,
                        value: $value,
                    },)*
                }
            }
        }
    };
}

metrics! {
    /// Escaped evaders of all evaders, 0 to 1.
    #[default]
    EscapeChance: Share, "evaders that escape", Chance(|r| r.escaped);
    /// Caught evaders of all evaders, 0 to 1.
    CaptureChance: Share, "evaders that are caught", Chance(|r| r.caught);
    /// Evaders that were neither caught nor escaped in time, of all evaders, 0 to 1.
    HeldOutChance: Share, "evaders that hold out", Chance(|r| r.held_out);
    /// Mean simulated length of a game (s).
    GameTime: Number, "length of a game [s]", Mean(|r| Some(r.sim_time_s));
    /// Mean simulated time of the first capture, of games that have one (s).
    FirstCapture: Number, "time of the first capture [s]", Mean(|r| r.first_capture_s);
    /// Mean simulated time of the first escape, of games that have one (s).
    FirstEscape: Number, "time of the first escape [s]", Mean(|r| r.first_escape_s);
    /// Mean number of contact episodes of all robots per game.
    Contacts: Number, "contacts per game", Mean(|r| Some(f64::from(r.contacts)));
    /// Mean speed of the evaders while they were in the game (m/s).
    EvaderMeanSpeed: Number, "mean speed of the evaders [m/s]", Mean(|r| r.evader_mean_speed);
    /// Mean part of the game in which an escape was possible, 0 to 1; needs a `referee`.
    EscapePossible: Share, "part of the game in which an escape is possible",
        Mean(|r| r.escape_possible_fraction);
    /// Mean length of a lap through all its waypoints, of the robots that complete laps (m).
    LapLength: Number, "length of a lap [m]", Mean(|r| laps(r, |w| Some(w.planned?.length_m)));
    /// Mean time of the longest lap (s).
    LongestLap: Number, "longest lap [s]", Mean(|r| laps(r, |w| w.longest_lap_s));
    /// Mean distance of a lap through all its waypoints from the route, at equal times in the time of the patrol (m).
    PlannedMae: Number, "distance from the route, as planned (MAE) [m]",
        Mean(|r| planned(r, |f| f.mae_m));
    /// Mean distance of driven laps from the route (m).
    DrivenMae: Number, "distance from the route, as driven (MAE) [m]",
        Mean(|r| driven(r, |f| f.mae_m));
    /// Mean change of direction on laps through all their waypoints (rad).
    PlannedMaa: Number, "change of direction, as planned (MAA) [rad]",
        Mean(|r| planned(r, |f| f.maa));
    /// Mean change of direction on driven laps (rad).
    DrivenMaa: Number, "change of direction, as driven (MAA) [rad]",
        Mean(|r| driven(r, |f| f.maa));
    /// Waypoints left out, of all, 0 to 1.
    LeftOut: Share, "waypoints left out", Mean(|r| laps(r, |w| Some(w.left_out_share())));
    /// Visited part of the area that can be visited, 0 to 1; needs `[rules.coverage]`.
    Coverage: Share, "area visited", Mean(|r| Some(r.coverage.as_ref()?.coverable_fraction));
}

impl Metric {
    /// Label of the axis.
    pub(super) fn label(self) -> &'static str {
        self.definition().label
    }

    /// Unit of the axis.
    pub(super) fn unit(self) -> Unit {
        self.definition().unit
    }

    /// The value of a cell's games and the ends of its 95 % interval; `None` if they have none.
    ///
    /// Chances are shares of evaders with an interval that counts games ([`Sample::interval`]); the
    /// rest are means over games with Student's interval, of the games that have the value.
    pub(super) fn measure(self, rows: &[&Row]) -> Option<(f64, Option<(f64, f64)>)> {
        match self.definition().value {
            Value::Chance(hits) => {
                let sample: Sample = rows.iter().map(|r| (hits(r), r.evaders)).collect();
                let interval = sample.interval(Z95);
                Some((sample.share()?, Some((interval.low, interval.high))))
            }
            Value::Mean(value) => {
                let values: Vec<f64> = rows.iter().filter_map(|r| value(r)).collect();
                let mean = Mean::of(&values)?;
                let interval = mean.interval();
                // One value gives no information about its error.
                let known = interval.low.is_finite() && interval.high.is_finite();
                Some((mean.value, known.then_some((interval.low, interval.high))))
            }
        }
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
