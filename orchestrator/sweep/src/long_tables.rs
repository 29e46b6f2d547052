//! Tables of results with several rows per mission: its robots, the predictions of its observers, and its adversaries.

use super::columns::{Part, ResultColumn};
use super::row::Row;
use recorder::{AttackTotals, LapFigures, PredictionOutcome, RobotOutcome, WaypointOutcome};

impl Part<Row> for RobotOutcome {
    const TABLE: &'static str = "robots";
    const REFERENCE: [&'static str; 2] = ["Robots", "one row per mission and robot"];

    const COLUMNS: &'static [ResultColumn<Self>] = &[
        ResultColumn::text("robot", "Name of the robot.", |r| &r.name),
        ResultColumn::text("team", "Name of its team.", |r| &r.team),
        ResultColumn::text(
            "role",
            "Role of its team: `pursuer`, `evader` or `neutral`.",
            |r| r.role(),
        ),
        ResultColumn::text(
            "outcome",
            "`active`, `caught`, `escaped`, `timed_out`, `goal_reached` or `disabled`.",
            |r| &r.outcome,
        ),
        ResultColumn::float(
            "time_s",
            "Time of the outcome, or of the end of the run for an active robot (s).",
            |r| Some(r.time_s),
        ),
        ResultColumn::float("distance_m", "Distance (m).", |r| Some(r.distance_m)),
        ResultColumn::int("contacts", "Contact episodes.", |r| Some(r.contacts.into())),
        ResultColumn::int("fail_safe_stops", "Fail-safe stops.", |r| {
            Some(r.fail_safe_stops.into())
        }),
        ResultColumn::int("fail_safe_ticks", "Ticks in fail-safe stops.", |r| {
            Some(r.fail_safe_ticks)
        }),
        ResultColumn::int("standstills", "Standstills before its goal.", |r| {
            Some(r.standstills.into())
        }),
        ResultColumn::float(
            "escape_possible_fraction",
            "Part of its game in which it could escape, 0 to 1; empty unless a `referee` judged it.",
            |r| r.escape_possible_fraction,
        ),
        ResultColumn::float(
            "escape_impossible_from_s",
            "Simulated time from which it could not escape (s); empty without a `referee` or such a time.",
            |r| r.escape_impossible_from_s,
        ),
        ResultColumn::int(
            "waypoints_reached",
            "Waypoints reached; this and all following columns are empty unless its planner visits waypoints.",
            |r| waypoints(r, |w| Some(w.reached)),
        ),
        ResultColumn::int(
            "waypoints_inside_obstacle",
            "Waypoints left out because they are inside an obstacle that the robot knows.",
            |r| waypoints(r, |w| Some(w.inside_obstacle)),
        ),
        ResultColumn::int(
            "waypoints_timed_out",
            "Waypoints left out because they were not reached in time.",
            |r| waypoints(r, |w| Some(w.timed_out)),
        ),
        ResultColumn::int(
            "waypoints_unreachable",
            "Waypoints left out because no path leads to them.",
            |r| waypoints(r, |w| Some(w.unreachable)),
        ),
        ResultColumn::int(
            "waypoints_stuck",
            "Waypoints left out because the robot did not get on.",
            |r| waypoints(r, |w| Some(w.stuck)),
        ),
        ResultColumn::int(
            "route_left_out",
            "Waypoints left out that belong to the route.",
            |r| waypoints(r, |w| Some(w.route_left_out)),
        ),
        ResultColumn::float(
            "farthest_m",
            "Maximum distance from a waypoint that counts as reached (m).",
            |r| waypoints(r, |w| Some(w.farthest_m)),
        ),
        ResultColumn::int("laps", "Laps; empty without a route.", |r| {
            waypoints(r, |w| w.laps.map(u64::from))
        }),
        ResultColumn::float("longest_lap_s", "Maximum duration of a lap (s).", |r| {
            waypoints(r, |w| w.longest_lap_s)
        }),
        ResultColumn::float("lap_limit_s", "Time limit of a lap (s).", |r| {
            waypoints(r, |w| w.lap_limit_s)
        }),
        ResultColumn::float(
            "planned_length_m",
            "Mean length of a lap through all its waypoints (m); empty without a lap, like the following columns.",
            |r| planned(r, |f| f.length_m),
        ),
        ResultColumn::float(
            "planned_mae_m",
            "Mean distance of such a lap from the route, at equal times (m).",
            |r| planned(r, |f| f.mae_m),
        ),
        ResultColumn::float("planned_turns", "Mean changes of direction on it.", |r| {
            planned(r, |f| f.turns)
        }),
        ResultColumn::float(
            "planned_maa",
            "Mean change of direction on it, 0 to π (rad).",
            |r| planned(r, |f| f.maa),
        ),
        ResultColumn::float(
            "planned_maa_fold",
            "Mean change of direction on it, folded to an acute angle, 0 to π/2 (rad).",
            |r| planned(r, |f| f.maa_fold),
        ),
        ResultColumn::float("driven_length_m", "Mean length of a driven lap (m).", |r| {
            driven(r, |f| f.length_m)
        }),
        ResultColumn::float(
            "driven_mae_m",
            "Mean distance of a driven lap from the route, at equal times (m).",
            |r| driven(r, |f| f.mae_m),
        ),
        ResultColumn::float("driven_turns", "Mean changes of direction on it.", |r| {
            driven(r, |f| f.turns)
        }),
        ResultColumn::float(
            "driven_maa",
            "Mean change of direction on it, 0 to π (rad).",
            |r| driven(r, |f| f.maa),
        ),
        ResultColumn::float(
            "driven_maa_fold",
            "Mean change of direction on it, folded to an acute angle, 0 to π/2 (rad).",
            |r| driven(r, |f| f.maa_fold),
        ),
    ];

