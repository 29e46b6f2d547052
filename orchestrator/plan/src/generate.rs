//! Generation of problems from seeds, for the published Monte-Carlo study and for experiments.
//!
//! A seed and a recipe always give the same problem. The order of the draws is fixed, so that recipes that differ in
//! one range give similar problems.

use core::f64::consts::TAU;
use core::fmt::Display;

use geometry::math;
use navigation::tangent_graph::ShortestPath;
use parameters::{Parameters, ParamsError, at_least, between, each, require};
use serde_json::{Value as Json, json};
use sim_backend::random::Stream;
use trajectory::obstacle_field::ObstacleField;
use trajectory::{PlanError, lower_bound};
use trajectory_problem::RobotLimits;

use super::instance::{Body, Instance};

/// Random stream of this generator, different from those of missions.
const STREAM: u64 = 0x706c_616e;
/// Size of a pixel (cm).
const CM_PER_PX: f64 = 0.75;
/// Maximum speed, 15 cm/s (px/s).
const V_MAX: f64 = 20.0;
/// Maximum turning rate (rad/s).
const OMEGA_MAX: f64 = 16.0;
/// Minimum distance of the robot's centre from obstacles (px).
const BUFFER: f64 = 10.0;
/// Additional clearance of start and goal (px).
const CLEAR: f64 = 2.0;
/// Width and height of the board (px).
const BOARD: [f64; 2] = [640.0, 480.0];
/// Minimum distance of free starts and goals from the board's edge (px).
const EDGE: f64 = 10.0;
/// Minimum distance between a free start and its goal (px).
const FAR: f64 = 560.0;
/// Share of the first path that has been driven when more obstacles appear.
const DRIVEN: f64 = 0.36;
/// Maximum number of places tried for an object before it is omitted.
const TRIES: usize = 1000;

parameters::choice! {
    /// Kind of a problem.
    pub enum Kind {
        /// From one corner of the board to the opposite one among discs (§ 4.3 of the paper).
        #[default]
        Corner,
        /// Between two places far apart among discs of one size (§ 4.4, first group).
        Anywhere,
        /// Continuation after 36 % of the path of such a problem, where two more discs appear on the path and near
        /// it (§ 4.4, second group).
        PopUp,
    }
}

parameters::table! {
    /// Random problems.
    pub struct Recipe {
        /// Kind of the problems.
        pub kind: Kind = Kind::Corner,
        /// Minimum and maximum number of discs (for `pop_up`, of the known ones).
        pub obstacles: [u32; 2] [each(at_least(0).at_most(1000))] = [10, 20],
        /// Minimum and maximum radius of a disc.
        pub radius: [f64; 2] [each(between(0, 200).unit("px"))] = [5.0, 15.0],
        /// Minimum and maximum heading at the start: in the board's frame for `corner`, relative to the straight
        /// line to the goal otherwise.
        pub angle: [f64; 2] [each(between(-360, 360).unit("°"))] = [40.0, 45.0],
    }
}

impl Parameters for Recipe {
    fn check_relations(&self) -> Result<(), ParamsError> {
        let least = |pair: [f64; 2], field: &str, value: &dyn Display| {
            let expected = "two numbers, the first one not above the second";
            require(pair[0] <= pair[1], field, value, expected)
        };
        let text = |pair: [f64; 2]| format!("{pair:?}");
        let counts = self.obstacles;
        least(counts.map(f64::from), "obstacles", &format!("{counts:?}"))?;
        least(self.radius, "radius", &text(self.radius))?;
        least(self.angle, "angle", &text(self.angle))
    }
}

/// Names of the predefined recipes.
pub const NAMES: [&str; 9] = [
    "base", "ang0_90", "obs1_10", "obs30_40", "rad20_30", "dense", "t3", "t4a", "t4b",
];

