//! `[[processes]]`: the processes of a run and the robots that each drives.

mod checks;
mod files;
mod read;
mod tasks;

use config::Code;
use geometry::map::MapSpec;
use runtime::kind::Product;
use sim_backend::spec::RulesSpec;

use super::context::Context;
use super::events::EventSpec;
use super::files::Base;
use super::resolved::ProcessSpec;
use super::robots::Robot;
use super::spec::{MAX_PROCESSES, RunSpec};
use checks::{check_drivers, check_names, check_needs};
use read::Read;

/// Reads all processes, checks that every robot is driven by exactly one, and that each process can do
/// its task on this map. Reports all problems.
pub fn resolve(
    ctx: &mut Context<'_>,
    base: &Base,
    robots: Option<&[Robot]>,
    map: Option<&MapSpec>,
    rules: Option<&RulesSpec>,
    events: &[EventSpec],
    run: &RunSpec,
) -> Vec<ProcessSpec> {
    let mut read: Vec<Read> = Vec::new();
    let before = ctx.problems.len();
    for (path, node) in ctx.blocks("processes") {
        read::block(ctx, base, &node, &path, robots, run, &mut read);
    }
    if let Some(extra) = read.get(MAX_PROCESSES) {
        let problem = ctx
            .block_problem(extra.origin, &extra.path, Code::Limit, "too many processes")
            .value(read.len())
            .expected(format!("at most {MAX_PROCESSES} processes"))
            .help("let one process drive several robots: grouping = \"together\"");
        ctx.problems.push(problem);
    }
    check_names(ctx, &read);
    // A process that is unreadable may drive the robots without a driver.
    if ctx.problems.len() == before
        && let Some(robots) = robots
    {
        check_drivers(ctx, &read, robots);
        check_needs(ctx, &read, robots);
        if let (Some(map), Some(rules)) = (map, rules)
            && ctx.problems.len() == before
        {
            tasks::check(ctx, map, robots, rules, events, &read, run.seed);
        }
    }
    // Processes that others wait for come first; otherwise the order of the file holds.
    read.sort_by_key(|r| !r.spec.makes(Product::Beliefs));
    read.into_iter().map(|r| r.spec).collect()
}
