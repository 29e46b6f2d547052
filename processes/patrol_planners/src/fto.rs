//! Patrol with fictive temporary obstacles: waypoints for the driver, and a scan with the fictive
//! obstacles.

mod params;

use parameters::{check, within};
use std::collections::VecDeque;

use chaotic_maps::AnySource;
use nalgebra::Point2;
use patrol::awg::{Awg, Laps};
use patrol::fto::{Carrier, Disc, Fto, merged};
use patrol::mission::{Drive, Mission, MissionError};
use patrol::mixed::{Method, MixedLaps, MixedParams};
use planner_view::free_space::FreeSpace;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use planner_view::waypoint::{Waypoint, WaypointKind, WaypointReport};
use robot::spec::RobotModel;

use crate::PatrolError;
use crate::round::Round;

pub use params::{PatrolFtoParams, Protection};

/// Source of waypoints.
#[derive(Debug, Clone)]
enum WaypointSource {
    /// The contour alone.
    Contour(Laps<AnySource>),
    /// The zig-zag, on legs that suit it.
    Mixed(Box<MixedLaps<AnySource>>),
}

impl WaypointSource {
    fn new(
        mission: &Mission,
        protection: Protection,
        mixed: MixedParams,
        start_s: f64,
    ) -> Result<Self, PatrolError> {
        let source = mission.key.source().map_err(MissionError::Key)?;
        let laps = Laps::from_clock(mission.awg.clone(), source, start_s);
        Ok(match protection {
            Protection::FictiveObstacles => Self::Contour(laps),
            Protection::Mixed => {
                let mixed = MixedLaps::new(mixed, laps).map_err(within("mixed"))?;
                Self::Mixed(Box::new(mixed))
            }
        })
    }

    fn awg(&self) -> &Awg {
        match self {
            Self::Contour(laps) => laps.awg(),
            Self::Mixed(laps) => laps.awg(),
        }
    }

    /// Returns the next waypoint, and `true` if fictive obstacles protect the path to it.
    fn next(&mut self, inside: impl Fn(Point2<f64>) -> bool) -> (Waypoint, bool) {
        match self {
            Self::Contour(laps) => {
                let mut passed_over = Vec::new();
                // All but the route counts as inside.
                let waypoint = laps.next_outside(|_| true, &mut passed_over);
                let awg = laps.awg();
                let threatened = awg
                    .place(waypoint.number)
                    .and_then(|(_, leg, _)| awg.legs(waypoint.lap).get(leg))
                    .is_some_and(|leg| leg.stretch.threatened);
                (waypoint, threatened)
            }
            Self::Mixed(laps) => {
                let (waypoint, method) = laps.next_waypoint(inside);
                (waypoint, method == Method::FictiveObstacles)
            }
        }
    }
}

/// One robot on patrol.
#[derive(Debug, Clone)]
pub struct PatrolFto {
    round: Round,
    protection: Protection,
    mixed: MixedParams,
    way: WaypointSource,
    fto: Fto,
    /// Numbers of the waypoints at the driver that have not ended; `true` if fictive obstacles
    /// protect the path to them.
    handed: VecDeque<(u64, bool)>,
    disc: Option<Disc>,
    ranges: Vec<f32>,
}

impl PatrolFto {
    /// Returns a robot that has not set out yet; `seed` is its own and makes the key if none is
    /// given.
    ///
    /// # Errors
    /// [`PatrolError`] naming the invalid parameter and its remedy.
    pub fn new(
        params: &PatrolFtoParams,
        drive: &Drive,
        model: &RobotModel,
        seed: u64,
    ) -> Result<Self, PatrolError> {
        check(params)?;
        let (mission, driver) = (&params.mission, &params.driver);
        let round = Round::new(mission, driver, params.obstacles_known, drive, model, seed)?;
        let way = WaypointSource::new(&round.mission, params.protection, params.mixed, 0.0)?;
        Ok(Self {
            round,
            protection: params.protection,
            mixed: params.mixed,
            way,
            fto: Fto::new(&params.fto)?,
            handed: VecDeque::new(),
            disc: None,
            ranges: Vec::new(),
        })
    }

