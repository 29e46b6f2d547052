//! Drive of a robot in the simulated world by its real planner, and an observer of its key.

#![allow(dead_code, reason = "tests and examples use different parts")]

use core::time::Duration;
use std::sync::Arc;

use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};
use geometry::map::{MapSpec, ObstacleSpec, VectorMap};
use geometry::pose::Pose2;
use geometry::shape::Shape;
use nalgebra::Point2;
use observer::knowledge::ChebyshevKnowledge;
use observer::layout::Layout;
use observer::legs::Legs;
use observer::moment::{Look, MeasuredPose, Moment};
use observer::predictors::Predictor as _;
use observer::predictors::key::{Finder, KeyHunter};
use planner::Planner;
use planner_view::free_space::FreeSpace;
use planner_view::map::PlannerMap;
use planner_view::view::{RobotView, ScanView, View};
use planner_view::waypoint::WaypointReport;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use robot::spec::{LimitsSpec, RobotSpec, ScanSpec};
use robot::team::Role;
use runtime::RobotInfo;
use serde::Deserialize as _;
use sim_backend::spec::{RulesSpec, WorldSpec};
use sim_backend::world::World;
use tracking::params::SensorParams;
use tracking::sighting::gaussian_pair;
use tracking::space::Space;
use tracking::watch::Watch;

/// Tick (s).
pub const DT: f64 = 0.05;

