//! The chasing-game paper's city and a kinematic mini-simulation, for tests of planners.

use std::sync::LazyLock;

use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};
use geometry::math;
use geometry::pose::{Pose2, Twist2};
use nalgebra::Point2;
use planner_view::map::PlannerMap;
use planner_view::view::{RobotView, View};
use robot::team::Role;

/// Radius of the TurtleBot3 Burger's body as a disc (m).
pub const RADIUS: f64 = 0.105;
/// The city's exit (m).
pub const EXIT: Point2<f64> = Point2::new(9.0, 0.0);
/// Standard deviation of the blur (m).
pub const SIGMA: f64 = 0.19;

/// Time between two ticks (s).
pub const DT: f64 = 0.05;

/// The city and its planner map.
pub static CITY: LazyLock<(Arena, PlannerMap)> = LazyLock::new(|| {
    let arena = Arena::city();
    let map = arena.map();
    (arena, map)
});

/// A robot that takes part and stands still, as planners see it.
pub fn robot(index: usize, role: Role, pose: Pose2, v_max: f64) -> RobotView {
    RobotView {
        index,
        team: role.into(),
        active: true,
        present: true,
        pose,
        twist: Twist2::STOP,
        radius: RADIUS,
        v_max,
    }
}

/// The view of the first of these robots.
pub fn view<'a>(time_s: f64, robots: &'a [RobotView], exits: &'a [Point2<f64>]) -> View<'a> {
    View {
        time_s,
        dt: DT,
        me: 0,
        robots,
        beliefs: &[],
        exits,
        scan: None,
    }
}

/// Axis-aligned rectangles as (x0, x1, y0, y1) (m).
pub type Rectangle = (f64, f64, f64, f64);

/// The obstacles of an arena.
#[derive(Debug, Clone)]
pub struct Arena {
    /// Walls (m).
    pub rectangles: Vec<Rectangle>,
    /// `true` if the corners with |x| + |y| > 15.5 are walls too.
    pub chamfered: bool,
}

impl Arena {
    /// 25 blocks of 2 x 2, a wall with an exit at +x, cut corners.
    pub fn city() -> Self {
        let mut rectangles = Vec::new();
        for x in [-6.0, -3.0, 0.0, 3.0, 6.0] {
            for y in [-6.0, -3.0, 0.0, 3.0, 6.0] {
                rectangles.push((x - 1.0, x + 1.0, y - 1.0, y + 1.0));
            }
        }
        rectangles.push((-9.0, -8.0, -9.0, 9.0));
        rectangles.push((-9.0, 9.0, -9.0, -8.0));
        rectangles.push((-9.0, 9.0, 8.0, 9.0));
        rectangles.push((8.0, 9.0, 1.25, 8.75));
        rectangles.push((8.0, 9.0, -8.75, -1.25));
        Self {
            rectangles,
            chamfered: true,
        }
    }

    /// Distance from a point to the nearest obstacle (m), 0 inside one.
    pub fn clearance(&self, p: Point2<f64>) -> f64 {
        let mut least = f64::INFINITY;
        for &(x0, x1, y0, y1) in &self.rectangles {
            let dx = (x0 - p.x).max(p.x - x1).max(0.0);
            let dy = (y0 - p.y).max(p.y - y1).max(0.0);
            least = least.min((dx * dx + dy * dy).sqrt());
        }
        if self.chamfered && p.x.abs() < 8.0 && p.y.abs() < 8.0 {
            let beyond = (15.5 - p.x.abs() - p.y.abs()) / 2.0_f64.sqrt();
            least = least.min(beyond.max(0.0));
        }
        least
    }

    /// The planner's map at a resolution of 1/16 m, 9.5 m each way.
    pub fn map(&self) -> PlannerMap {
        let frame = GridFrame {
            width: 304,
            height: 304,
            resolution: 0.0625,
            origin: Point2::new(-9.5, -9.5),
        };
        self.map_sampled(frame, |index| frame.resolution * (index as f64 + 0.5) - 9.5)
    }

    /// The map of the paper's experiments: 300 samples from −9.5 to 9.5, taken as cells of 19/300 m
    /// whose grid begins half a cell earlier.
    pub fn paper_map(&self) -> PlannerMap {
        let resolution = 19.0 / 300.0;
        let origin = -9.5 - resolution / 2.0;
        let frame = GridFrame {
            width: 300,
            height: 300,
            resolution,
            origin: Point2::new(origin, origin),
        };
        self.map_sampled(frame, |index| -9.5 + index as f64 * 19.0 / 299.0)
    }

