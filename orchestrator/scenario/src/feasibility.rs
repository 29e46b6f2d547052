//! Checks that the starts of all robots are free and that their goals and the exits are reachable.

use config::{Code, Diagnostic, FieldPath, Step};
use geometry::grid::Grid;
use geometry::map::{MapSpec, Occupancy, VectorMap, WorldMap};
use geometry::pose::Pose2;
use geometry::region::Region;
use nalgebra::{Point2, Vector2};
use robot::team::Role;
use sim_backend::spec::{RulesSpec, WorldSpec};
use sim_backend::world::{World, WorldError};

use super::context::Context;
use super::robots::Robot;
use super::starts::{self, Placement, passages};
use super::world::MapSetup;

/// Checks that every robot starts in free space, draws the displaced starts, and checks that exits and
/// goals are reachable. Reports all problems and returns the starts.
pub fn resolve(
    ctx: &mut Context<'_>,
    setup: &MapSetup,
    robots: &[Robot],
    placements: &[Placement],
    rules: &RulesSpec,
    seed: u64,
) -> Option<Vec<Pose2>> {
    let world_map = match WorldMap::recent(&setup.map) {
        Ok(world_map) => world_map,
        Err(e) => {
            let path = FieldPath::key("world").then("map");
            let origin = ctx.root.origin_along(&path);
            ctx.problems
                .push(ctx.block_problem(origin, &path, Code::Geometry, e.to_string()));
            return None;
        }
    };
    let fine = check_walls(ctx, &world_map, setup.occupancy.as_ref(), robots)
        & check_overlaps(ctx, robots);
    if !fine {
        return None;
    }
    let starts = match starts::place(placements, seed, &world_map, rules) {
        Ok(starts) => starts,
        Err(refused) => {
            let robot = robots.get(refused.index)?;
            let message = refused.message(&robot.spec.name);
            let problem = ctx.problem(
                &robot.node,
                &robot.path,
                refused.key(),
                Code::Geometry,
                message,
            );
            ctx.problems.push(refused.explain(problem));
            return None;
        }
    };
    check_exits(ctx, &world_map, robots, &starts, rules);
    check_goals(ctx, &world_map, robots, &starts);
    if ctx.problems.is_empty() {
        check_world(ctx, &world_map, robots, &starts, rules, seed);
    }
    Some(starts)
}

/// Reports everything that the world would refuse, before any process starts.
fn check_world(
    ctx: &mut Context<'_>,
    world_map: &WorldMap,
    robots: &[Robot],
    starts: &[Pose2],
    rules: &RulesSpec,
    seed: u64,
) {
    let displaced = robots.iter().zip(starts).map(|(robot, &start)| {
        let mut spec = robot.spec.clone();
        spec.start = start;
        spec
    });
    // The world map exists already, so that the map of the specification is not used.
    let map = MapSpec::Vector(VectorMap::empty([0.0; 2], [1.0; 2], 1.0));
    let spec = WorldSpec {
        map,
        robots: displaced.collect(),
        rules: rules.clone(),
        seed,
    };
    let e = match World::on_map(world_map.clone(), spec) {
        Ok(_) => return,
        Err(WorldError::Rules(e)) => {
            let path = FieldPath::key("rules");
            let node = ctx.root.follow(&path).clone();
            ctx.refuse(&node, &path, e);
            return;
        }
        Err(e) => e,
    };
    let concerned = match &e {
        WorldError::ExitUnreachable { index, .. }
        | WorldError::GoalUnreachable { index, .. }
        | WorldError::OutsideMap { index, .. }
        | WorldError::InWall { index, .. }
        | WorldError::Robot { index, .. }
        | WorldError::Overlap { second: index, .. } => robots.get(*index),
        _ => None,
    };
    let problem = match concerned {
        Some(robot) => ctx.problem(
            &robot.node,
            &robot.path,
            "start",
            Code::Geometry,
            e.to_string(),
        ),
        None => Diagnostic::new(Code::Geometry, e.to_string()),
    };
    ctx.problems.push(problem);
}

fn check_walls(
    ctx: &mut Context<'_>,
    world_map: &WorldMap,
    occupancy: Option<&Grid<Occupancy>>,
    robots: &[Robot],
) -> bool {
    let mut fine = true;
    for robot in robots.iter().filter(|robot| robot.has_start()) {
        let at = robot.spec.start.position();
        let radius = robot.spec.model().radius;
        if world_map.is_clear(at, radius) {
            continue;
        }
        let name = &robot.spec.name;
        let distance = world_map.distance(at);
        let is_unknown = occupancy.is_some_and(|map| covers_unknown(map, at, radius));
        let message = if is_unknown {
            format!("robot `{name}` starts on a cell that the map marks unknown")
        } else if distance > 0.0 {
            format!(
                "robot `{name}` starts in a wall: {distance:.3} m from its centre to the wall, \
                 {radius} m to its edge"
            )
        } else {
            format!("robot `{name}` starts in a wall or outside the map")
        };
        let mut problem = ctx
            .problem(&robot.node, &robot.path, "start", Code::Geometry, message)
            .value(format!("x = {}, y = {} (m)", at.x, at.y))
            .expected(format!("a place at least {radius} m from every wall"));
        if is_unknown {
            problem = problem.help(
                "map = { file = { path = \"…\", unknown = \"free\" } } makes unknown cells free",
            );
        }
        ctx.problems.push(problem);
        fine = false;
    }
    fine
}

