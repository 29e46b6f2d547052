//! `[[processes]]`: who runs, and who drives which robot.

use config::{Code, FieldPath, Node, Origin, Step, describe, suggest};
use sim_backend::map::MapSpec;
use sim_backend::team::Team;

use super::context::Context;
use super::failure;
use super::fits;
use super::kinds::{KindInfo, ParamsFault, Product, find};
use super::process_checks::{check_drivers, check_names, check_needs};
use super::resolved::{ProcessSpec, Program};
use super::robots::{Robot, check_name};
use super::spec::{Grouping, MAX_PROCESSES, ProcessBlock, RunSpec};

/// A process as read, with its place for complaints.
pub struct Read {
    /// The process.
    pub spec: ProcessSpec,
    /// Where its block is written.
    pub origin: Origin,
    /// The path of its block.
    pub path: FieldPath,
}

/// Reads all processes, checks that every robot is driven by exactly one, and that it can do on this
/// map what its process is told to; everything wrong is reported.
pub fn resolve(
    ctx: &mut Context<'_>,
    robots: Option<&[Robot]>,
    map: Option<&MapSpec>,
    run: &RunSpec,
) -> Vec<ProcessSpec> {
    let mut read: Vec<Read> = Vec::new();
    let before = ctx.problems.len();
    for (path, node) in ctx.blocks("processes") {
        read_block(ctx, &node, &path, robots, run, &mut read);
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
    // A process that could not be read might have driven the robots that now seem idle.
    if ctx.problems.len() == before
        && let Some(robots) = robots
    {
        check_drivers(ctx, &read, robots);
        check_needs(ctx, &read, robots);
        if let Some(map) = map.filter(|_| ctx.problems.len() == before) {
            fits::check(ctx, map, robots, &read, run.seed);
        }
    }
    // Those that others wait for come first; otherwise the order of the file.
    let kinds = ctx.kinds;
    let provides = |p: &ProcessSpec| kind_of(kinds, p).is_some_and(|k| k.makes(Product::Beliefs));
    read.sort_by_key(|r| !provides(&r.spec));
    read.into_iter().map(|r| r.spec).collect()
}

/// The kind of a process; none if it is a command.
pub fn kind_of<'k>(kinds: &'k [KindInfo], process: &ProcessSpec) -> Option<&'k KindInfo> {
    match &process.program {
        Program::Kind(name) => find(kinds, name),
        Program::Command(_) => None,
    }
}

fn read_block(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    robots: Option<&[Robot]>,
    run: &RunSpec,
    read: &mut Vec<Read>,
) {
    let Some(block) = ctx.read::<ProcessBlock>(node, path) else {
        return;
    };
    let Some((program, kind)) = read_program(ctx, node, path, &block) else {
        return;
    };
    let fallback = block.kind.clone().unwrap_or_default();
    let name = block.name.clone().unwrap_or(fallback);
    if !check_name(ctx, node, path, &name) {
        return;
    }
    let Some(params) = read_params(ctx, node, path, kind) else {
        return;
    };
    let Some(driven) = read_robots(ctx, node, path, &block, kind, robots) else {
        return;
    };
    let Some(supervision) = failure::read(ctx, node, path, &block, run) else {
        return;
    };
    let together = block.grouping == Some(Grouping::Together) || driven.len() <= 1;
    let groups: Vec<(String, Vec<usize>)> = if together {
        vec![(name, driven)]
    } else {
        let own = |&i: &usize| {
            let robot = robots
                .and_then(|r| r.get(i))
                .map_or("", |r| r.spec.name.as_str());
            (format!("{name}_{robot}"), vec![i])
        };
        driven.iter().map(own).collect()
    };
    for (name, robots) in groups {
        let spec = ProcessSpec {
            name,
            program: program.clone(),
            robots,
            supervision,
            params: params.clone(),
        };
        read.push(Read {
            spec,
            origin: node.origin,
            path: path.clone(),
        });
    }
}

