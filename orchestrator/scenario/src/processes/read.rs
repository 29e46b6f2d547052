//! Reading one `[[processes]]` block.

use config::{Code, FieldPath, Node, Origin, Step, describe, suggest};
use runtime::declaration::Flow;

use super::files;
use crate::context::Context;
use crate::failure;
use crate::files::Base;
use crate::kind::{ConfiguredKind, Kind, ParamsProblem, find};
use crate::resolved::{ASK, ProcessSpec, Program, ProgramDeclaration};
use crate::robots::{Robot, check_name};
use crate::spec::{Grouping, MAX_PERIOD, ProcessBlock, RunSpec};
use runtime::declaration::WrittenDeclaration;

/// Kind that a program may be built without.
const OPTIONAL: &str = "ros2_bridge";

/// A process as read, with its place for error messages.
pub struct ProcessEntry {
    /// The process.
    pub spec: ProcessSpec,
    /// Position of its block in the text.
    pub origin: Origin,
    /// The path of its block.
    pub path: FieldPath,
}

/// Reads the processes of a block, one or one for each robot, and reports all problems.
pub fn block(
    ctx: &mut Context<'_>,
    base: &Base,
    node: &Node,
    path: &FieldPath,
    robots: Option<&[Robot]>,
    run: &RunSpec,
    read: &mut Vec<ProcessEntry>,
) {
    let Some(block) = ctx.read::<ProcessBlock>(node, path) else {
        return;
    };
    let Some(named) = read_program(ctx, node, path, &block) else {
        return;
    };
    let fallback = block.kind.clone().unwrap_or_default();
    let name = block.name.clone().unwrap_or(fallback);
    if !check_name(ctx, node, path, "name", &name) {
        return;
    }
    let program = match named {
        BlockProgram::Kind(kind) => {
            let Some(configured) = read_params(ctx, base, node, path, kind) else {
                return;
            };
            Program::Kind(configured)
        }
        BlockProgram::Command(words) => {
            // The external program interprets its parameters.
            let Some(params) = params_of(ctx, node, path) else {
                return;
            };
            let Some(params) = ctx.read(&params, &path.then("params")) else {
                return;
            };
            let folder = match base.absolute(block.folder.as_deref().unwrap_or_default()) {
                Ok(folder) => folder,
                Err(refused) => {
                    let problem = ctx.problem(node, path, "folder", Code::File, refused.message);
                    ctx.problems.push(problem.expected(refused.expected));
                    return;
                }
            };
            let Some(declared) = read_declaration(ctx, node, path) else {
                return;
            };
            Program::Command {
                words,
                folder,
                params,
                declared,
            }
        }
    };
    let Some(driven) = read_robots(ctx, node, path, &block, program.kind(), robots) else {
        return;
    };
    if !driven.is_empty() && node.get("declaration").is_some() {
        let message = "a program with a `declaration` drives no robots";
        ctx.problems.push(
            ctx.problem(node, path, "declaration", Code::Requirement, message)
                .expected(
                    "no `declaration` of a program with robots; the run reads its inputs from it",
                ),
        );
        return;
    }
    let Some(supervision) = failure::read(ctx, node, path, &block, run) else {
        return;
    };
    let Some(period) = read_period(ctx, node, path, block.period, &program) else {
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
            period,
        };
        read.push(ProcessEntry {
            spec,
            origin: node.origin,
            path: path.clone(),
        });
    }
}

/// Returns the period of a process. One that answers requests has no steps.
fn read_period(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    period: Option<u64>,
    program: &Program,
) -> Option<u64> {
    let period = period.unwrap_or(1);
    let answers = |kind: &ConfiguredKind| {
        let outputs = kind.declaration().outputs;
        let mut flows = outputs.iter().map(|output| output.flow);
        flows.any(|flow| matches!(flow, Flow::Answers(_)))
    };
    let (message, expected) = if !(1..=MAX_PERIOD).contains(&period) {
        let expected = format!("a number from 1 to {MAX_PERIOD} (ticks)");
        ("`period` is out of range", expected)
    } else if period > 1 && program.kind().is_some_and(answers) {
        let message = "a process that answers requests does so on their arrival";
        (message, "no `period`".to_owned())
    } else {
        return Some(period);
    };
    ctx.problems.push(
        ctx.problem(node, path, "period", Code::OutOfRange, message)
            .expected(expected),
    );
    None
}

