//! A robot in the simulated world, driven by its real planner.

use core::time::Duration;
use std::sync::Arc;

use guidance::free_space::FreeSpace;
use guidance::map::PlannerMap;
use guidance::view::{RobotView, ScanView, View};
use guidance::waypoint::WaypointReport;
use kit::RobotInfo;
use kit::planner::Planner;
use serde::Deserialize as _;
use sim_backend::blur::BlurredMap;
use sim_backend::grid::Grid;
use sim_backend::map::{MapSpec, ObstacleSpec, VectorMap};
use sim_backend::pose::Pose2;
use sim_backend::shape::Shape;
use sim_backend::spec::{LimitsSpec, RobotSpec, RulesSpec, ScanSpec, WorldSpec};
use sim_backend::team::Team;
use sim_backend::world::World;

/// Tick [s].
pub const DT: f64 = 0.05;

/// A world with one robot in it.
#[derive(Debug, Clone)]
pub struct Place {
    /// Corners of the ground [m].
    pub bounds: [[f64; 2]; 2],
    pub obstacles: Vec<Shape>,
    pub start: Pose2,
    /// Radius [m], speed [m/s] and turning rate [rad/s] of the robot.
    pub radius: f64,
    pub v_max: f64,
    pub omega_max: f64,
    /// Range of its sensor [m], if it has one.
    pub range: Option<f64>,
}

/// A robot with its planner.
pub struct Drive<P> {
    world: World,
    planner: P,
    map: PlannerMap,
    ranges: Vec<f32>,
    v_max: f64,
    pub reports: Vec<WaypointReport>,
}

impl<P: Planner> Drive<P> {
    /// With these parameters of the planner, as a scenario writes them.
    pub fn new(place: &Place, params: &str) -> Self {
        let mut spec = RobotSpec::new("guard", Team::Neutral, place.start);
        spec.radius = Some(place.radius);
        spec.wheel_separation = Some(1.5 * place.radius);
        spec.limits = LimitsSpec {
            v_max: Some(place.v_max),
            omega_max: Some(place.omega_max),
            ..LimitsSpec::default()
        };
        spec.scan = place.range.map(|range| ScanSpec {
            beams: 72,
            angle_min: 0.0,
            angle_increment: core::f64::consts::TAU / 72.0,
            range_min: 0.0,
            range_max: range,
            noise: 0.0,
        });
        let info = RobotInfo {
            name: "guard".into(),
            team: Team::Neutral,
            model: spec.model(),
            beams: if place.range.is_some() { 72 } else { 0 },
            start: place.start,
            goal: None,
        };
        let mut map = VectorMap::empty(place.bounds[0], place.bounds[1], 0.1);
        map.obstacles = place
            .obstacles
            .iter()
            .map(|shape| ObstacleSpec {
                name: String::new(),
                shape: shape.clone(),
            })
            .collect();
        let world = World::new(WorldSpec {
            map: MapSpec::Vector(map),
            robots: vec![spec],
            rules: RulesSpec::default(),
            seed: 1,
        })
        .unwrap();
        let params = P::Params::deserialize(toml::Deserializer::parse(params).unwrap()).unwrap();
        let mut planner = P::new(&params, &info, 1).unwrap();
        let map = planner_map(&world);
        planner.prepare(&map, &info);
        Self {
            world,
            planner,
            map,
            ranges: Vec::new(),
            v_max: place.v_max,
            reports: Vec::new(),
        }
    }

    pub fn pose(&self) -> Pose2 {
        self.world.robots()[0].pose
    }

    pub fn tick(&mut self) {
        let state = &self.world.robots()[0];
        let robots = [RobotView {
            index: 0,
            team: Team::Neutral,
            active: true,
            present: true,
            pose: state.pose,
            twist: state.twist,
            radius: state.radius(),
            v_max: self.v_max,
        }];
        let time_s = self.world.time().as_secs_f64();
        let spec = self.world.scan(0, &mut self.ranges).copied();
        let view = View {
            time_s,
            dt: DT,
            me: 0,
            robots: &robots,
            beliefs: &[],
            exits: &[],
            scan: spec.map(|spec| ScanView {
                angle_min: spec.angle_min,
                angle_increment: spec.angle_increment,
                range_min: spec.range_min,
                range_max: spec.range_max,
                ranges: &self.ranges,
            }),
        };
        let command = self.planner.steer(&self.map, &view).command;
        self.reports.extend_from_slice(self.planner.waypoints());
        self.world
            .step(&[Some(command)], Duration::from_secs_f64(DT));
    }
}

fn planner_map(world: &World) -> PlannerMap {
    let map = world.map();
    let space = FreeSpace::new(map.parts().to_vec(), *map.bounds(), 0.1).unwrap();
    let blurred = BlurredMap::new(&Grid::filled(*map.frame(), true), 0.1).unwrap();
    PlannerMap::new(blurred, Grid::filled(*map.frame(), 1.0), 1)
        .unwrap()
        .with_space(Arc::new(space))
}
