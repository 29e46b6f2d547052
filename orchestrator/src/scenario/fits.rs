//! Whether processes can do what they are told, with these robots on this map: what neither of the
//! three shows by itself, and what would otherwise only be seen when the run starts.

use config::{Code, FieldPath, Step};
use coverage::sub_goals::design::{Design, Site};
use coverage::workplace::{Workplace, WorkplaceError};
use coverage_planners::{Boustrophedon, Chebyshev, Keyed, RandomBounce, Uniform};
use nalgebra::Point2;
use patrol::mission::{Drive, MissionParams};
use patrol_planners::{PatrolAwgParams, PatrolFtoParams};
use planner::planner_seed;
use serde::de::DeserializeOwned;
use serde_json::Value as Json;
use sim_backend::map::{MapSpec, WorldMap};
use sim_backend::shape::Shape;
use sim_backend::spec::RobotSpec;
use steering::waypoint_driver::DriverParams;

use super::context::Context;
use super::processes::{Read, kind_of};
use super::robots::Robot;

/// What a process is told to do with one of its robots.
struct Task<'a> {
    params: &'a Json,
    robot: &'a RobotSpec,
    map: &'a MapSpec,
    ground: &'a WorldMap,
    seed: u64,
}

/// What does not fit.
enum Misfit {
    /// A parameter, by its path inside `params`.
    Param { field: String, message: String },
    /// An obstacle of the map, by its number.
    Obstacle { index: usize, message: String },
}

impl Misfit {
    fn param(field: &str, message: &dyn core::fmt::Display) -> Self {
        Self::Param {
            field: field.to_owned(),
            message: message.to_string(),
        }
    }
}