    /// Fits the zig-zag of the mixture to the first map; later changes of the map do not change it.
    pub fn enter(&mut self, map: &PlannerMap) {
        // Legs among obstacles have another protection than a narrow zig-zag.
        if let Some(mission) = self.round.enter(map, false) {
            self.plan(mission, 0.0);
        }
    }

    /// Makes it one of the robots with these indices, which have the same task, itself included.
    #[must_use]
    pub fn in_team(mut self, robots: &[u32]) -> Self {
        let mission = self.round.join(robots);
        self.plan(mission, 0.0);
        self
    }

    /// Plans the waypoints of a mission from a time of a round on (s).
    fn plan(&mut self, mission: Mission, start_s: f64) {
        let way = WaypointSource::new(&mission, self.protection, self.mixed, start_s);
        if let Ok(way) = way {
            (self.way, self.round.mission) = (way, mission);
        }
    }

    /// Returns the mission with all choices made.
    pub fn mission(&self) -> &Mission {
        &self.round.mission
    }

    /// The zig-zag of the mixture.
    pub fn awg(&self) -> &Awg {
        self.way.awg()
    }

    /// Returns the current waypoint.
    pub fn current(&self) -> Option<&Waypoint> {
        self.round.driver.current()
    }

    /// Returns the fictive obstacle that it saw in the last tick.
    pub fn disc(&self) -> Option<&Disc> {
        self.disc.as_ref()
    }

    /// Returns the waypoints that ended in the last tick.
    pub fn reports(&self) -> &[WaypointReport] {
        &self.round.reports
    }

    /// Returns the command for this tick; a stop if its pose is not known.
    pub fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.enter(map);
        self.round.observe(view);
        self.disc = None;
        let Some(own) = view.own() else {
            return Steering::stop();
        };
        if let Some((mission, start_s)) = self.round.begin(own) {
            self.plan(mission, start_s);
        }
        let current = self.current().copied();
        // Called in every tick, so that its times do not depend on the robot's position.
        let disc = self.fto.at(
            view.time_s,
            &Carrier {
                pose: own.pose,
                radius: self.round.radius,
                reach: view.scan.map_or(0.0, |scan| scan.range_max),
                goal: current.map(|waypoint| waypoint.point),
            },
        );
        if current.is_some_and(|waypoint| self.is_protected(waypoint.number)) {
            self.disc = disc;
        }
        let scan = view
            .scan
            .as_ref()
            .map(|scan| merged(scan, &own.pose, self.disc.as_ref(), &mut self.ranges));
        let known = map
            .space()
            .map(AsRef::as_ref)
            .filter(|_| self.round.obstacles_known);
        let (way, handed, radius) = (&mut self.way, &mut self.handed, self.round.radius);
        let next = || {
            let (waypoint, protected) = way.next(|p| is_inside(known, p, radius));
            handed.push_back((waypoint.number, protected));
            Some(waypoint)
        };
        let steering = self.round.drive(map, view, own, scan, next, |_, _| None);
        self.take_note();
        steering
    }

    fn is_protected(&self, number: u64) -> bool {
        self.handed
            .iter()
            .any(|&(n, fictive)| n == number && fictive)
    }

    fn take_note(&mut self) {
        for report in &self.round.reports {
            let ended = report.waypoint.number;
            self.handed.retain(|&(number, _)| number > ended);
            if let WaypointSource::Mixed(laps) = &mut self.way
                && report.waypoint.kind == WaypointKind::Inserted
            {
                laps.report(&report.waypoint, report.outcome);
            }
        }
    }
}

/// Returns `true` if a robot of this radius cannot stand at a point, as far as it knows.
fn is_inside(known: Option<&FreeSpace>, p: Point2<f64>, radius: f64) -> bool {
    known.is_some_and(|known| !known.is_free(p, radius))
}
