//! World with one robot on patrol, driven tick by tick.

#![allow(dead_code, reason = "each test file uses a part of it")]

use core::time::Duration;
use std::sync::Arc;

use geometry::blur::BlurredMap;
use geometry::grid::Grid;
use geometry::map::{MapSpec, ObstacleSpec, VectorMap};
use geometry::pose::Pose2;
use geometry::shape::Shape;
use planner_view::free_space::FreeSpace;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::{RobotView, ScanView, View};
use planner_view::waypoint::WaypointReport;
use robot::spec::{LimitsSpec, RobotModel, RobotSpec, ScanSpec};
use robot::team::Role;
use sim_backend::spec::{RulesSpec, WorldSpec};
use sim_backend::world::World;

/// Tick of the drive.
const TICK: Duration = Duration::from_millis(50);

/// The papers' sensor: it reaches half a metre from the robot's edge.
fn sensor(radius: f64) -> ScanSpec {
    ScanSpec {
        beams: 120,
        angle_min: 0.0,
        angle_increment: core::f64::consts::TAU / 120.0,
        range_min: 0.0,
        range_max: radius + 0.5,
        noise: 0.0,
    }
}

/// A robot of 1 m/s at a pose.
pub fn robot(start: Pose2) -> RobotSpec {
    let mut spec = RobotSpec::new("walle", Role::Neutral, start);
    spec.radius = Some(0.15);
    spec.limits = LimitsSpec {
        v_max: Some(1.0),
        v_reverse_max: Some(0.0),
        omega_max: Some(6.0),
        wheel_speed_max: Some(10.0),
        ..LimitsSpec::default()
    };
    spec.scan = Some(sensor(0.15));
    spec
}

/// Returns the robot model that a planner receives.
pub fn model(start: Pose2) -> RobotModel {
    robot(start).model()
}

/// Steering of a planner in a tick.
pub trait Steers {
    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering;
    fn reports(&self) -> &[WaypointReport];
}

/// Result of a drive.
pub struct Drive {
    pub world: World,
    pub reports: Vec<WaypointReport>,
    pub poses: Vec<Pose2>,
}

impl Drive {
    /// Contacts with anything.
    pub fn contacts(&self) -> u64 {
        let counts = self.world.robots()[0].contacts;
        u64::from(counts.wall) + u64::from(counts.robot)
    }
}

/// A world map from (−4, −4) to (19, 19) with these obstacles.
pub fn drive(
    obstacles: Vec<Shape>,
    start: Pose2,
    seconds: f64,
    planner: &mut impl Steers,
) -> Drive {
    let mut map = VectorMap::empty([-4.0, -4.0], [19.0, 19.0], 0.1);
    map.obstacles = obstacles
        .into_iter()
        .map(|shape| ObstacleSpec {
            name: String::new(),
            shape,
        })
        .collect();
    let mut world = World::new(WorldSpec {
        map: MapSpec::Vector(map),
        robots: vec![robot(start)],
        rules: RulesSpec::default(),
        seed: 1,
    })
    .unwrap();
    let planner_map = planner_map(&world);
    let (mut ranges, mut reports, mut poses) = (Vec::new(), Vec::new(), Vec::new());
    while world.time().as_secs_f64() < seconds {
        let spec = *world.scan(0, &mut ranges).unwrap();
        let state = &world.robots()[0];
        poses.push(state.pose);
        let robots = [RobotView {
            index: 0,
            team: Role::Neutral.into(),
            active: true,
            present: true,
            pose: state.pose,
            twist: state.twist,
            radius: state.radius(),
            v_max: 1.0,
        }];
        let view = View {
            time_s: world.time().as_secs_f64(),
            dt: TICK.as_secs_f64(),
            me: 0,
            robots: &robots,
            beliefs: &[],
            exits: &[],
            scan: Some(ScanView {
                angle_min: spec.angle_min,
                angle_increment: spec.angle_increment,
                range_min: spec.range_min,
                range_max: spec.range_max,
                ranges: &ranges,
            }),
        };
        let command = planner.steer(&planner_map, &view).command;
        reports.extend_from_slice(planner.reports());
        world.step(&[Some(command)], TICK);
    }
    Drive {
        world,
        reports,
        poses,
    }
}

/// Returns the exact geometry; the planners here do not use the grids.
pub fn planner_map(world: &World) -> PlannerMap {
    let map = world.map();
    let space = FreeSpace::new(map.parts().to_vec(), *map.bounds(), 0.1).unwrap();
    let blurred = BlurredMap::new(&Grid::filled(*map.frame(), true), 0.1).unwrap();
    PlannerMap::new(blurred, Grid::filled(*map.frame(), 1.0), 1)
        .unwrap()
        .with_space(Arc::new(space))
}
