//! The laps of a patrol, and the positions that an ally with the key predicts.

use ::patrol::forecast::{Forecast, ForecastPosition};
use ::patrol::mission::{AlphaChoice, Drive, Mission};
use chaotic_maps::Key;
use geometry::map::WorldMap;
use geometry::pose::Twist2;
use metrics::path::PathMetrics;
use metrics::track::Track;
use patrol_planners::PatrolAwgParams;
use patrol_planners::check::{Waypoints, room_of, warnings};
use planner_view::view::{RobotView, View};
use planner_view::waypoint::{Waypoint, WaypointKind};
use robot::spec::RobotSpec;
use serde_json::{Value as Json, json};

use super::{RouteError, Router};
use scenario::ResolvedScenario;

/// Kinds that patrol along a zig-zag path.
const KINDS: [&str; 1] = ["patrol_awg"];

/// A patrol with all its parameters.
#[derive(Debug)]
pub struct Patrol {
    /// Name of its process.
    pub process: String,
    /// Name of its robot.
    pub robot: String,
    /// Parts without protection, and waypoints where the robot does not fit.
    pub warnings: Vec<String>,
    mission: Mission,
    /// Time of its clock at which it begins (s).
    start_s: f64,
    forecast: Forecast,
}

impl Patrol {
    /// Creates the patrol of a scenario; `key` replaces its own key.
    ///
    /// # Errors
    /// [`RouteError`] if the scenario has no suitable process, or its planner refuses.
    pub fn from_scenario(
        scenario: &ResolvedScenario,
        process: Option<&str>,
        key: Option<Key>,
    ) -> Result<Self, RouteError> {
        let router = Router::find(scenario, &KINDS, process)?;
        let refused = |reason: &dyn std::fmt::Display| router.refused(reason);
        let mut params: PatrolAwgParams = router.params::<PatrolAwgParams>()?.clone();
        if key.is_some() {
            params.mission.key = key;
        }
        let drive = Drive::from_model(&router.robot.model()).map_err(|e| refused(&e))?;
        let mission = params
            .mission
            .prepare(&drive, &params.driver.go_to, router.seed(scenario))
            .map_err(|e| refused(&e))?;
        let world_map = WorldMap::recent(&scenario.world.map).map_err(|e| refused(&e))?;
        let (map, radius) = (world_map.shapes(), router.robot.model().radius);
        let own = router.process.robots.first().copied().unwrap_or(0);
        let team = scenario.companions(own);
        let room = room_of(map, params.obstacles_known, radius);
        let mission = mission.of_team(team.len()).within(&room);
        let number = team.iter().position(|&robot| robot == own).unwrap_or(0);
        let spreads = params.mission.start.spreads(team.len());
        // A key from elsewhere is that of the robot itself.
        let mission = match key {
            None if spreads => mission.of_robot(number),
            _ => mission,
        };
        let source = mission.key.source().map_err(|e| refused(&e))?;
        let start_s = start_s(&mission, &scenario.world.robots, &team, own);
        Ok(Self {
            start_s,
            process: router.process.name.clone(),
            robot: router.robot.name.clone(),
            forecast: Forecast::new(mission.awg.clone(), source),
            warnings: warnings(&mission, Waypoints::ZigZag, map, radius),
            mission,
        })
    }

    /// Returns the width of its zig-zag (m).
    pub fn alpha(&self) -> f64 {
        self.mission.awg.params().alpha
    }

    /// Returns the origin of the width.
    pub fn alpha_choice(&self) -> AlphaChoice {
        self.mission.alpha_choice
    }

    /// Returns the maximum time of a lap (s).
    pub fn t_max(&self) -> f64 {
        self.mission.awg.params().t_max
    }

    /// Returns the speed along its contour (m/s).
    pub fn v(&self) -> f64 {
        self.mission.awg.v()
    }

    /// Returns its key.
    pub fn key(&self) -> &Key {
        &self.mission.key
    }

    /// Predicts its position at a time after its start, or that of its team's clock (s), by the schedule of its waypoints.
    ///
    /// # Errors
    /// [`RouteError::Refused`] for an invalid time or one too far ahead.
    pub fn at(&self, time_s: f64) -> Result<ForecastPosition, RouteError> {
        self.forecast
            .at_time(time_s + self.start_s)
            .map_err(|e| self.refused(&e))
    }

    /// Returns a waypoint by its number.
    ///
    /// # Errors
    /// [`RouteError::Refused`] for a number too far ahead.
    pub fn waypoint(&self, number: u64) -> Result<Waypoint, RouteError> {
        self.forecast.waypoint(number).map_err(|e| self.refused(&e))
    }

    /// Returns the first laps with their metrics.
    ///
    /// # Errors
    /// [`RouteError::Refused`] if the generator cannot produce these laps.
    pub fn laps(&self, count: u32) -> Result<Laps, RouteError> {
        let start = self.waypoint(0)?;
        let mut waypoints = vec![start];
        let mut tracks: Vec<Track> = Vec::new();
        for lap in 0..count {
            let of_lap = self.forecast.lap(lap).map_err(|e| self.refused(&e))?;
            let track = self.mission.awg.track(lap, &of_lap);
            // Return laps along an open contour are measured in the direction of the contour.
            let is_reversed = self.mission.contour.is_reversed_in(lap);
            tracks.push(if is_reversed { track.reversed() } else { track });
            waypoints.extend(of_lap);
        }
        let metrics = PathMetrics::from_laps(self.mission.contour.points(), &tracks, self.t_max());
        Ok(Laps { waypoints, metrics })
    }