/// Reads the declaration of an external program; `None` after a problem.
fn read_declaration(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
) -> Option<ProgramDeclaration> {
    let Some(declaration) = node.get("declaration") else {
        return Some(ProgramDeclaration::Nothing);
    };
    let problem = match declaration.as_str() {
        Some(ASK) => return Some(ProgramDeclaration::OnRequest),
        Some(_) => ctx
            .problem(
                node,
                path,
                "declaration",
                Code::OutOfRange,
                "no declaration",
            )
            .expected("\"ask\", or a table with `reads` and `writes`"),
        None => {
            let path = path.then("declaration");
            let written: WrittenDeclaration = ctx.read(declaration, &path)?;
            match written.declaration() {
                Ok(known) => return Some(ProgramDeclaration::Written(Box::new((written, known)))),
                Err(fault) => {
                    let message = fault.to_string();
                    ctx.problem(declaration, &path, "", Code::Requirement, message)
                }
            }
        }
    };
    ctx.problems.push(problem);
    None
}

/// Program that a block names.
enum BlockProgram<'k> {
    Kind(&'k Kind),
    Command(Vec<String>),
}

fn read_program<'k>(
    ctx: &mut Context<'k>,
    node: &Node,
    path: &FieldPath,
    block: &ProcessBlock,
) -> Option<BlockProgram<'k>> {
    let problem = match (&block.kind, &block.command) {
        (Some(_), None) if block.folder.is_some() => ctx
            .problem(
                node,
                path,
                "folder",
                Code::Requirement,
                "`folder` without `command`",
            )
            .expected("no `folder`: it is the working directory of an external program"),
        (Some(kind), None) => {
            if let Some(kind) = find(ctx.kinds, kind) {
                return Some(BlockProgram::Kind(kind));
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
                if kind == OPTIONAL {
                    blank.help(
                        "this program is built without it; the Python wheel has it, and a program built with --features ros2",
                    )
                } else {
                    suggest(blank, kind, &names, "")
                }
            }
        }
        (None, Some(command)) => match command.first() {
            Some(program) if !program.is_empty() && command.iter().all(|a| !a.contains('\0')) => {
                return Some(BlockProgram::Command(command.clone()));
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
            .expected(
                "one of them: `kind` for a built-in process, `command` for an external program",
            ),
        (None, None) => ctx
            .block_problem(
                node.origin,
                path,
                Code::MissingKey,
                "a process without `kind`",
            )
            .expected(
                "kind = \"…\" for a built-in process, or command = [\"…\"] for an external program",
            ),
    };
    ctx.problems.push(problem);
    None
}

/// Returns the table of parameters of a block; an absent table is empty.
fn params_of(ctx: &mut Context<'_>, node: &Node, path: &FieldPath) -> Option<Node> {
    let path = path.then("params");
    let empty = Node::empty_table(node.origin);
    let params = node.get("params").unwrap_or(&empty);
    if params.as_table().is_none() {
        let message = format!("wrong type: {}", params.type_name());
        ctx.problems.push(
            ctx.problem(params, &path, "", Code::WrongType, message)
                .expected("a table"),
        );
        return None;
    }
    Some(params.clone())
}

fn read_params(
    ctx: &mut Context<'_>,
    base: &Base,
    node: &Node,
    path: &FieldPath,
    kind: &Kind,
) -> Option<ConfiguredKind> {
    let params = params_of(ctx, node, path)?;
    let path = path.then("params");
    let params = apply_preset(ctx, &params, &path, kind)?;
    let params = &files::insert(ctx, base, params, &path, kind)?;
    match kind.read(params) {
        Ok(configured) => return Some(configured),
        Err(ParamsProblem::Read(_)) => {
            // Every fault is found by leaving out the faulty key and reading again.
            let mut left = params.clone();
            report_all(ctx, kind, &mut left, &path);
        }
        Err(ParamsProblem::Faults(faults)) => {
            for fault in faults {
                ctx.refuse(params, &path, fault);
            }
        }
        Err(ParamsProblem::Write(message)) => {
            ctx.problems
                .push(ctx.problem(params, &path, "", Code::OutOfRange, message));
        }
    }
    None
}

/// Returns the parameters with `preset = "…"` replaced by its values; other keys take precedence.
fn apply_preset(
    ctx: &mut Context<'_>,
    params: &Node,
    path: &FieldPath,
    kind: &Kind,
) -> Option<Node> {
    let Some(preset) = params.get("preset") else {
        return Some(params.clone());
    };
    let name = preset.as_str().unwrap_or_default();
    let presets = kind.presets();
    let Some((_, values)) = presets.iter().find(|p| p.0 == name) else {
        let names: Vec<&str> = presets.iter().map(|p| p.0).collect();
        let message = format!("kind `{}` has no such preset", kind.name);
        let blank = ctx.problem(params, path, "preset", Code::UnknownName, message);
        ctx.problems.push(suggest(blank, name, &names, ""));
        return None;
    };
    let mut merged = Node::from_json(&values.json()).unwrap_or(Node::empty_table(Origin::Implied));
    merged.origin = params.origin;
    if let (Some(table), Some(own)) = (merged.as_table_mut(), params.as_table()) {
        table.overlay(own);
        table.remove("preset");
    }
    Some(merged)
}

/// Reports every key of `params` that the kind cannot read.
fn report_all(ctx: &mut Context<'_>, kind: &Kind, left: &mut Node, path: &FieldPath) {
    while let Err(ParamsProblem::Read(error)) = kind.read(left) {
        ctx.problems.push(describe(&ctx.sources, &error, path));
        let Some(Step::Key(key)) = error.path.0.first() else {
            return;
        };
        if left.as_table_mut().and_then(|t| t.remove(key)).is_none() {
            return;
        }
    }
}

/// Returns the indices of the robots that a block drives.
fn read_robots(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    block: &ProcessBlock,
    kind: Option<&ConfiguredKind>,
    robots: Option<&[Robot]>,
) -> Option<Vec<usize>> {
    let named = block.robots.as_deref();
    if named.is_some() && block.team.is_some() {
        ctx.problems.push(
            ctx.problem(
                node,
                path,
                "team",
                Code::Requirement,
                "both `robots` and `team`",
            )
            .expected("one of them"),
        );
        return None;
    }
    let drives = kind.is_none_or(|kind| kind.declaration().drives_robots());
    let gives = if named.is_some() { "robots" } else { "team" };
    if !drives {
        if named.is_some() || block.team.is_some() {
            let kind = kind.map_or("", |kind| kind.kind().name);
            let message = format!("a process of kind `{kind}` drives no robots");
            ctx.problems.push(
                ctx.problem(node, path, gives, Code::Requirement, message)
                    .expected(format!("no `{gives}`")),
            );
            return None;
        }
        return Some(Vec::new());
    }
    let Some(robots) = robots else {
        return Some(Vec::new());
    };
    let mut driven = match (named, &block.team) {
        (Some(names), _) => named_robots(ctx, node, path, names, robots)?,
        (None, Some(team)) => team_robots(ctx, node, path, team, robots)?,
        (None, None) => Vec::new(),
    };
    if driven.is_empty() && kind.is_some() {
        ctx.problems.push(
            ctx.block_problem(
                node.origin,
                path,
                Code::Requirement,
                "this process drives no robot",
            )
            .expected("robots = [\"…\"] or team = \"…\""),
        );
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
                let message = format!("robot `{name}` occurs twice in the list");
                ctx.problems
                    .push(ctx.problem(node, path, &field, Code::Duplicate, message));
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
    team: &str,
    robots: &[Robot],
) -> Option<Vec<usize>> {
    let of_team = |(i, r): (usize, &Robot)| (r.spec.team == team).then_some(i);
    let driven: Vec<usize> = robots.iter().enumerate().filter_map(of_team).collect();
    if driven.is_empty() {
        let mut teams: Vec<&str> = robots.iter().map(|r| r.spec.team.as_str()).collect();
        teams.sort_unstable();
        teams.dedup();
        let message = format!("no robot is in team `{team}`");
        let blank = ctx.problem(node, path, "team", Code::UnknownName, message);
        ctx.problems.push(suggest(blank, team, &teams, ""));
        return None;
    }
    Some(driven)
}