fn read_program<'k>(
    ctx: &mut Context<'k>,
    node: &Node,
    path: &FieldPath,
    block: &ProcessBlock,
) -> Option<(Program, Option<&'k KindInfo>)> {
    let problem = match (&block.kind, &block.command) {
        (Some(kind), None) => {
            if let Some(info) = find(ctx.kinds, kind) {
                return Some((Program::Kind(kind.clone()), Some(info)));
            }
            if kind == "simulator" {
                ctx.problem(
                    node,
                    path,
                    "kind",
                    Code::Requirement,
                    "the simulator always runs and is not listed",
                )
                .help(
                    "remove this block; the world is described in [world], [rules] and [[robots]]",
                )
            } else {
                let names: Vec<&str> = ctx.kinds.iter().map(|k| k.name).collect();
                let message = format!("unknown process kind `{kind}`");
                let blank = ctx.problem(node, path, "kind", Code::UnknownName, message);
                suggest(blank, kind, &names, "")
            }
        }
        (None, Some(command)) => match command.first() {
            Some(program) if !program.is_empty() && command.iter().all(|a| !a.contains('\0')) => {
                return Some((Program::Command(command.clone()), None));
            }
            _ => ctx
                .problem(
                    node,
                    path,
                    "command",
                    Code::OutOfRange,
                    "the command names no program",
                )
                .expected("command = [\"program\", \"argument\", …]"),
        },
        (Some(_), Some(_)) => ctx
            .problem(
                node,
                path,
                "command",
                Code::Requirement,
                "both `kind` and `command`",
            )
            .expected("one of them: `kind` for a process of ours, `command` for one of yours"),
        (None, None) => ctx
            .block_problem(
                node.origin,
                path,
                Code::MissingKey,
                "a process without `kind`",
            )
            .expected("kind = \"…\" for a process of ours, or command = [\"…\"] for one of yours"),
    };
    ctx.problems.push(problem);
    None
}

fn read_params(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    kind: Option<&KindInfo>,
) -> Option<serde_json::Value> {
    let path = path.then("params");
    let empty = Node::empty_table(node.origin);
    let params = node.get("params").unwrap_or(&empty);
    if params.as_table().is_none() {
        let message = format!("wrong type: {}", params.type_name());
        let problem = ctx
            .problem(params, &path, "", Code::WrongType, message)
            .expected("a table");
        ctx.problems.push(problem);
        return None;
    }
    let Some(kind) = kind else {
        // The user's own program reads them.
        return ctx.read(params, &path);
    };
    let params = &apply_preset(ctx, params, &path, kind)?;
    let json = match (kind.check_params)(params) {
        Ok(json) => json,
        Err(ParamsFault::Read(_)) => {
            // Reported in full, one by one, by leaving out what is wrong and trying again.
            let mut left = params.clone();
            report_all(ctx, kind, &mut left, &path);
            return None;
        }
        Err(ParamsFault::Field(found)) => {
            ctx.refuse(params, &path, found);
            return None;
        }
        Err(ParamsFault::Refused { field, message }) => {
            let problem = ctx.problem(params, &path, &field, Code::OutOfRange, message);
            ctx.problems.push(problem);
            return None;
        }
        Err(ParamsFault::Write(message)) => {
            let problem = ctx.problem(params, &path, "", Code::OutOfRange, message);
            ctx.problems.push(problem);
            return None;
        }
    };
    Some(json)
}

/// The parameters with `preset = "…"` replaced by what it stands for, under the other keys.
fn apply_preset(
    ctx: &mut Context<'_>,
    params: &Node,
    path: &FieldPath,
    kind: &KindInfo,
) -> Option<Node> {
    let Some(preset) = params.get("preset") else {
        return Some(params.clone());
    };
    let name = preset.as_str().unwrap_or_default();
    let Some((_, values)) = kind.presets.iter().find(|p| p.0 == name) else {
        let names: Vec<&str> = kind.presets.iter().map(|p| p.0).collect();
        let message = format!("kind `{}` has no such preset", kind.name);
        let blank = ctx.problem(params, path, "preset", Code::UnknownName, message);
        ctx.problems.push(suggest(blank, name, &names, ""));
        return None;
    };
    let mut merged = Node::from_json(&values()).unwrap_or(Node::empty_table(Origin::Implied));
    merged.origin = params.origin;
    if let (Some(table), Some(own)) = (merged.as_table_mut(), params.as_table()) {
        table.overlay(own);
        table.remove("preset");
    }
    Some(merged)
}

