//! Waypoints of robots over a run: counts, durations of laps, deviation of the path from the route, and
//! changes of direction.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::robot::WaypointEnd;
use ipc_types::topics::{TopicId, Waypoints, WorldState};
use metrics::driven::{STRAIGHT_WITHIN, corners};
use metrics::path::{POINTS_PER_LAP, Polyline, Turns, mae_between, mae_time, seconds_per_waypoint};
use metrics::track::Track;
use nalgebra::Point2;

use super::run_info::RobotInfo;
use super::summary::{LapFigures, OutcomePart, Summary, WaypointOutcome};

/// Maximum number of kept waypoints and of kept positions of a robot; later ones are only in the log.
const MAX_POINTS: usize = 4_000_000;

/// A completed lap.
#[derive(Debug)]
struct Lap {
    began_s: f64,
    ended_s: f64,
    /// Start point and waypoints of the route.
    route: Vec<Point2<f64>>,
    /// Start point, waypoints of the route and inserted waypoints.
    way: Vec<Stop>,
}

/// A waypoint of a lap.
#[derive(Debug, Clone, Copy)]
struct Stop {
    at: Point2<f64>,
    of_the_route: bool,
    /// `true` if it lies inside an obstacle, so that it is not part of the planned path.
    is_inside: bool,
}

/// Waypoints of all robots.
#[derive(Debug)]
pub(super) struct AllVisits(Vec<Visits>);

impl AllVisits {
    /// Creates the collector for these robots.
    pub(super) fn new(robots: &[RobotInfo]) -> Self {
        Self(robots.iter().map(Visits::new).collect())
    }
}

impl Consumer for AllVisits {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::WorldState, TopicId::Waypoints]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        if let Some((_, robots)) = message.view::<WorldState>() {
            for state in robots {
                if let Some(visits) = self.0.get_mut(state.robot as usize) {
                    visits.state(message.time_s(), Point2::new(state.x, state.y));
                }
            }
        }
        if let Some((_, ends)) = message.view::<Waypoints>() {
            for end in ends {
                if let Some(visits) = self.0.get_mut(end.robot as usize) {
                    visits.add(&end);
                }
            }
        }
    }
}

impl OutcomePart for AllVisits {
    fn finish(self: Box<Self>, summary: &mut Summary) {
        for (robot, visits) in summary.robots.iter_mut().zip(self.0) {
            robot.waypoints = visits.finish();
        }
    }
}

/// Waypoints of a robot.
#[derive(Debug)]
struct Visits {
    /// `true` to keep the path. Does not follow from received waypoints, which may arrive before or after the
    /// state of their tick.
    keeps_track: bool,
    lap_limit_s: Option<f64>,
    /// `true` if a waypoint of a route has ended.
    has_route: bool,
    counts: [u64; WaypointEnd::OUTCOMES.len()],
    route_left_out: u64,
    farthest: f64,
    laps: Vec<Lap>,
    open: Option<OpenLap>,
    track: Track,
    waypoints: usize,
}

/// The current lap.
#[derive(Debug)]
struct OpenLap {
    lap: u32,
    is_part: bool,
    began_s: f64,
    route: Vec<Point2<f64>>,
    way: Vec<Stop>,
    /// Time at which the last waypoint of the route ended (s), and number of path points up to it.
    closed: Option<(f64, usize)>,
}

impl Visits {
    fn new(robot: &RobotInfo) -> Self {
        Self {
            keeps_track: robot.visits_waypoints,
            lap_limit_s: robot.lap_limit_s,
            has_route: false,
            counts: Default::default(),
            route_left_out: 0,
            farthest: 0.0,
            laps: Vec::new(),
            open: None,
            track: Track::default(),
            waypoints: 0,
        }
    }

    /// Adds the position of the robot at a time (s).
    fn state(&mut self, time_s: f64, at: Point2<f64>) {
        if self.keeps_track && self.track.points().len() < MAX_POINTS {
            self.track.push(time_s, at);
        }
    }

