//! Single plans of the RRT* planners in the city of the chase, in a static world.

use core::error::Error;
use std::sync::LazyLock;

use evader_rrt_star::RrtStarParams;
use evader_rrt_star::collision_map::CollisionMap;
use evader_rrt_star::cost::{CostModel, Pursuer};
use evader_rrt_star::params::Primitive;
use evader_rrt_star::planning::{self, Task};
use geometry::map::WorldMap;
use geometry::pose::Pose2;
use nalgebra::Point2;
use navigation::shortest_paths::END_TOLERANCE;
use navigation::tangent_graph::{ShortestPath, TangentGraph};
use planner_view::free_space::FreeSpace;
use planner_view::limits::Limits;
use robot::spec::RobotModel;
use robot::team::Role;
use runtime::seed::stream;

use crate::ScenarioError;

/// The scenario with the map, robots and starts.
const SCENARIO: &str = "chase_paper";
/// Distance between two samples along the shortest path (m).
const STEP: f64 = 0.01;

/// A plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Planner: the name of a case.
    pub case: &'static str,
    /// Positions of the Police: `start`, as at the start of a game, or `random`.
    pub scene: &'static str,
    /// Length of the path (m) and its smallest distance from a pursuer (m); `None` if none to the exit was found.
    pub path: Option<[f64; 2]>,
    /// The same of the shortest path.
    pub shortest: Option<[f64; 2]>,
}

static SETTING: LazyLock<Result<Setting, ScenarioError>> = LazyLock::new(Setting::new);

/// Plans with every planner, with the Police at their starts and again at random free positions. The same seed gives
/// the same plans.
///
/// # Errors
/// The built-in scenario is unusable.
pub fn of_seed(seed: u64, iterations: u32) -> Result<Vec<Plan>, ScenarioError> {
    let setting = SETTING.as_ref().map_err(Clone::clone)?;
    setting.plans(seed, iterations)
}

fn failed(reason: impl Into<Box<dyn Error + Send + Sync>>) -> ScenarioError {
    ScenarioError::new(SCENARIO, reason)
}

