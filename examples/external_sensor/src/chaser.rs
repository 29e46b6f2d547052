//! A planner that drives to the nearest tracked opponent.

use ipc_types::bus::{Bus, Subscriber};
use planner::control::go_to::{GoToParams, go_to};
use planner::nalgebra::Point2;
use planner::{
    Declaration, Input, Limits, Planner, PlannerError, PlannerMap, RobotInfo, Steering, View,
    limits,
};
use runtime::declaration::{Flow, When};
use runtime::{ProcessConfig, ProcessError};

use crate::messages::{Track, Tracks};

/// The planner of one robot.
pub struct Chaser {
    limits: Limits,
    tracks: Option<Subscriber<Tracks>>,
    newest: Vec<Track>,
    failure: Option<ProcessError>,
}

impl Planner for Chaser {
    const NAME: &'static str = "bearing_chaser";
    const SUMMARY: &'static str = "drives to the nearest robot that the tracker knows";

    type Params = ();

    fn declare((): &()) -> Declaration {
        let tracks = Input::new(Flow::for_topic::<Tracks>(), When::ThisTick);
        Declaration::default().reads(tracks)
    }

    fn new((): &(), robot: &RobotInfo, _seed: u64) -> Result<Self, PlannerError> {
        Ok(Self {
            limits: limits(robot)?,
            tracks: None,
            newest: Vec::new(),
            failure: None,
        })
    }

    fn open(&mut self, _: &ProcessConfig, bus: &Bus, _robot: u32) -> Result<(), ProcessError> {
        self.tracks = Some(bus.subscriber()?);
        Ok(())
    }

    fn failure(&mut self) -> Option<ProcessError> {
        self.failure.take()
    }

    fn steer(&mut self, _: &PlannerMap, view: &View<'_>) -> Steering {
        if let Err(error) = self.receive() {
            self.failure = Some(error);
        }
        let me = &view.robots[view.me];
        let distance = |track: &&Track| (Point2::new(track.x, track.y) - me.pose.position()).norm();
        let nearest = self
            .newest
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let Some(target) = nearest else {
            return Steering::stop();
        };
        let point = Point2::new(target.x, target.y);
        Steering {
            command: go_to(
                &me.pose,
                point,
                None,
                &self.limits,
                &GoToParams::default(),
                view.dt,
            ),
            waypoint: Some(point),
            aim: Some(point),
            target: Some(target.robot as usize),
            ..Steering::stop()
        }
    }
}

impl Chaser {
    fn receive(&mut self) -> Result<(), ProcessError> {
        let Some(tracks) = &self.tracks else {
            return Ok(());
        };
        while let Some(message) = tracks.receive()? {
            let sound = |track: &&Track| track.x.is_finite() && track.y.is_finite();
            self.newest = message.elements().iter().filter(sound).copied().collect();
        }
        Ok(())
    }
}