    /// Adds a waypoint that ended.
    fn add(&mut self, end: &WaypointEnd) {
        if let Some(count) = self.counts.get_mut(usize::from(end.outcome)) {
            *count += 1;
        }
        if end.outcome == 0 {
            self.farthest = self.farthest.max(end.closest);
        } else if end.kind == 0 {
            self.route_left_out += 1;
        }
        if self.waypoints >= MAX_POINTS {
            return;
        }
        self.waypoints += 1;
        let at = Point2::new(end.x, end.y);
        let of_the_route = end.kind == 0;
        self.has_route |= of_the_route;
        let Some(open) = &mut self.open else {
            // The path to the first waypoint belongs to no lap, and a lap that begins on the way is none.
            self.open = Some(OpenLap {
                is_part: end.number > 0,
                ..OpenLap::from(end.lap, end.ended_s, at)
            });
            return;
        };
        if end.lap != open.lap {
            let next = match open.closed {
                Some((ended_s, _)) => open
                    .route
                    .last()
                    .map(|&last| OpenLap::from(end.lap, ended_s, last)),
                None => None,
            };
            let next = next.unwrap_or_else(|| OpenLap::from(end.lap, end.ended_s, at));
            let done = core::mem::replace(open, next);
            self.laps.extend(done.lap());
        }
        open.way.push(Stop {
            at,
            of_the_route,
            is_inside: end.outcome == 1,
        });
        if of_the_route {
            open.route.push(at);
            open.closed = Some((end.ended_s, open.way.len()));
        }
    }

    /// Returns the outcome of the waypoints; `None` without waypoints.
    fn finish(mut self) -> Option<WaypointOutcome> {
        let open = self.open.take()?;
        // The last lap is complete if it reached its start or the end of the first lap.
        let last = open.route.last().copied();
        let ends = [
            open.route.first().copied(),
            self.laps.first().and_then(|lap| lap.route.last().copied()),
        ];
        if last.is_some() && ends.contains(&last) {
            self.laps.extend(open.lap());
        }
        let [reached, inside_obstacle, timed_out, unreachable, stuck] = self.counts;
        let (planned, driven): (Vec<_>, Vec<_>) = self
            .laps
            .iter()
            .map(|lap| (lap.planned(self.lap_limit_s), lap.driven(&self.track)))
            .unzip();
        Some(WaypointOutcome {
            reached,
            inside_obstacle,
            timed_out,
            unreachable,
            stuck,
            route_left_out: self.route_left_out,
            farthest_m: self.farthest,
            laps: self.has_route.then_some(self.laps.len() as u32),
            longest_lap_s: self
                .laps
                .iter()
                .map(|lap| lap.ended_s - lap.began_s)
                .max_by(f64::total_cmp),
            lap_limit_s: self.lap_limit_s.filter(|_| self.has_route),
            planned: LapFigures::mean(&planned),
            driven: LapFigures::mean(&driven),
        })
    }
}

impl OpenLap {
    fn from(lap: u32, began_s: f64, at: Point2<f64>) -> Self {
        Self {
            lap,
            is_part: false,
            began_s,
            route: vec![at],
            way: vec![Stop {
                at,
                of_the_route: true,
                is_inside: false,
            }],
            closed: None,
        }
    }

    /// Returns the lap up to its last waypoint of the route; `None` without one, and for a part of a lap.
    fn lap(mut self) -> Option<Lap> {
        let (ended_s, points) = self.closed.filter(|_| !self.is_part)?;
        self.way.truncate(points);
        Some(Lap {
            began_s: self.began_s,
            ended_s,
            route: self.route,
            way: self.way,
        })
    }
}

impl Lap {
    fn planned(&self, limit_s: Option<f64>) -> Option<LapFigures> {
        let track = self.track(limit_s);
        let mae = mae_time(&self.route, core::slice::from_ref(&track), POINTS_PER_LAP)?;
        Some(LapFigures::from_path(track.points(), track.points(), mae))
    }