    fn refused(&self, reason: &dyn std::fmt::Display) -> RouteError {
        RouteError::Refused {
            process: self.process.clone(),
            reason: reason.to_string(),
        }
    }

    /// Returns the waypoints of the first laps, and their metrics, as JSON.
    ///
    /// # Errors
    /// [`RouteError::Refused`] if the generator cannot produce these laps.
    pub fn plan_json(&self, count: u32) -> Result<Json, RouteError> {
        let laps = self.laps(count)?;
        let mut json = self.json();
        json["waypoints"] = laps.waypoints.iter().map(waypoint_json).collect();
        json["metrics"] = laps.metrics_json();
        Ok(json)
    }

    /// Returns the positions at times after the start (s), and waypoints by their numbers, as JSON.
    ///
    /// # Errors
    /// [`RouteError::Refused`] for an invalid time, and for a time or number too far ahead.
    pub fn prediction_json(&self, times: &[f64], numbers: &[u64]) -> Result<Json, RouteError> {
        let at = |&t: &f64| {
            let place = self.at(t)?;
            Ok(json!({
                "t": t,
                "x": place.point.x,
                "y": place.point.y,
                "from": waypoint_json(&place.from),
                "to": waypoint_json(&place.to),
            }))
        };
        let waypoint = |&number: &u64| Ok(waypoint_json(&self.waypoint(number)?));
        let mut json = self.json();
        json["at"] = times.iter().map(at).collect::<Result<_, RouteError>>()?;
        json["waypoints"] = numbers
            .iter()
            .map(waypoint)
            .collect::<Result<_, RouteError>>()?;
        Ok(json)
    }

    /// Describes the patrol as JSON.
    fn json(&self) -> Json {
        let awg = &self.mission.awg;
        json!({
            "process": self.process,
            "robot": self.robot,
            "key": self.key().to_string(),
            "alpha": self.alpha(),
            "alpha_choice": self.alpha_choice().name(),
            "t_max": self.t_max(),
            "v": awg.v(),
            "contour_m": awg.contour_length(),
            "waypoints_per_lap": awg.waypoints_per_lap(),
            "lap_time_s": self.forecast.lap_time(),
            "start_s": self.start_s,
            "warnings": self.warnings,
        })
    }
}

/// Returns the time of the clock at which a robot begins (s), as it computes it from the starts of its team.
fn start_s(mission: &Mission, robots: &[RobotSpec], team: &[usize], own: usize) -> f64 {
    let view = |(index, robot): (usize, &RobotSpec)| RobotView {
        index,
        team: robot.role().into(),
        active: true,
        present: true,
        pose: robot.start,
        twist: Twist2::STOP,
        radius: robot.model().radius,
        v_max: robot.model().v_max,
    };
    let robots: Vec<RobotView> = robots.iter().enumerate().map(view).collect();
    let indices: Vec<u32> = team.iter().map(|&robot| robot as u32).collect();
    match (mission.team(&indices), robots.get(own)) {
        (Some(mut team), _) => {
            let view = View {
                time_s: 0.0,
                dt: 0.0,
                me: own,
                robots: &robots,
                beliefs: &[],
                exits: &[],
                scan: None,
            };
            team.observe(&mission.awg, &view);
            team.begin(own)
        }
        (None, Some(robot)) => mission.start_s(&robot.pose),
        (None, None) => 0.0,
    }
}

/// Laps of a patrol.
#[derive(Debug)]
pub struct Laps {
    /// Waypoints; the start comes first.
    pub waypoints: Vec<Waypoint>,
    /// Metrics; `None` without laps.
    pub metrics: Option<PathMetrics>,
}

impl Laps {
    /// Returns the metrics by their names in the papers.
    fn metrics_json(&self) -> Json {
        let Some(m) = &self.metrics else {
            return Json::Null;
        };
        json!({
            "laps": m.laps,
            "length_lap1": m.length_first,
            "length_mean": m.length_mean,
            "speed_lap1": m.speed_first,
            "speed": m.speed_mean,
            "mae_time": m.mae_time,
            "mae_lap": m.mae_lap,
            "mae_joint": m.mae_joint,
            "andc": m.andc,
            "maa_lap1": m.turns_first.maa,
            "maa": m.turns.maa,
            "maa_fold_lap1": m.turns_first.maa_fold,
            "maa_fold": m.turns.maa_fold,
            "ra": m.turns.range,
        })
    }
}

/// Writes a waypoint as JSON.
fn waypoint_json(waypoint: &Waypoint) -> Json {
    json!({
        "number": waypoint.number,
        "lap": waypoint.lap,
        "kind": kind_name(waypoint.kind),
        "x": waypoint.point.x,
        "y": waypoint.point.y,
    })
}

/// Returns the name of a kind of waypoints, as in messages.
pub(super) fn kind_name(kind: WaypointKind) -> &'static str {
    match kind {
        WaypointKind::Route => "route",
        WaypointKind::Inserted => "inserted",
        WaypointKind::SubGoal => "sub_goal",
        WaypointKind::Transit => "transit",
    }
}