    fn map_sampled(&self, frame: GridFrame, coordinate: impl Fn(usize) -> f64) -> PlannerMap {
        let mut clearance = Grid::filled(frame, 0.0_f32);
        let mut free = Grid::filled(frame, false);
        for row in 0..frame.height {
            for col in 0..frame.width {
                let at = self.clearance(Point2::new(coordinate(col), coordinate(row)));
                clearance.cells[frame.index(col, row)] = at as f32;
                free.cells[frame.index(col, row)] = at > 0.0;
            }
        }
        let blurred = BlurredMap::new(&free, SIGMA).expect("a sane map");
        PlannerMap::new(blurred, clearance, 1).expect("a sane map")
    }

    /// Range (m) from a point in a direction (rad) to the nearest obstacle, at most `max`.
    pub fn range(&self, from: Point2<f64>, angle: f64, max: f64) -> f64 {
        let (sin, cos) = math::sincos(angle);
        let mut run = 0.0;
        while run < max {
            let at = Point2::new(from.x + run * cos, from.y + run * sin);
            let spare = self.clearance(at);
            if spare < 1e-4 {
                return run;
            }
            run += spare;
        }
        max
    }

    /// A range scan all round, 1° apart, from 0 to 359°.
    pub fn scan(&self, pose: &Pose2, max: f64) -> Vec<f32> {
        (0..360)
            .map(|degree| {
                let angle = pose.theta + f64::from(degree).to_radians();
                self.range(pose.position(), angle, max) as f32
            })
            .collect()
    }
}

/// A robot that moves by exact arcs and stops at walls.
#[derive(Debug, Clone)]
pub struct Kinematic {
    /// Pose (m, rad).
    pub pose: Pose2,
    /// The last command (m/s, rad/s).
    pub twist: Twist2,
    /// Number of ticks in which a wall stopped it.
    pub contacts: u32,
    /// Distance travelled (m).
    pub travelled: f64,
    /// Minimum clearance of the body from a wall so far (m).
    pub least_clearance: f64,
}

impl Kinematic {
    /// A robot that stands at a pose (m, rad).
    pub fn new(x: f64, y: f64, theta: f64) -> Self {
        Self {
            pose: Pose2::new(x, y, theta),
            twist: Twist2::STOP,
            contacts: 0,
            travelled: 0.0,
            least_clearance: f64::INFINITY,
        }
    }

    /// Moves for `dt` (s), or turns only where a wall is in the way.
    pub fn step(&mut self, arena: &Arena, command: Twist2, dt: f64) {
        assert!(command.is_finite());
        let turned = command.omega * dt;
        // A chord of the arc, in the direction halfway through the turn.
        let chord = if turned.abs() < 1e-9 {
            command.v * dt
        } else {
            2.0 * command.v / command.omega * math::sin(turned / 2.0)
        };
        let (sin, cos) = math::sincos(self.pose.theta + turned / 2.0);
        let next = Pose2::new(
            self.pose.x + chord * cos,
            self.pose.y + chord * sin,
            self.pose.theta + turned,
        );
        let clearance = arena.clearance(next.position()) - RADIUS;
        self.twist = command;
        if clearance < 0.0 {
            self.contacts += 1;
            self.pose.theta = next.theta;
        } else {
            self.least_clearance = self.least_clearance.min(clearance);
            self.travelled += chord.abs();
            self.pose = next;
        }
    }
}

/// Free poses spread evenly over the city's streets.
pub fn street_starts() -> Vec<Pose2> {
    let streets = [-7.5, -4.5, -1.5, 1.5, 4.5, 7.5];
    let mut starts = Vec::new();
    for (i, &street) in streets.iter().enumerate() {
        for (j, &along) in [-6.3, -3.2, 0.4, 3.1, 5.9].iter().enumerate() {
            let theta = f64::from((i * 5 + j) as u32) * 2.399_963;
            starts.push(Pose2::new(street, along, theta));
            starts.push(Pose2::new(along, street, theta + 1.0));
        }
    }
    starts
}

/// A square without obstacles, 20 m wide.
pub fn open_ground() -> PlannerMap {
    let frame = GridFrame {
        width: 400,
        height: 400,
        resolution: 0.05,
        origin: Point2::new(-10.0, -10.0),
    };
    let blurred = BlurredMap::new(&Grid::filled(frame, true), 0.2).expect("a sane map");
    PlannerMap::new(blurred, Grid::filled(frame, 100.0), 1).expect("a sane map")
}