    /// The planned path in the time of the patrol. Without a time limit of the lap (s), each leg
    /// takes a time in proportion to its length.
    fn track(&self, limit_s: Option<f64>) -> Track {
        let v = limit_s.map(|limit_s| Polyline::new(&self.route).length() / limit_s);
        let mut track = Track::default();
        let Some((start, rest)) = self.way.split_first() else {
            return track;
        };
        track.push(0.0, start.at);
        let (mut from, mut begun_s) = (start.at, 0.0);
        for leg in rest.split_inclusive(|stop| stop.of_the_route) {
            let Some(end) = leg.last() else {
                continue;
            };
            let length = (end.at - from).norm();
            let inserted = leg.len() as u64 - 1;
            let seconds = match v {
                Some(v) => seconds_per_waypoint(length, inserted, v),
                None => length / leg.len() as f64,
            };
            for (stop, number) in leg.iter().zip(1_u32..) {
                if !stop.is_inside {
                    track.push(begun_s + seconds * f64::from(number), stop.at);
                }
            }
            begun_s += seconds * leg.len() as f64;
            from = end.at;
        }
        track
    }

    fn driven(&self, track: &Track) -> Option<LapFigures> {
        let reference = Polyline::new(&self.route);
        let mae = mae_between(
            &reference,
            track,
            self.began_s,
            self.ended_s,
            POINTS_PER_LAP,
        )?;
        let way = track.between(self.began_s, self.ended_s);
        Some(LapFigures::from_path(
            &way,
            &corners(&way, STRAIGHT_WITHIN),
            mae,
        ))
    }
}

impl LapFigures {
    fn from_path(way: &[Point2<f64>], corners: &[Point2<f64>], mae_m: f64) -> Self {
        let turns = Turns::from_path(corners);
        Self {
            length_m: Polyline::new(way).length(),
            mae_m,
            turns: turns.count as f64,
            maa: turns.maa,
            maa_fold: turns.maa_fold,
        }
    }