/// Reports every key of `params` that its kind cannot read.
fn report_all(ctx: &mut Context<'_>, kind: &KindInfo, left: &mut Node, path: &FieldPath) {
    while let Err(ParamsFault::Read(error)) = (kind.check_params)(left) {
        let problem = describe(&ctx.sources, &error, path);
        ctx.problems.push(problem);
        let Some(Step::Key(key)) = error.path.0.first() else {
            return;
        };
        if left.as_table_mut().and_then(|t| t.remove(key)).is_none() {
            return;
        }
    }
}

/// The indices of the robots that a block drives.
fn read_robots(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    block: &ProcessBlock,
    kind: Option<&KindInfo>,
    robots: Option<&[Robot]>,
) -> Option<Vec<usize>> {
    let named = block.robots.as_deref();
    if named.is_some() && block.team.is_some() {
        let problem = ctx
            .problem(
                node,
                path,
                "team",
                Code::Requirement,
                "both `robots` and `team`",
            )
            .expected("one of them");
        ctx.problems.push(problem);
        return None;
    }
    let drives = kind.is_none_or(|k| k.drives_robots);
    let gives = if named.is_some() { "robots" } else { "team" };
    if !drives {
        if named.is_some() || block.team.is_some() {
            let kind = kind.map_or("", |k| k.name);
            let message = format!("a process of kind `{kind}` drives no robots");
            let problem = ctx
                .problem(node, path, gives, Code::Requirement, message)
                .expected(format!("no `{gives}`"));
            ctx.problems.push(problem);
            return None;
        }
        return Some(Vec::new());
    }
    let Some(robots) = robots else {
        return Some(Vec::new());
    };
    let mut driven = match (named, block.team) {
        (Some(names), _) => named_robots(ctx, node, path, names, robots)?,
        (None, Some(team)) => team_robots(ctx, node, path, team, robots)?,
        (None, None) => Vec::new(),
    };
    if driven.is_empty() && kind.is_some() {
        let problem = ctx
            .block_problem(
                node.origin,
                path,
                Code::Requirement,
                "this process drives no robot",
            )
            .expected("robots = [\"…\"] or team = \"police\", \"evader\" or \"neutral\"");
        ctx.problems.push(problem);
        return None;
    }
    driven.sort_unstable();
    Some(driven)
}

fn named_robots(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    names: &[String],
    robots: &[Robot],
) -> Option<Vec<usize>> {
    let mut driven: Vec<usize> = Vec::with_capacity(names.len());
    let mut fine = true;
    for (i, name) in names.iter().enumerate() {
        let field = format!("robots[{i}]");
        match robots.iter().position(|r| r.spec.name == *name) {
            Some(index) if driven.contains(&index) => {
                let message = format!("robot `{name}` stands twice in the list");
                let problem = ctx.problem(node, path, &field, Code::Duplicate, message);
                ctx.problems.push(problem);
                fine = false;
            }
            Some(index) => driven.push(index),
            None => {
                let known: Vec<&str> = robots.iter().map(|r| r.spec.name.as_str()).collect();
                let message = format!("no robot is called `{name}`");
                let blank = ctx.problem(node, path, &field, Code::UnknownName, message);
                ctx.problems.push(suggest(blank, name, &known, ""));
                fine = false;
            }
        }
    }
    fine.then_some(driven)
}

fn team_robots(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    team: Team,
    robots: &[Robot],
) -> Option<Vec<usize>> {
    let of_team = |(i, r): (usize, &Robot)| (r.spec.team == team).then_some(i);
    let driven: Vec<usize> = robots.iter().enumerate().filter_map(of_team).collect();
    if driven.is_empty() {
        let problem = ctx
            .problem(
                node,
                path,
                "team",
                Code::UnknownName,
                "no robot is in this team",
            )
            .expected("the team of at least one robot");
        ctx.problems.push(problem);
        return None;
    }
    Some(driven)
}