/// How a kind of process finds out.
type Fits = fn(&Task<'_>) -> Result<(), Misfit>;

/// The kinds that have something to find out.
const KINDS: [(&str, Fits); 7] = [
    ("patrol_awg", patrol_awg),
    ("patrol_fto", patrol_fto),
    ("coverage_chebyshev", coverage::<Chebyshev>),
    ("keyed_coverage", coverage::<Keyed>),
    ("coverage_boustrophedon", coverage::<Boustrophedon>),
    ("coverage_random_bounce", coverage::<RandomBounce>),
    ("coverage_uniform", coverage::<Uniform>),
];

/// Reports what does not fit, the first thing of every process.
pub fn check(ctx: &mut Context<'_>, map: &MapSpec, robots: &[Robot], read: &[Read], seed: u64) {
    let fits = |r: &Read| {
        let kind = kind_of(ctx.kinds, &r.spec)?;
        let (name, fits) = KINDS.iter().find(|(name, _)| *name == kind.name)?;
        Some((*name, *fits))
    };
    let concerned: Vec<(&Read, &str, Fits)> = read
        .iter()
        .filter_map(|r| fits(r).map(|(name, fits)| (r, name, fits)))
        .collect();
    if concerned.is_empty() {
        return;
    }
    // A map that cannot be made is reported with the robots' places.
    let Ok(ground) = WorldMap::recent(map) else {
        return;
    };
    for (r, kind, fits) in concerned {
        let driven = r.spec.robots.iter().filter_map(|&i| robots.get(i));
        let misfit = driven
            .map(|robot| Task {
                params: &r.spec.params,
                robot: &robot.spec,
                map,
                ground: &ground,
                seed: planner_seed(seed, kind, &robot.spec.name),
            })
            .find_map(|task| fits(&task).err());
        match misfit {
            None => {}
            Some(Misfit::Param { field, message }) => {
                let path = r.path.then("params");
                let block = ctx.root.follow(&r.path).clone();
                let written = block.get("params").is_some();
                let problem = if written {
                    let params = ctx.root.follow(&path).clone();
                    ctx.problem(&params, &path, &field, Code::OutOfRange, message)
                } else {
                    let path = path.join(&FieldPath::parse(&field));
                    ctx.block_problem(r.origin, &path, Code::OutOfRange, message)
                };
                ctx.problems.push(problem);
            }
            Some(Misfit::Obstacle { index, message }) => {
                let list = FieldPath::parse("world.map.vector.obstacles");
                let path = list.step(Step::Index(index));
                let origin = ctx.root.origin_along(&path);
                let problem = ctx.block_problem(origin, &path, Code::Geometry, message);
                ctx.problems.push(problem);
            }
        }
    }
}

/// The parameters, which have been read before.
fn params<P: DeserializeOwned>(task: &Task<'_>) -> Result<P, Misfit> {
    serde_json::from_value(task.params.clone()).map_err(|e| Misfit::param("", &e))
}

fn patrol_awg(task: &Task<'_>) -> Result<(), Misfit> {
    let params: PatrolAwgParams = params(task)?;
    patrol(
        task,
        &params.mission,
        &params.driver,
        params.obstacles_known,
    )
}

fn patrol_fto(task: &Task<'_>) -> Result<(), Misfit> {
    let params: PatrolFtoParams = params(task)?;
    patrol(
        task,
        &params.mission,
        &params.driver,
        params.obstacles_known,
    )
}

fn patrol(
    task: &Task<'_>,
    mission: &MissionParams,
    driver: &DriverParams,
    obstacles_known: bool,
) -> Result<(), Misfit> {
    let model = task.robot.model();
    let bounds = task.ground.bounds();
    for (index, &[x, y]) in mission.contour.iter().enumerate() {
        let at = Point2::new(x, y);
        let (low, high) = (at - bounds.min, bounds.max - at);
        let room = low.x.min(low.y).min(high.x).min(high.y);
        let field = format!("mission.contour[{index}]");
        if room + driver.go_to.arrived < model.radius {
            let message = format!(
                "`contour[{index}]` is ({x}, {y}), where the robot of radius {} m does not fit into \
                 the map from ({}, {}) to ({}, {}): move it inside or enlarge the map",
                model.radius, bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y
            );
            return Err(Misfit::Param { field, message });
        }
        if obstacles_known && !task.ground.is_clear(at, model.radius) {
            let message = format!(
                "`contour[{index}]` is ({x}, {y}), where an obstacle leaves no room for the robot of \
                 radius {} m, which knows the obstacles: move one of the two",
                model.radius
            );
            return Err(Misfit::Param { field, message });
        }
    }
    let drive = Drive::of(&model).map_err(|e| Misfit::param("mission", &e))?;
    mission
        .check(&drive, &driver.go_to, task.seed)
        .map_err(|e| {
            let message = e.to_string();
            let named = message.split('`').nth(1).unwrap_or("t_max");
            Misfit::param(&format!("mission.{named}"), &message)
        })
}

fn coverage<D: Design>(task: &Task<'_>) -> Result<(), Misfit> {
    let params: D::Params = params(task)?;
    let follow = D::follow(&params);
    let bounds = *task.ground.bounds();
    let radius = task.robot.model().radius;
    if let MapSpec::Vector(map) = task.map {
        let shapes: Vec<Shape> = map.obstacles.iter().map(|o| o.shape.clone()).collect();
        let made = Workplace::new(bounds, radius, &shapes, follow.tolerance);
        if let Err(error) = made
            && let WorkplaceError::Outside { index, .. } | WorkplaceError::Covering { index } =
                error
        {
            let name = map.obstacles.get(index).map_or("", |o| o.name.as_str());
            let message = error.to_string();
            let message = message.replacen(&format!("obstacles[{index}]"), &format!("`{name}`"), 1);
            return Err(Misfit::Obstacle { index, message });
        }
    }
    let here = task.robot.start.position();
    Site::new(bounds, task.ground.parts(), radius, &follow, here)
        .and_then(|site| D::goals(&params, &site, task.seed, None).map(drop))
        .map_err(|message| Misfit::param(field_of(&message), &message))
}

/// The parameter that a refusal is about.
fn field_of(message: &str) -> &str {
    let first = message.split(|c: char| !c.is_alphanumeric()).next();
    match first.unwrap_or_default() {
        "route" => "route",
        "iterations" => "iterations",
        "bridge" => "bridges",
        "tolerance" => "follow.tolerance",
        _ => message.split('`').nth(1).unwrap_or_default(),
    }
}