    /// Returns the mean over the laps that have figures.
    fn mean(laps: &[Option<Self>]) -> Option<Self> {
        let known: Vec<&Self> = laps.iter().flatten().collect();
        let mean = |part: fn(&Self) -> f64| {
            known.iter().map(|figures| part(figures)).sum::<f64>() / known.len() as f64
        };
        (!known.is_empty()).then(|| Self {
            length_m: mean(|f| f.length_m),
            mae_m: mean(|f| f.mae_m),
            turns: mean(|f| f.turns),
            maa: mean(|f| f.maa),
            maa_fold: mean(|f| f.maa_fold),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the waypoints of laps around a square; each side has a point beside its middle.
    fn laps(count: u32) -> Vec<WaypointEnd> {
        let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let mut ends = vec![end(0, 0, [0.0, 0.0], 0.0)];
        for lap in 0..count {
            for side in 0..4 {
                let (from, to) = (corners[side], corners[(side + 1) % 4]);
                let time = f64::from(lap) * 16.0 + side as f64 * 4.0;
                let middle = [f64::midpoint(from[0], to[0]), f64::midpoint(from[1], to[1])];
                let beside = [middle[0] * 0.9 + 0.2, middle[1] * 0.9 + 0.2];
                ends.push(end(lap, 1, beside, time + 2.0));
                ends.push(end(lap, 0, to, time + 4.0));
            }
        }
        ends
    }

    fn end(lap: u32, kind: u8, [x, y]: [f64; 2], ended_s: f64) -> WaypointEnd {
        WaypointEnd {
            x,
            y,
            ended_s,
            lap,
            kind,
            closest: 0.05,
            ..WaypointEnd::default()
        }
    }

    fn new() -> Visits {
        Visits::new(&RobotInfo {
            name: "guard".into(),
            team: "neutral".into(),
            radius: 0.2,
            visits_waypoints: true,
            lap_limit_s: Some(15.0),
        })
    }

    fn visits(ends: &[WaypointEnd]) -> Option<WaypointOutcome> {
        let mut visits = new();
        for end in ends {
            visits.state(end.ended_s, Point2::new(end.x, end.y));
            visits.add(end);
        }
        // In another order, as with a late state.
        let mut late = new();
        for end in ends {
            late.add(end);
        }
        for end in ends {
            late.state(end.ended_s, Point2::new(end.x, end.y));
        }
        let outcome = visits.finish();
        assert_eq!(late.finish(), outcome);
        outcome
    }

    #[test]
    fn a_robot_without_waypoints_has_no_outcome() {
        let mut idle = new();
        idle.state(1.0, Point2::origin());
        assert!(idle.finish().is_none());
    }

    #[test]
    fn laps_are_counted_and_measured_as_planned_and_as_driven() {
        let outcome = visits(&laps(3)).unwrap();
        assert_eq!((outcome.laps, outcome.reached), (Some(3), 25));
        assert_eq!(outcome.longest_lap_s, Some(16.0));
        assert_eq!(outcome.lap_limit_s, Some(15.0));
        assert_eq!(outcome.farthest_m, 0.05);
        let (planned, driven) = (outcome.planned.unwrap(), outcome.driven.unwrap());
        assert_eq!(planned.turns, 7.0);
        // The robot was at every waypoint when it ended.
        assert!((planned.length_m - driven.length_m).abs() < 1e-9);
        assert!(
            (planned.mae_m - driven.mae_m).abs() < 1e-9,
            "{planned:?} {driven:?}"
        );
        assert!(planned.length_m > 16.0 && planned.mae_m > 0.01);
    }

    #[test]
    fn a_planned_lap_along_its_route_has_no_error_whatever_its_legs() {
        let corners = [[9.0, 0.0], [9.0, 1.0], [3.0, 1.0], [0.0, 0.0]];
        let mut ends = vec![end(0, 0, [0.0, 0.0], 0.0)];
        for (lap, second) in [(0, 0.0), (1, 20.0)] {
            for (corner, at_s) in corners.into_iter().zip([9.0, 10.0, 16.0, 19.0]) {
                ends.push(end(lap, 0, corner, second + at_s));
            }
        }
        let planned = visits(&ends).unwrap().planned.unwrap();
        assert!(planned.mae_m < 1e-9, "{planned:?}");
    }

    #[test]
    fn a_lap_that_is_not_complete_does_not_count() {
        let mut ends = laps(2);
        ends.truncate(ends.len() - 3);
        assert_eq!(visits(&ends).unwrap().laps, Some(1));
        assert_eq!(visits(&laps(1)[..2]).unwrap().laps, Some(0));
    }

    #[test]
    fn a_lap_that_begins_on_the_way_does_not_count() {
        let mut ends = laps(3);
        for (number, end) in (0..).zip(&mut ends) {
            end.number = number;
        }
        assert_eq!(visits(&ends).unwrap().laps, Some(3));
        // A guard of a spread team begins at a corner within the lap.
        let late = visits(&ends[4..]).unwrap();
        assert_eq!((late.laps, late.longest_lap_s), (Some(2), Some(16.0)));
        assert_eq!(late.planned, visits(&laps(2)).unwrap().planned);
    }

    #[test]
    fn a_coverage_has_no_laps() {
        let ends = [2, 3, 2].map(|kind| end(0, kind, [1.0, f64::from(kind)], 4.0));
        let outcome = visits(&ends).unwrap();
        assert_eq!((outcome.laps, outcome.lap_limit_s), (None, None));
        let json = serde_json::to_value(&outcome).unwrap();
        assert_eq!((json.get("laps"), &json["reached"]), (None, &3.into()));
    }

    #[test]
    fn a_waypoint_of_the_route_that_is_left_out_is_counted_apart() {
        let mut ends = laps(2);
        for (i, outcome) in [(2, 3), (3, 2), (4, 4)] {
            ends[i].outcome = outcome;
        }
        let outcome = visits(&ends).unwrap();
        let counts = (outcome.unreachable, outcome.timed_out, outcome.stuck);
        assert_eq!((counts, outcome.left_out()), ((1, 1, 1), 3));
        assert_eq!(outcome.route_left_out, 2);
    }

    #[test]
    fn omitted_waypoints_are_counted_and_not_part_of_the_path() {
        let mut ends = laps(2);
        ends[3].outcome = 1;
        ends[3].closest = f64::INFINITY;
        ends[5].outcome = 2;
        let outcome = visits(&ends).unwrap();
        let counts = (
            outcome.inside_obstacle,
            outcome.timed_out,
            outcome.unreachable,
        );
        assert_eq!(counts, (1, 1, 0));
        assert_eq!(outcome.route_left_out, 0);
        assert_eq!(outcome.farthest_m, 0.05);
        let whole = visits(&laps(2)).unwrap();
        assert!(outcome.planned.unwrap().turns < whole.planned.unwrap().turns);
    }
}