    fn rows(row: &Row) -> &[Self] {
        &row.robots
    }
}

fn waypoints<T>(
    robot: &RobotOutcome,
    value: impl FnOnce(&WaypointOutcome) -> Option<T>,
) -> Option<T> {
    robot.waypoints.as_ref().and_then(value)
}

fn planned(robot: &RobotOutcome, value: fn(&LapFigures) -> f64) -> Option<f64> {
    waypoints(robot, |w| w.planned.as_ref().map(value))
}

fn driven(robot: &RobotOutcome, value: fn(&LapFigures) -> f64) -> Option<f64> {
    waypoints(robot, |w| w.driven.as_ref().map(value))
}

impl Part<Row> for PredictionOutcome {
    const TABLE: &'static str = "predictions";
    const REFERENCE: [&'static str; 2] = [
        "Predictions",
        "one row per mission, `observer`, robot, predictor and horizon",
    ];

    const COLUMNS: &'static [ResultColumn<Self>] = &[
        ResultColumn::int("observer", "Index of the observer's process.", |p| {
            Some(p.observer.into())
        }),
        ResultColumn::text("robot", "Name of the observed robot.", |p| &p.robot),
        // `method` is a likely name of a parameter.
        ResultColumn::text("predictor", "Name of the method of prediction.", |p| {
            &p.method
        }),
        ResultColumn::float("horizon_s", "Prediction horizon (s).", |p| {
            Some(p.horizon_s)
        }),
        ResultColumn::int("predictions", "Evaluated predictions.", |p| {
            Some(p.predictions)
        }),
        ResultColumn::int("without", "Times without a prediction.", |p| {
            Some(p.without)
        }),
        ResultColumn::float(
            "mean_m",
            "Mean error (m); empty without a prediction, like the other errors.",
            |p| p.mean_m,
        ),
        ResultColumn::float("median_m", "Median error (m).", |p| p.median_m),
        ResultColumn::float("rms_m", "Root mean square error (m).", |p| p.rms_m),
        ResultColumn::int("goals_observed", "Goals that the method observed.", |p| {
            Some(p.goals_observed.into())
        }),
        ResultColumn::float(
            "key_recovered_s",
            "Simulated time at which it first knew the key (s); empty if it never did.",
            |p| p.key_recovered_s,
        ),
        ResultColumn::int(
            "key_recovered_after",
            "Goals observed by then; empty if it never knew the key.",
            |p| p.key_recovered_after.map(u64::from),
        ),
    ];

    fn rows(row: &Row) -> &[Self] {
        &row.predictions
    }
}

impl Part<Row> for AttackTotals {
    const TABLE: &'static str = "adversaries";
    const REFERENCE: [&'static str; 2] = [
        "Adversaries",
        "one row per mission and adversary that has attacked",
    ];

    const COLUMNS: &'static [ResultColumn<Self>] = &[
        ResultColumn::text("attacker", "Name of its process.", |a| &a.attacker),
        // `method` is a likely name of a parameter.
        ResultColumn::text(
            "adversary",
            "Method by which it chooses place and time: `random`, `history`, `statistical` or `best_response`.",
            |a| &a.method,
        ),
        ResultColumn::int("attacks", "Attacks that ended in the run.", |a| {
            Some(a.attacks.into())
        }),
        ResultColumn::int("attacks_detected", "Attacks that guards detected.", |a| {
            Some(a.detected.into())
        }),
    ];

    fn rows(row: &Row) -> &[Self] {
        &row.attacks
    }
}