/// World with one robot.
#[derive(Debug, Clone)]
pub struct Place {
    /// Corners of the world map (m).
    pub bounds: [[f64; 2]; 2],
    pub obstacles: Vec<Shape>,
    pub start: Pose2,
    /// Radius (m), speed (m/s) and turning rate (rad/s) of the robot.
    pub radius: f64,
    pub v_max: f64,
    pub omega_max: f64,
    /// Range of its sensor (m), if it has one.
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
    /// Returns a drive with these parameters of the planner, in the form of a scenario.
    pub fn new(place: &Place, params: &str) -> Self {
        let mut spec = RobotSpec::new("guard", Role::Neutral, place.start);
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
            team: "neutral".into(),
            role: Role::Neutral,
            opponents: Vec::new(),
            companions: Vec::new(),
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
            team: Role::Neutral.into(),
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

/// Distance from its goal at which a robot turns to the next (m): that of the drivers.
const ARRIVAL: f64 = 0.05;

/// Number of predicted goals that are compared with those driven to, and the number of goals that
/// the robot may have reached by then.
const COMPARED: usize = 35;
const BEHIND: usize = 2;

/// An octagon of 48 m (cat-map patrol paper, case 1) (m).
pub const OCTAGON: [[f64; 2]; 8] = [
    [5.0, 0.0],
    [0.0, 5.0],
    [0.0, 10.0],
    [5.0, 15.0],
    [10.0, 15.0],
    [15.0, 10.0],
    [15.0, 5.0],
    [10.0, 0.0],
];

/// A patrol of the octagon.
pub fn patrol(
    alpha: f64,
    (v_max, omega_max): (f64, f64),
    key: &str,
) -> Drive<patrol_planners::process::PatrolAwgPlanner> {
    let place = Place {
        bounds: [[-2.0, -2.0], [17.0, 17.0]],
        obstacles: Vec::new(),
        start: Pose2::new(5.0, 0.0, 2.356),
        radius: 0.22,
        v_max,
        omega_max,
        range: Some(0.5),
    };
    let mission = format!(
        "mission = {{ contour = {OCTAGON:?}, t_max = 120.0, alpha = {alpha}, key = \"{key}\" }}"
    );
    Drive::new(&place, &mission)
}

/// Returns 10 m by 10 m with these obstacles, and a robot that covers them.
pub fn workplace(obstacles: &[Shape], start: [f64; 2]) -> Place {
    Place {
        bounds: [[0.0, 0.0], [10.0, 10.0]],
        obstacles: obstacles.to_vec(),
        start: Pose2::new(start[0], start[1], 0.0),
        radius: 0.1,
        v_max: 1.0,
        omega_max: 5.0,
        range: None,
    }
}

/// A coverage of a workplace.
pub fn coverage(place: &Place, key: &str) -> Drive<coverage_planners::ChebyshevPlanner> {
    Drive::new(place, &format!("key = \"{key}\""))
}

impl<P> Drive<P> {
    /// Returns the goals of a coverage, as an observer knows them.
    pub fn layout(&self, knowledge: &ChebyshevKnowledge) -> Layout {
        let (map, robot) = (self.world.map(), &self.world.robots()[0]);
        let start = robot.pose.position();
        knowledge
            .layout_of_map(*map.bounds(), map.parts(), robot.radius(), start)
            .unwrap()
    }
}

/// Result of a search for a key.
pub struct Found {
    /// Number of goals that the robot had reached when the key was recovered.
    pub after: Option<usize>,
    /// Detected goals per goal reached.
    pub made_out: f64,
    /// `true` if the predicted goals differ from those driven to.
    pub wrong: bool,
}

/// Search for a key from noisy poses.
pub struct Hunter<F> {
    search: KeyHunter<F>,
    legs: Legs,
    noise: f64,
    rng: ChaCha8Rng,
    scene: (Space, Watch),
    last: Option<Look>,
}

impl<F: Finder> Hunter<F> {
    /// Returns a search for goals of this layout, with a noise (m, rad) of this seed.
    pub fn new(layout: &Layout, finder: F, (noise, seed): (f64, u64)) -> Self {
        let frame = GridFrame {
            width: 10,
            height: 10,
            resolution: 0.1,
            origin: Point2::new(0.0, 0.0),
        };
        let map = BlurredMap::new(&Grid::filled(frame, true), 0.1).unwrap();
        Self {
            search: KeyHunter::new(layout.clone(), finder, ARRIVAL, 0.03),
            legs: Legs::new(ARRIVAL),
            noise,
            rng: ChaCha8Rng::seed_from_u64(seed),
            scene: (Space::new(&map), Watch::new(&SensorParams::default())),
            last: None,
        }
    }

    /// Measures a pose at a tick; `seen` is `true` while the robot is in sight.
    pub fn observe(&mut self, pose: Pose2, tick: u64, seen: bool) {
        let rng = &mut self.rng;
        let ((x, y), (turn, _)) = (gaussian_pair(rng), gaussian_pair(rng));
        let noise = self.noise;
        let look = Look {
            time: tick as f64 * DT,
            dt: DT,
            seen: seen.then(|| MeasuredPose {
                position: Point2::new(pose.x + noise * x, pose.y + noise * y),
                heading: pose.theta + noise * turn,
                sigma: noise,
                heading_sigma: noise,
            }),
            visibility: 1.0,
        };
        let goal = self.legs.observe(&look);
        let goals_lost = look.seen.is_some() && self.legs.take_lost();
        self.last = Some(look);
        self.search.observe(&Moment {
            look,
            goal,
            goals_lost,
            space: &self.scene.0,
            watch: &self.scene.1,
        });
    }

    /// Returns the position predicted for a horizon (s) from the last measurement.
    pub fn predict(&self, horizon: f64) -> Option<Point2<f64>> {
        let moment = Moment {
            look: self.last?,
            goal: None,
            goals_lost: false,
            space: &self.scene.0,
            watch: &self.scene.1,
        };
        self.search.predict(horizon, &moment)
    }

    /// Returns `true` if the key is known.
    pub fn key_recovered(&self) -> bool {
        self.search.key_recovered()
    }
}

/// Watches a robot until its key is recovered or it has reached this number of goals; `unseen`
/// returns `true` while it is out of sight (s).
pub fn watch<P: Planner, F: Finder>(
    mut drive: Drive<P>,
    layout: &Layout,
    finder: F,
    noise: (f64, u64),
    unseen: impl Fn(f64) -> bool,
    most: usize,
) -> Found {
    let mut hunter = Hunter::new(layout, finder, noise);
    for tick in 0_u64.. {
        hunter.observe(drive.pose(), tick, !unseen(tick as f64 * DT));
        drive.tick();
        let reached = drive.reports.len();
        let made_out = f64::from(hunter.search.goals_observed()) / reached.max(1) as f64;
        if hunter.key_recovered() {
            let upcoming: Vec<_> = hunter.search.upcoming().take(COMPARED).collect();
            return Found {
                after: Some(reached),
                made_out,
                wrong: !drive.goes_through(&upcoming),
            };
        }
        if reached >= most {
            return Found {
                after: None,
                made_out,
                wrong: false,
            };
        }
    }
    panic!("ticks do not end")
}

impl<P: Planner> Drive<P> {
    /// Returns `true` if the robot drives to these goals.
    fn goes_through(&mut self, goals: &[Point2<f64>]) -> bool {
        let reached = self.reports.len();
        while self.reports.len() < reached + COMPARED + 10 {
            self.tick();
        }
        let ahead = &self.reports[reached.saturating_sub(BEHIND)..];
        let missing = goals.iter().filter(|goal| {
            let near = |point: Point2<f64>| (point - **goal).norm() < 1e-3;
            !ahead.iter().any(|report| near(report.waypoint.point))
        });
        missing.count() <= BEHIND
    }
}