impl Recipe {
    /// Returns the recipe with a name of [`NAMES`].
    pub fn by_name(name: &str) -> Option<Self> {
        let base = Self::default();
        let anywhere = |kind, obstacles| Self {
            kind,
            obstacles,
            radius: [20.0, 35.0],
            angle: [-45.0, 45.0],
        };
        Some(match name {
            "base" => base,
            "ang0_90" => Self {
                angle: [0.0, 90.0],
                ..base
            },
            "obs1_10" => Self {
                obstacles: [1, 10],
                ..base
            },
            "obs30_40" => Self {
                obstacles: [30, 40],
                ..base
            },
            "rad20_30" => Self {
                radius: [20.0, 30.0],
                ..base
            },
            "dense" => Self {
                obstacles: [30, 40],
                radius: [20.0, 30.0],
                ..base
            },
            "t3" => anywhere(Kind::Anywhere, [5, 5]),
            "t4a" => anywhere(Kind::Anywhere, [3, 3]),
            "t4b" => anywhere(Kind::PopUp, [3, 3]),
            _ => return None,
        })
    }

    /// Returns the problem of a seed.
    pub fn instance(&self, id: String, seed: u64) -> Instance {
        // Obstacles cannot appear on a board without a path.
        let mut found = None;
        for attempt in 0..16 {
            let mut draw = Draw(Stream::new(seed, STREAM, attempt));
            let (instance, certain) = match self.kind {
                Kind::Corner => (self.corner(&mut draw), true),
                Kind::Anywhere => (self.anywhere(&mut draw), true),
                Kind::PopUp => {
                    let known = self.anywhere(&mut draw);
                    match reference(&known) {
                        Ok(way) => (pop_up(known, &way.path, &mut draw), true),
                        Err(_) => (known, false),
                    }
                }
            };
            found = Some(instance);
            if certain {
                break;
            }
        }
        let instance = found.unwrap_or_else(|| board([0.0; 3], [0.0; 2]));
        Instance { id, ..instance }
    }

    fn corner(&self, draw: &mut Draw) -> Instance {
        let start = [draw.within(0.0, 20.0), draw.within(0.0, 20.0)];
        let goal = [draw.within(620.0, 640.0), draw.within(460.0, 480.0)];
        let heading = draw.within(self.angle[0], self.angle[1]).to_radians();
        let mut instance = board([start[0], start[1], heading], goal);
        let count = draw.count(self.obstacles);
        for _ in 0..count {
            // The size is drawn before the place and only once: a larger disc is another disc at the same place.
            let r = draw.within(self.radius[0], self.radius[1]);
            add_disc(&mut instance, r, || {
                [draw.within(0.0, BOARD[0]), draw.within(0.0, BOARD[1])]
            });
        }
        instance
    }

    fn anywhere(&self, draw: &mut Draw) -> Instance {
        let place = |draw: &mut Draw| {
            [
                draw.within(EDGE, BOARD[0] - EDGE),
                draw.within(EDGE, BOARD[1] - EDGE),
            ]
        };
        // From left to right if no two places are far enough apart, which does not happen in practice.
        let mut ends = ([EDGE, 240.0], [BOARD[0] - EDGE, 240.0]);
        for _ in 0..TRIES {
            let pair = (place(draw), place(draw));
            if distance(pair.0, pair.1) >= FAR {
                ends = pair;
                break;
            }
        }
        let (start, goal) = ends;
        let towards = math::atan2(goal[1] - start[1], goal[0] - start[0]);
        let off = draw.within(self.angle[0], self.angle[1]).to_radians();
        let mut instance = board([start[0], start[1], towards + off], goal);
        let r = draw.within(self.radius[0], self.radius[1]);
        let count = draw.count(self.obstacles);
        for _ in 0..count {
            add_disc(&mut instance, r, || {
                [draw.within(0.0, BOARD[0]), draw.within(0.0, BOARD[1])]
            });
        }
        instance
    }
}

/// Random numbers of a seed.
struct Draw(Stream);

