//! Tables of results with several rows per mission: its robots, the predictions of its observers, and its adversaries.

use super::columns::{Part, ResultColumn, columns};
use super::row::Row;
use recorder::{AttackTotals, LapFigures, PredictionOutcome, RobotOutcome, WaypointOutcome};

impl Part<Row> for RobotOutcome {
    const TABLE: &'static str = "robots";
    const REFERENCE: [&'static str; 2] = ["Robots", "one row per mission and robot"];

    const COLUMNS: &'static [ResultColumn<Self>] = columns! { r;
        Text "robot", "Name of the robot." => r.name.as_str();
        Text "team", "Name of its team." => r.team.as_str();
        Text "role", "Role of its team: `pursuer`, `evader` or `neutral`." => r.role();
        Text "outcome", "`active`, `caught`, `escaped`, `timed_out`, `goal_reached` or `disabled`."
            => r.outcome.as_str();
        F64 "time_s", "Time of the outcome, or of the end of the run for an active robot (s)." => r.time_s;
        F64 "distance_m", "Distance (m)." => r.distance_m;
        Int "contacts", "Contact episodes." => r.contacts;
        Int "fail_safe_stops", "Fail-safe stops." => r.fail_safe_stops;
        Int "fail_safe_ticks", "Ticks in fail-safe stops." => r.fail_safe_ticks;
        Int "standstills", "Standstills before its goal." => r.standstills;
        F64 "escape_possible_fraction",
            "Part of its game in which it could escape, 0 to 1; empty unless a `referee` judged it."
            => r.escape_possible_fraction;
        F64 "escape_impossible_from_s",
            "Simulated time from which it could not escape (s); empty without a `referee` or such a time."
            => r.escape_impossible_from_s;
        Int "waypoints_reached",
            "Waypoints reached; this and all following columns are empty unless its planner visits waypoints."
            => waypoints(r, |w| Some(w.reached));
        Int "waypoints_inside_obstacle", "Waypoints left out because they are inside an obstacle that the robot knows."
            => waypoints(r, |w| Some(w.inside_obstacle));
        Int "waypoints_timed_out", "Waypoints left out because they were not reached in time."
            => waypoints(r, |w| Some(w.timed_out));
        Int "waypoints_unreachable", "Waypoints left out because no path leads to them."
            => waypoints(r, |w| Some(w.unreachable));
        Int "waypoints_stuck", "Waypoints left out because the robot did not get on."
            => waypoints(r, |w| Some(w.stuck));
        Int "route_left_out", "Waypoints left out that belong to the route."
            => waypoints(r, |w| Some(w.route_left_out));
        F64 "farthest_m", "Maximum distance from a waypoint that counts as reached (m)."
            => waypoints(r, |w| Some(w.farthest_m));
        Int "laps", "Laps; empty without a route." => waypoints(r, |w| w.laps);
        F64 "longest_lap_s", "Maximum duration of a lap (s)." => waypoints(r, |w| w.longest_lap_s);
        F64 "lap_limit_s", "Time limit of a lap (s)." => waypoints(r, |w| w.lap_limit_s);
        F64 "planned_length_m",
            "Mean length of a lap through all its waypoints (m); empty without a lap, like the following columns."
            => planned(r, |f| f.length_m);
        F64 "planned_mae_m", "Mean distance of such a lap from the route, at equal times (m)."
            => planned(r, |f| f.mae_m);
        F64 "planned_turns", "Mean changes of direction on it." => planned(r, |f| f.turns);
        F64 "planned_maa", "Mean change of direction on it, 0 to π (rad)." => planned(r, |f| f.maa);
        F64 "planned_maa_fold", "Mean change of direction on it, folded to an acute angle, 0 to π/2 (rad)."
            => planned(r, |f| f.maa_fold);
        F64 "driven_length_m", "Mean length of a driven lap (m)." => driven(r, |f| f.length_m);
        F64 "driven_mae_m", "Mean distance of a driven lap from the route, at equal times (m)."
            => driven(r, |f| f.mae_m);
        F64 "driven_turns", "Mean changes of direction on it." => driven(r, |f| f.turns);
        F64 "driven_maa", "Mean change of direction on it, 0 to π (rad)." => driven(r, |f| f.maa);
        F64 "driven_maa_fold", "Mean change of direction on it, folded to an acute angle, 0 to π/2 (rad)."
            => driven(r, |f| f.maa_fold);
    };

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

    const COLUMNS: &'static [ResultColumn<Self>] = columns! { p;
        Int "observer", "Index of the observer's process." => p.observer;
        Text "robot", "Name of the observed robot." => p.robot.as_str();
        // `method` is a likely name of a parameter.
        Text "predictor", "Name of the method of prediction." => p.method.as_str();
        F64 "horizon_s", "Prediction horizon (s)." => p.horizon_s;
        Int "predictions", "Evaluated predictions." => p.predictions;
        Int "without", "Times without a prediction." => p.without;
        F64 "mean_m", "Mean error (m); empty without a prediction, like the other errors." => p.mean_m;
        F64 "median_m", "Median error (m)." => p.median_m;
        F64 "rms_m", "Root mean square error (m)." => p.rms_m;
        Int "goals_observed", "Goals that the method observed." => p.goals_observed;
        F64 "key_recovered_s", "Simulated time at which it first knew the key (s); empty if it never did."
            => p.key_recovered_s;
        Int "key_recovered_after", "Goals observed by then; empty if it never knew the key." => p.key_recovered_after;
    };

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

    const COLUMNS: &'static [ResultColumn<Self>] = columns! { a;
        Text "attacker", "Name of its process." => a.attacker.as_str();
        // `method` is a likely name of a parameter.
        Text "adversary",
            "Method by which it chooses place and time: `random`, `history`, `statistical` or `best_response`."
            => a.method.as_str();
        Int "attacks", "Attacks that ended in the run." => a.attacks;
        Int "attacks_detected", "Attacks that guards detected." => a.detected;
    };

    fn rows(row: &Row) -> &[Self] {
        &row.attacks
    }
}
