//! Checks that each process can do its task with its robots on this map, and that the messages of the run have room for
//! the map. Only the combination of all shows these faults, which would otherwise appear when the run starts.

use config::{Code, FieldPath, Step};
use geometry::map::{MapSpec, WorldMap};
use robot::spec::RobotSpec;
use runtime::declaration::Input;
use runtime::kind::{Task, TaskFault};
use runtime::shapes;
use sim_backend::spec::RulesSpec;

use super::read::ProcessEntry;
use crate::context::Context;
use crate::events::EventSpec;
use crate::robots::Robot;

/// Reports the first mismatch of every process.
pub fn check(
    ctx: &mut Context<'_>,
    map: &MapSpec,
    robots: &[Robot],
    rules: &RulesSpec,
    events: &[EventSpec],
    read: &[ProcessEntry],
    seed: u64,
) {
    // An invalid map is reported with the robots' places.
    let Ok(world_map) = WorldMap::recent(map) else {
        return;
    };
    check_pieces(ctx, &world_map, events, read);
    let specs: Vec<RobotSpec> = robots.iter().map(|robot| robot.spec.clone()).collect();
    for r in read {
        let Some(kind) = r.spec.program.kind() else {
            continue;
        };
        let driven = r.spec.robots.iter().filter_map(|&i| specs.get(i));
        let fault = driven
            .map(|robot| Task {
                robot,
                companions: 0,
                robots: &specs,
                exits: rules.exits.len() + world_map.exits().len(),
                map,
                world_map: &world_map,
                run_seed: seed,
            })
            .find_map(|task| kind.check_task(&task).err());
        match fault {
            None => {}
            Some(TaskFault::Param { field, message }) => {
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
            Some(TaskFault::Obstacle { index, message }) => {
                let list = FieldPath::parse("world.map.vector.obstacles");
                let path = list.step(Step::Index(index));
                let origin = ctx.root.origin_along(&path);
                ctx.problems
                    .push(ctx.block_problem(origin, &path, Code::Geometry, message));
            }
        }
    }
}

/// Reports a map with more pieces than `world/shapes` holds, if a process needs them.
fn check_pieces(
    ctx: &mut Context<'_>,
    map: &WorldMap,
    events: &[EventSpec],
    read: &[ProcessEntry],
) {
    let requires = |r: &&ProcessEntry| {
        let declaration = r.spec.declaration();
        declaration.is_some_and(|known| known.required().any(|flow| flow == Input::SHAPES.flow))
    };
    let Some(r) = read.iter().find(requires) else {
        return;
    };
    let path = FieldPath::parse("world.map");
    let (message, value) = match shapes::most_points(map, EventSpec::shapes(events)) {
        Ok(points) if points <= shapes::MAX_POINTS => return,
        Ok(points) => {
            let message = format!(
                "the map has too many pieces for process `{}`, which plans among them",
                r.spec.name
            );
            let pieces = map.parts().len();
            (
                message,
                format!("{pieces} pieces, with all events {points} corners"),
            )
        }
        Err(e) => (e.to_string(), String::new()),
    };
    ctx.problems.push(
        ctx.block_problem(ctx.root.origin_along(&path), &path, Code::Limit, message)
            .value(value)
            .expected(format!(
                "at most {} corners: {} rectangles of a grid",
                shapes::MAX_POINTS,
                shapes::MAX_POINTS / 4
            ))
            .help(
                "use coarser cells, remove noise from the map, or use obstacles with fewer corners",
            ),
    );
}
