//! A world with three robots and a wall, as the planner of the second robot gets it.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};
use geometry::pose::{Pose2, Twist2};
use geometry::region::Region;
use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use planner::{PlannerMap, Steering, View, limits};
use planner_view::free_space::FreeSpace;
use planner_view::view::{BeliefView, ParticleView, RobotView, ScanView};
use robot::spec::RobotModel;
use robot::team::Role;
use runtime::config::{Clock, ProcessConfig, RobotInfo, RunConfig};
use serde_json::Value as Json;

use crate::Library;
use crate::abi::Point;
use crate::error::CallError;
use crate::params::LibraryParams;
use crate::process::{LibraryInstance, Rules};
use crate::records::Records;

const ME: u32 = 1;

/// Returns the started planner of a library with these parameters.
pub fn start(library: Library, params: &Json) -> Result<LibraryInstance, CallError> {
    let config = config();
    let params = LibraryParams::new(params, library);
    let exits = config.run.exits.iter().map(|exit| exit.center().into());
    let rules = Rules {
        exits: &exits.collect::<Vec<_>>(),
        capture_radius: config.run.capture_radius,
    };
    LibraryInstance::start(&config, &params, Some(ME), &rules, 7)
}

/// Returns the steering of one tick.
pub fn steer(driven: &mut LibraryInstance) -> Result<Steering, CallError> {
    let robot = |index, role: Role, x| RobotView {
        index,
        team: role.into(),
        active: index != 0,
        present: true,
        pose: Pose2::new(x, 1.0, 0.0),
        twist: Twist2::new(0.1, 0.0),
        radius: 0.105,
        v_max: 0.22,
    };
    let robots = [
        robot(0, Role::Pursuer, 3.5),
        robot(1, Role::Evader, 1.2),
        robot(2, Role::Neutral, 3.0),
    ];
    let particle = |x| ParticleView {
        x,
        y: 1.0,
        theta: 0.0,
        weight: 0.5,
    };
    let particles = [particle(1.0), particle(2.0), particle(3.0)];
    let belief = |robot, particles, seen| BeliefView {
        robot,
        particles,
        mean: Pose2::new(1.0, 1.0, 0.0),
        position_std: 0.5,
        seen,
    };
    let beliefs = [
        belief(0, &particles[..1], true),
        belief(2, &particles[1..], false),
    ];
    let config = config();
    let view = View {
        time_s: 1.5,
        dt: config.run.tick_period(),
        me: ME as usize,
        robots: &robots,
        beliefs: &beliefs,
        exits: &[],
        scan: Some(ScanView {
            angle_min: -0.1,
            angle_increment: 0.2,
            range_min: 0.1,
            range_max: 3.5,
            ranges: &[1.0, 2.5],
        }),
    };
    let exits: Vec<Point> = config.run.exits.iter().map(|e| e.center().into()).collect();
    let limits = limits(&config.run.robots[ME as usize]).unwrap();
    driven.steer(&map(), &view, &exits, limits, &Records::default())
}

fn config() -> ProcessConfig {
    let circle = |x: f64| Region::Circle {
        center: [x, 1.0],
        radius: 0.2,
    };
    let robot = |name: &str, role: Role, opponents: Vec<u32>| RobotInfo {
        name: name.into(),
        team: role.team().into(),
        role,
        opponents,
        companions: Vec::new(),
        model: RobotModel::turtlebot3_burger(),
        beams: 2,
        start: Pose2::new(1.0, 1.0, 0.5),
        goal: (role == Role::Neutral).then(|| circle(3.0)),
    };
    ProcessConfig {
        run: RunConfig {
            root: PathBuf::new(),
            prefix: String::new(),
            seed: 1,
            tick_period_ns: 50_000_000,
            clock: Clock::LockStep,
            processor: None,
            processes: 2,
            events: 0,
            recorder_ticks: 8,
            topics: Vec::new(),
            capacities: BTreeMap::from([
                ("world/map".to_owned(), 1600),
                ("world/shapes".to_owned(), 0),
                ("perception/belief".to_owned(), 3),
            ]),
            robots: vec![
                robot("cop", Role::Pursuer, vec![1]),
                robot("thief", Role::Evader, vec![0]),
                robot("rock", Role::Neutral, Vec::new()),
            ],
            exits: vec![circle(3.5)],
            capture_radius: 0.25,
            log_level: "warn".into(),
        },
        name: "probe".into(),
        kind: "library".into(),
        index: 1,
        robots: vec![ME],
        upstream: Vec::new(),
        period: 1,
        links: Vec::new(),
    }
}

/// A hall of 4 m × 4 m with a wall from x = 1.9 to 2.1 below y = 3.
fn map() -> PlannerMap {
    let bounds = Aabb {
        min: Point2::new(0.0, 0.0),
        max: Point2::new(4.0, 4.0),
    };
    let frame = GridFrame {
        width: 40,
        height: 40,
        resolution: 0.1,
        origin: bounds.min,
    };
    let wall = Convex::rectangle(Point2::new(2.0, 1.5), [0.1, 1.5], 0.0);
    let space = FreeSpace::new(vec![wall], bounds, 0.1).unwrap();
    let mut clearance = Grid::filled(frame, 0.0_f32);
    for row in 0..40 {
        for col in 0..40 {
            let centre = Point2::new(0.05 + 0.1 * col as f64, 0.05 + 0.1 * row as f64);
            clearance.cells[frame.index(col, row)] = space.distance(centre) as f32;
        }
    }
    let blurred = BlurredMap::new(&Grid::filled(frame, true), 0.1).unwrap();
    let map = PlannerMap::new(blurred, clearance, 4).unwrap();
    map.with_space(Arc::new(space))
}