/// Returns the measured cases: name, parameters.
fn cases() -> [(&'static str, RrtStarParams); 4] {
    let arc = RrtStarParams {
        primitive: Primitive::Arc,
        ..RrtStarParams::default()
    };
    [
        ("rrt_star_line", RrtStarParams::default()),
        ("rrt_star_line_paper", RrtStarParams::paper()),
        ("rrt_star_arc", arc),
        ("rrt_star_arc_paper", RrtStarParams::paper_arc()),
    ]
}

/// Map and robots of the scenario.
struct Setting {
    space: FreeSpace,
    graph: TangentGraph,
    exits: Vec<Point2<f64>>,
    model: RobotModel,
    start: Pose2,
    police: Vec<Point2<f64>>,
    police_speed: f64,
}

impl Setting {
    fn new() -> Result<Self, ScenarioError> {
        // Seed 1: the starts have the same jitter each time.
        let scenario = kinds::load(SCENARIO, &[], Some(1)).map_err(failed)?;
        let map = WorldMap::new(&scenario.world.map).map_err(failed)?;
        let space = FreeSpace::new(map.parts().to_vec(), *map.bounds(), map.frame().resolution)
            .map_err(failed)?;
        let robots = &scenario.world.robots;
        let evader = robots.iter().find(|r| r.role() == Role::Evader);
        let evader = evader.ok_or_else(|| failed("it has no evader"))?;
        let pursuers = || robots.iter().filter(|r| r.role() == Role::Pursuer);
        let model = evader.model();
        Ok(Self {
            graph: TangentGraph::new(&space, model.radius).map_err(failed)?,
            exits: map
                .exits()
                .iter()
                .map(geometry::region::Region::center)
                .collect(),
            start: evader.start,
            police: pursuers().map(|r| r.start.position()).collect(),
            police_speed: pursuers().map(|r| r.model().v_max).fold(0.0, f64::max),
            model,
            space,
        })
    }

    /// Returns random free positions for all Police.
    fn scattered(&self, seed: u64) -> Result<Vec<Point2<f64>>, ScenarioError> {
        let mut rng = stream(seed, "plans", "police", "places");
        let place = || self.space.random_free(&mut rng, self.model.radius);
        let places: Option<Vec<_>> = std::iter::repeat_with(place)
            .take(self.police.len())
            .collect();
        places.ok_or_else(|| failed("there is no room for the Police"))
    }

    fn plans(&self, seed: u64, iterations: u32) -> Result<Vec<Plan>, ScenarioError> {
        let mut plans = Vec::new();
        for (case, params) in cases() {
            let radius = self.model.radius + params.margin;
            let mut collision_map = CollisionMap::new(&self.space, radius, 1);
            for scene in ["start", "random"] {
                let police = match scene {
                    "start" => self.police.clone(),
                    _ => self.scattered(seed)?,
                };
                let found = self.plan(&params, &mut collision_map, &police, (seed, iterations))?;
                let [path, shortest] = found;
                plans.push(Plan {
                    case,
                    scene,
                    path,
                    shortest,
                });
            }
        }
        Ok(plans)
    }

    fn plan(
        &self,
        params: &RrtStarParams,
        collision_map: &mut CollisionMap,
        police: &[Point2<f64>],
        (seed, iterations): (u64, u32),
    ) -> Result<[Option<[f64; 2]>; 2], ScenarioError> {
        let model = &self.model;
        let limits =
            Limits::new(model.v_max, model.v_reverse_max, model.omega_max).map_err(failed)?;
        let mut cost = CostModel::new(params.cost, params.search.algorithm, limits.v_max());
        cost.set_pursuers(police.iter().map(|&at| Pursuer {
            at,
            v_max: self.police_speed,
        }));
        let places = self
            .exits
            .iter()
            .filter_map(|&e| collision_map.free_place(e, END_TOLERANCE));
        let goals: Vec<Point2<f64>> = places.collect();
        let towards = collision_map.towards(&goals);
        let route = planning::for_robot(params, &limits, seed)
            .plan(&Task {
                collision_map,
                bodies: &[],
                cost: &cost,
                start: self.start,
                goals: &goals,
                towards: &towards,
                map_changed: true,
                iterations,
            })
            .filter(|route| route.is_complete);
        let from = self.start.position();
        let ways = goals
            .iter()
            .filter_map(|&goal| self.graph.shortest(from, goal));
        let shortest = ways.min_by(|a, b| a.length.total_cmp(&b.length));
        let path = route.map(|r| {
            let points = r.path.points().iter().copied();
            [r.path.length(), closest(points, police)]
        });
        Ok([
            path,
            shortest.map(|s| [s.length, closest(along(&s), police)]),
        ])
    }
}

/// Returns points of a path, close enough to be joined by lines.
fn along(path: &ShortestPath) -> impl Iterator<Item = Point2<f64>> {
    path.legs.iter().flat_map(|leg| {
        let pieces = (leg.length() / STEP).ceil().clamp(1.0, 1e5) as u32;
        (0..=pieces).map(move |i| leg.at(f64::from(i) / f64::from(pieces)))
    })
}

/// Returns the smallest distance of a path over these points from any of some positions (m).
fn closest(points: impl Iterator<Item = Point2<f64>>, places: &[Point2<f64>]) -> f64 {
    let mut least = f64::INFINITY;
    let mut last: Option<Point2<f64>> = None;
    for point in points {
        let from = last.unwrap_or(point);
        for &place in places {
            least = least.min(distance(from, point, place));
        }
        last = Some(point);
    }
    least
}

/// Returns the distance of a position from a segment between two points (m).
fn distance(from: Point2<f64>, to: Point2<f64>, place: Point2<f64>) -> f64 {
    let (way, off) = (to - from, place - from);
    let square = way.norm_squared();
    let part = if square > 0.0 {
        (off.dot(&way) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (off - way * part).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_to_the_path_and_not_to_its_points() {
        let points = [(0.0, 0.0), (10.0, 0.0), (10.0, 5.0)].map(|(x, y)| Point2::new(x, y));
        let least = |x, y| closest(points.into_iter(), &[Point2::new(x, y)]);
        assert_eq!(least(5.0, 2.0), 2.0);
        assert_eq!(least(13.0, 9.0), 5.0);
        assert_eq!(least(-3.0, 4.0), 5.0);
        assert_eq!(closest(points.into_iter(), &[]), f64::INFINITY);
    }
}
