//! What a scenario may ask for in sum: with each part within its own limit, all of them together may
//! still be more than a machine has.

use serde_json::Value as Json;
use sim_backend::map::MapSpec;
use sim_backend::team::Team;

use super::context::Context;
use super::processes::Read;
use super::resolved::{ProcessSpec, Program};
use super::robots::Robot;
use super::spec::{MAX_SUM_BEAMS, MAX_SUM_CELLS, MAX_SUM_ITERATIONS, MAX_SUM_PARTICLES};
use super::text::{Code, FieldPath, Origin};

/// Refuses what is too much in sum, at the part with which it becomes too much.
pub(super) fn check(ctx: &mut Context<'_>, robots: &[Robot], map: &MapSpec, read: &[Read]) {
    let beams = robots.iter().map(|robot| {
        let beams = robot.spec.scan.as_ref().map_or(0, |scan| scan.beams as u64);
        (
            robot.node.origin,
            robot.path.join(&FieldPath::parse("scan.beams")),
            beams,
        )
    });
    let of_processes = |field: &'static str, share: fn(&ProcessSpec, &[Robot]) -> u64| {
        read.iter().map(move |r| {
            (
                r.origin,
                r.path.join(&FieldPath::parse(field)),
                share(&r.spec, robots),
            )
        })
    };
    let cells = cells(map);
    // The simulator has the map too.
    let maps = (0..=read.len()).map(|_| (ctx.root.origin, FieldPath::key("processes"), cells));
    for (parts, what, most) in [
        (sum(beams), "beams of all scans", MAX_SUM_BEAMS),
        (
            sum(of_processes("params.filter", particles)),
            "particles of all filters, of which there is one per robot watched",
            MAX_SUM_PARTICLES,
        ),
        (
            sum(of_processes("params.search", iterations)),
            "iterations of all plans, one per robot",
            MAX_SUM_ITERATIONS,
        ),
        (
            sum(maps),
            "cells of all maps, of which every process has one",
            MAX_SUM_CELLS,
        ),
    ] {
        if let Some((origin, path)) = parts.beyond(most) {
            let problem = ctx
                .block_problem(origin, &path, Code::Limit, "too much in sum")
                .value(format!("{} {what}", parts.total))
                .expected(format!("at most {most}"));
            ctx.problems.push(problem);
        }
    }
}

/// What is asked for, part by part.
struct Parts {
    total: u64,
    /// Where each stands, and the sum up to it.
    parts: Vec<(Origin, FieldPath, u64)>,
}

fn sum(parts: impl Iterator<Item = (Origin, FieldPath, u64)>) -> Parts {
    let mut total = 0_u64;
    let parts = parts
        .map(|(origin, path, part)| {
            total = total.saturating_add(part);
            (origin, path, total)
        })
        .collect();
    Parts { total, parts }
}

impl Parts {
    /// The first part that goes beyond what all may be.
    fn beyond(&self, most: u64) -> Option<(Origin, FieldPath)> {
        let mut parts = self.parts.iter();
        let (origin, path, _) = parts.find(|(_, _, so_far)| *so_far > most)?;
        Some((*origin, path.clone()))
    }
}

/// Cells of the grid of one map.
fn cells(map: &MapSpec) -> u64 {
    match map {
        MapSpec::Vector(map) => map.frame().map_or(0, |frame| frame.len() as u64),
        MapSpec::Cells(map) => map.frame().len() as u64,
        MapSpec::File { .. } => 0,
    }
}

fn number(params: &Json, pointer: &str) -> u64 {
    params.pointer(pointer).and_then(Json::as_u64).unwrap_or(0)
}

fn is(process: &ProcessSpec, kind: &str) -> bool {
    matches!(&process.program, Program::Kind(name) if name == kind)
}

/// Most particles that a process may have.
fn particles(process: &ProcessSpec, robots: &[Robot]) -> u64 {
    let params = &process.params;
    let listed = |field: &str| {
        params
            .get(field)
            .and_then(Json::as_array)
            .map_or(0, Vec::len)
    };
    let filters = if is(process, "perception") {
        let evaders = robots.iter().filter(|r| r.spec.team == Team::Evader);
        evaders.count()
    } else if is(process, "observer") {
        let methods = params.get("methods").and_then(Json::as_array);
        let by_particles = methods.is_some_and(|all| all.iter().any(|m| m == "particles"));
        match listed("watch") {
            _ if !by_particles => 0,
            0 => robots.len() - listed("from_robots").min(robots.len()),
            named => named,
        }
    } else {
        0
    };
    let each = number(params, "/filter/particles").max(number(params, "/filter/adaptive/most"));
    each.saturating_mul(filters as u64)
}

/// Most nodes that the search trees of a process may have.
fn iterations(process: &ProcessSpec, _: &[Robot]) -> u64 {
    if !is(process, "evader_rrt_star") {
        return 0;
    }
    let params = &process.params;
    let each = number(params, "/search/iterations");
    each.saturating_mul(process.robots.len() as u64)
}