/// Returns `true` if the cell of a disc's centre is unknown, or if the disc (m) covers unknown cells and neither an
/// occupied one nor the edge of the map.
fn covers_unknown(map: &Grid<Occupancy>, center: Point2<f64>, radius: f64) -> bool {
    let Some(own) = map.at(center) else {
        return false;
    };
    if *own != Occupancy::Free {
        return *own == Occupancy::Unknown;
    }
    let frame = map.frame;
    let corner = Vector2::new(radius, radius);
    let (Some(from), Some(to)) = (
        frame.cell_at(center - corner),
        frame.cell_at(center + corner),
    ) else {
        return false;
    };
    let half = 0.5 * frame.resolution;
    let mut is_unknown = false;
    for row in from.1..=to.1 {
        for column in from.0..=to.0 {
            let away = frame.center(column, row) - center;
            let outside = away.map(|d| (d.abs() - half).max(0.0));
            match map.cells.get(frame.index(column, row)) {
                Some(Occupancy::Occupied) if outside.norm() < radius => return false,
                Some(Occupancy::Unknown) if outside.norm() < radius => is_unknown = true,
                _ => {}
            }
        }
    }
    is_unknown
}

fn check_overlaps(ctx: &mut Context<'_>, robots: &[Robot]) -> bool {
    let mut fine = true;
    let robots: Vec<&Robot> = robots.iter().filter(|robot| robot.has_start()).collect();
    for (i, robot) in robots.iter().enumerate() {
        for other in robots.iter().take(i) {
            let distance = (robot.spec.start.position() - other.spec.start.position()).norm();
            let least = robot.spec.model().radius + other.spec.model().radius;
            if distance > least {
                continue;
            }
            let message = format!(
                "robots `{}` and `{}` start in one place: {distance:.3} m apart",
                other.spec.name, robot.spec.name
            );
            let at = robot.spec.start;
            ctx.problems.push(
                ctx.problem(&robot.node, &robot.path, "start", Code::Geometry, message)
                    .value(format!("x = {}, y = {} (m)", at.x, at.y))
                    .expected(format!("centres more than {least:.3} m apart")),
            );
            fine = false;
        }
    }
    fine
}

/// Checks that some evader can reach every exit, if there are evaders.
fn check_exits(
    ctx: &mut Context<'_>,
    world_map: &WorldMap,
    robots: &[Robot],
    starts: &[Pose2],
    rules: &RulesSpec,
) {
    let evaders: Vec<(&Robot, &Pose2)> = robots
        .iter()
        .zip(starts)
        .filter(|(r, _)| r.spec.role() == Role::Evader)
        .collect();
    let slimmest = evaders
        .iter()
        .map(|(r, _)| r.spec.model().radius)
        .fold(f64::INFINITY, f64::min);
    if evaders.is_empty() {
        return;
    }
    let passages = passages(world_map, slimmest);
    let reach = passages.reach(evaders.iter().map(|(_, start)| start.position()));
    let of_rules = rules.exits.iter().enumerate().map(|(i, exit)| {
        (
            exit,
            FieldPath::key("rules").then("exits").step(Step::Index(i)),
        )
    });
    let of_map = world_map
        .exits()
        .iter()
        .map(|e| (e, FieldPath::key("world").then("map")));
    let exits: Vec<(Region, FieldPath)> =
        of_rules.chain(of_map).map(|(e, path)| (*e, path)).collect();
    for (exit, path) in exits {
        if reach.meets(&exit) {
            continue;
        }
        let center = exit.center();
        let origin = ctx.root.origin_along(&path);
        ctx.problems.push(
            ctx.block_problem(
                origin,
                &path,
                Code::Geometry,
                "no evader can reach this exit",
            )
            .value(format!("exit at x = {}, y = {} (m)", center.x, center.y))
            .expected(format!(
                "a way for a robot of radius {slimmest} m from the start of an evader"
            )),
        );
    }
}

/// Checks that every robot can reach its goal.
fn check_goals(ctx: &mut Context<'_>, world_map: &WorldMap, robots: &[Robot], starts: &[Pose2]) {
    for (robot, start) in robots.iter().zip(starts) {
        let Some(goal) = robot.spec.goal else {
            continue;
        };
        let radius = robot.spec.model().radius;
        let passages = passages(world_map, radius);
        if passages.reach([start.position()]).meets(&goal) {
            continue;
        }
        let center = goal.center();
        let message = format!("robot `{}` cannot reach its goal", robot.spec.name);
        ctx.problems.push(
            ctx.problem(&robot.node, &robot.path, "goal", Code::Geometry, message)
                .value(format!("goal at x = {}, y = {} (m)", center.x, center.y))
                .expected(format!(
                    "a way for a robot of radius {radius} m from its start"
                )),
        );
    }
}
