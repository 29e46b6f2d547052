//! The sub-goals of a coverage, and the coverage that they achieve.

use ::coverage::goal::{Goal, GoalSource};
use ::coverage::tour::Tour;
use ::metrics::coverage::{CELL_SIDES, Figures, Meter, Rate};
use coverage::decomposition::Place;
use coverage::sub_goals::FollowParams;
use coverage::sub_goals::site::Site;
use coverage_planners::design::Design;
use coverage_planners::{
    Boustrophedon, Chebyshev, ChebyshevParams, KeyedGoals, RandomBounce, Uniform,
};
use geometry::map::WorldMap;
use geometry::shape::Aabb;
use nalgebra::Point2;
use serde_json::{Value as Json, json};

use super::patrol::kind_name;
use super::{RouteError, Router};
use scenario::ResolvedScenario;

/// Distance between the points of the path at which coverage is computed (m): the robot's step in the
/// Chebyshev coverage paper.
const STEP: f64 = 0.125;

/// Length of the planned coverage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    /// This many large loops.
    Loops(u32),
    /// This many sub-goals.
    Goals(u64),
    /// A path of this length (m).
    Length(f64),
}

/// Maximum number of planned sub-goals.
const MAX_GOALS: u64 = 10_000_000;

/// A planned coverage.
#[derive(Debug)]
pub struct PlannedCoverage {
    /// Name of its process.
    pub process: String,
    /// Name of its robot.
    pub robot: String,
    /// The workplace and its free rectangles.
    pub site: Site,
    /// Order in which a large loop visits them; `None` for planners without large loops.
    pub tour: Option<Tour>,
    /// The sub-goals.
    pub goals: Vec<Goal>,
    /// Coverage of driving straight to the sub-goals; `None` if no area can be covered.
    pub figures: Option<Figures>,
}

/// A kind of coverage planner: its name, and its planning function.
type Kind = (
    &'static str,
    fn(&Order<'_>) -> Result<PlannedCoverage, RouteError>,
);

/// Kinds with their names in scenarios.
const KINDS: [Kind; 5] = [
    ("coverage_chebyshev", chebyshev),
    ("coverage_keyed", any::<KeyedGoals>),
    ("coverage_boustrophedon", any::<Boustrophedon>),
    ("coverage_random_bounce", any::<RandomBounce>),
    ("coverage_uniform", any::<Uniform>),
];

/// Planning task.
struct Order<'s> {
    scenario: &'s ResolvedScenario,
    router: Router<'s>,
    extent: Extent,
}

/// Plans the coverage of a scenario.
///
/// # Errors
/// [`RouteError`] if the scenario has no suitable process, or its planner refuses.
pub fn plan(
    scenario: &ResolvedScenario,
    process: Option<&str>,
    extent: Extent,
) -> Result<PlannedCoverage, RouteError> {
    let names = KINDS.map(|(name, _)| name);
    let router = Router::find(scenario, &names, process)?;
    let order = Order {
        scenario,
        router,
        extent,
    };
    match KINDS.iter().find(|(name, _)| *name == router.kind) {
        Some((_, plan)) => plan(&order),
        None => Err(router.refused(&"this kind plans no coverage")),
    }
}

fn chebyshev(order: &Order<'_>) -> Result<PlannedCoverage, RouteError> {
    let params: &ChebyshevParams = order.router.params()?;
    let mut planned = order.plan::<Chebyshev>(params)?;
    let decomposition = &planned.site.decomposition;
    if let Some(first) = decomposition.rectangle_at(planned.site.start) {
        let refused = |e: &dyn std::fmt::Display| order.router.refused(e);
        let decomposition = Chebyshev::lay_out(params, &planned.site).map_err(|e| refused(&e))?;
        let tour = Tour::new(&decomposition, first, &params.route, &params.iterations)
            .map_err(|e| refused(&e))?;
        planned.tour = Some(tour);
    }
    Ok(planned)
}

fn any<D: Design>(order: &Order<'_>) -> Result<PlannedCoverage, RouteError> {
    order.plan::<D>(order.router.params()?)
}