impl Draw {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    fn count(&mut self, [least, most]: [u32; 2]) -> u32 {
        let part = self.0.uniform() * f64::from(most - least + 1);
        (least + part as u32).min(most)
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    (dx * dx + dy * dy).sqrt()
}

/// Returns a problem on the board without obstacles.
fn board(start: [f64; 3], goal: [f64; 2]) -> Instance {
    Instance {
        id: String::new(),
        cm_per_px: CM_PER_PX,
        limits: RobotLimits::simple(V_MAX, OMEGA_MAX).forwards(),
        buffer: BUFFER,
        bounds: [0.0, 0.0, BOARD[0], BOARD[1]],
        start,
        start_speed: None,
        start_turn_rate: None,
        goal,
        goal_heading: None,
        goal_speed: None,
        obstacles: Vec::new(),
    }
}

/// Adds a disc at the first place with clear start and goal; adds none if there is no such place.
fn add_disc(instance: &mut Instance, r: f64, mut place: impl FnMut() -> [f64; 2]) {
    let [x, y, _] = instance.start;
    for _ in 0..TRIES {
        let at = place();
        let least = distance(at, [x, y]).min(distance(at, instance.goal));
        if least >= r + BUFFER + CLEAR {
            let [x, y] = at;
            instance.obstacles.push(Body::Disc { x, y, r });
            return;
        }
    }
}

/// Returns the problem that continues where the robot has driven a part of its path, with two more discs.
fn pop_up(known: Instance, path: &ShortestPath, draw: &mut Draw) -> Instance {
    let k = known.scale();
    let at = |part: f64| {
        let mut left = part * path.length;
        for leg in &path.legs {
            let length = leg.length();
            if left <= length {
                let u = left / length.max(f64::MIN_POSITIVE);
                return leg.at(u).coords / k;
            }
            left -= length;
        }
        path.legs
            .last()
            .map_or_else(nalgebra::Vector2::zeros, |leg| leg.at(1.0).coords / k)
    };
    let (here, ahead) = (at(DRIVEN), at(DRIVEN + 1e-4));
    let heading = math::atan2(ahead.y - here.y, ahead.x - here.x);
    let r = match known.obstacles.first() {
        Some(Body::Disc { r, .. }) => *r,
        _ => BUFFER,
    };
    let mut instance = Instance {
        start: [here.x, here.y, heading],
        ..known
    };
    for (low, high, aside) in [(0.5, 0.75, 0.5), (0.55, 0.9, 2.0)] {
        add_disc(&mut instance, r, || {
            let part = draw.within(low, high);
            let (p, q) = (at(part), at(part + 1e-4));
            let turn = math::atan2(q.y - p.y, q.x - p.x) + TAU / 4.0;
            let (sin, cos) = math::sincos(turn);
            let off = r * draw.within(-aside, aside);
            [
                (p.x + off * cos).clamp(0.0, BOARD[0]),
                (p.y + off * sin).clamp(0.0, BOARD[1]),
            ]
        });
    }
    instance
}

/// Reference values of a problem, known before it is planned.
#[derive(Debug, Clone)]
pub struct Reference {
    /// Shortest path (m).
    pub path: ShortestPath,
    /// Lower bound of the duration of any trajectory (s).
    pub lower_bound: f64,
}

/// Computes the shortest path of a problem and the lower bound.
///
/// # Errors
/// [`PlanError`] if there is no path or the problem is invalid.
pub fn reference(instance: &Instance) -> Result<Reference, PlanError> {
    let problem = instance.problem();
    problem.validate()?;
    let exact = ObstacleField::new(&problem)?.exact()?;
    let path = exact.shortest(problem.start.position(), problem.goal)?;
    let lower_bound = lower_bound(&problem, path.length);
    Ok(Reference { path, lower_bound })
}

/// Writes an instance as in files, with the length of the shortest path and the lower bound.
pub fn with_reference(instance: &Instance) -> Json {
    let reference = match reference(instance) {
        Ok(found) => json!({
            "feasible": true,
            "shortest_px": found.path.length / instance.scale(),
            "t_lb_s": found.lower_bound,
        }),
        Err(_) => json!({ "feasible": false }),
    };
    let mut json = instance.to_json();
    if let Some(json) = json.as_object_mut() {
        json.insert("reference".to_owned(), reference);
    }
    json
}