impl Order<'_> {
    fn site(&self, follow: &FollowParams) -> Result<Site, RouteError> {
        let refused = |reason: &dyn std::fmt::Display| self.router.refused(reason);
        let map = WorldMap::recent(&self.scenario.world.map).map_err(|e| refused(&e))?;
        let robot = self.router.robot;
        let here = robot.start.position();
        Site::new(
            *map.bounds(),
            map.parts(),
            robot.model().radius,
            follow,
            here,
        )
        .map_err(|e| refused(&e))
    }

    fn plan<D: Design>(&self, params: &D::Params) -> Result<PlannedCoverage, RouteError> {
        let refused = |reason: &dyn std::fmt::Display| self.router.refused(reason);
        parameters::check(params).map_err(|e| refused(&e))?;
        let follow = D::follow(params);
        let mut site = self.site(&follow)?;
        let own = self.router.process.robots.first().copied().unwrap_or(0);
        let team = self.scenario.companions(own);
        if follow.divide && team.len() > 1 {
            let place = |&robot: &usize| {
                let start = self.scenario.world.robots.get(robot)?.start.position();
                Some(Place { start, here: start })
            };
            let places: Vec<Place> = team.iter().filter_map(place).collect();
            let number = team.iter().position(|&robot| robot == own).unwrap_or(0);
            site = site.divided(&places, number).map_err(|e| refused(&e))?;
        }
        // Area that the robot's body covers; the margin is for its drive only.
        let bare = FollowParams {
            margin: 0.0,
            ..follow
        };
        let domain = self.site(&bare)?.workplace.domain();
        let meter = domain.and_then(|domain| Meter::new(&domain, STEP)).ok();
        let seed = self.router.seed(self.scenario);
        let mut source = D::goals(params, &site, seed, None).map_err(|e| refused(&e))?;
        let (goals, figures) = self.take(site.start, &mut source, meter);
        Ok(PlannedCoverage {
            process: self.router.process.name.clone(),
            robot: self.router.robot.name.clone(),
            tour: None,
            goals,
            figures,
            site,
        })
    }

    /// Returns the sub-goals up to the requested extent.
    fn take(
        &self,
        start: Point2<f64>,
        source: &mut impl GoalSource,
        mut meter: Option<Meter>,
    ) -> (Vec<Goal>, Option<Figures>) {
        let (mut here, mut way) = (start, 0.0);
        if let Some(meter) = &mut meter {
            meter.goal(here);
        }
        let mut goals = Vec::new();
        while (goals.len() as u64) < MAX_GOALS {
            let Some(goal) = source.next_goal(here) else {
                break;
            };
            let there = goal.waypoint.point;
            let length = (there - here).norm();
            let done = match self.extent {
                Extent::Loops(loops) => goal.waypoint.lap >= loops,
                Extent::Goals(most) => goals.len() as u64 >= most,
                Extent::Length(most) => way + length > most,
            };
            if done {
                break;
            }
            way += length;
            source.driven(here, there);
            here = there;
            if let Some(meter) = &mut meter {
                meter.goal(there);
            }
            goals.push(goal);
        }
        (goals, meter.map(|meter| meter.figures()))
    }
}

impl PlannedCoverage {
    /// Returns the result as JSON.
    pub fn json(&self) -> Json {
        let decomposition = &self.site.decomposition;
        let loss = self.site.workplace.loss();
        let start = decomposition.rectangle_at(self.site.start);
        let unreachable = start.map(|start| decomposition.unreachable_from(start));
        json!({
            "process": self.process,
            "robot": self.robot,
            "start": point_json(self.site.start),
            "area": decomposition.area(),
            "conversion_loss": { "area": loss.area, "share": loss.share },
            "components": decomposition.components(),
            "unreachable_area": unreachable.map(|u| u.area),
            "rectangles": decomposition.rectangles().iter().map(box_json).collect::<Json>(),
            "bridges": decomposition
                .bridges()
                .iter()
                .map(|b| json!({ "between": b.between, "rectangle": box_json(&b.rectangle) }))
                .collect::<Json>(),
            "tour": self.tour.as_ref().map(|tour| {
                let stops = tour.stops().iter();
                stops
                    .map(|s| json!({ "rectangle": s.rectangle, "iterations": s.iterations }))
                    .collect::<Json>()
            }),
            "sub_goals": self
                .goals
                .iter()
                .map(|goal| {
                    let w = &goal.waypoint;
                    json!({
                        "number": w.number,
                        "loop": w.lap,
                        "kind": kind_name(w.kind),
                        "x": w.point.x,
                        "y": w.point.y,
                    })
                })
                .collect::<Json>(),
            "coverage": self.figures.as_ref().map(figures_json),
        })
    }
}

fn point_json(p: Point2<f64>) -> Json {
    json!([p.x, p.y])
}

fn box_json(r: &Aabb) -> Json {
    json!({ "min": point_json(r.min), "max": point_json(r.max) })
}

fn figures_json(f: &Figures) -> Json {
    let by_side = |rates: &[Rate; 3]| -> Json {
        let pairs = CELL_SIDES.iter().zip(rates);
        pairs
            .map(|(side, rate)| {
                let value = json!({
                    "covered": rate.covered,
                    "coverable": rate.coverable,
                    "rate": rate.share(),
                });
                (side.to_string(), value)
            })
            .collect::<serde_json::Map<_, _>>()
            .into()
    };
    json!({
        "length": f.length,
        "goals": by_side(&f.goals),
        "path": by_side(&f.path),
        "disc": {
            "covered": f.disc.covered,
            "coverable": f.disc.coverable,
            "rate": f.disc.share(),
        },
        "unevenness": CELL_SIDES
            .iter()
            .zip(f.variation)
            .map(|(side, cv)| (side.to_string(), json!(cv)))
            .collect::<serde_json::Map<_, _>>(),
    })
}
