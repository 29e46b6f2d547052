//! Resolution of a whole scenario: each part by its own reader, then the relations between the parts.

use std::collections::BTreeMap;

use config::{Code, Diagnostic, FieldPath};
use geometry::map::MapSpec;
use robot::spec::RobotSpec;
use robot::team::Role;
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::IgnoredAny;
use sim_backend::spec::{RulesSpec, WorldSpec};

use super::context::Context;
use super::events::EventBlock;
use super::expect::ExpectSpec;
use super::files::Base;
use super::links;
use super::resolved::ResolvedScenario;
use super::robots::Robot;
use super::spec::{
    Defaults, LinkSpec, LogSpec, MAX_EVENTS, MAX_ROBOTS, MAX_TICKS, ProcessBlock, RobotBlock,
    RunSpec,
};
use super::starts::Placement;
use super::world::WorldBlock;
use super::{events, feasibility, processes, robots, world};

/// The top level of a scenario file.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct TopLevel {
    /// Short name, used for the log's name; default: the file's name.
    pub name: Option<String>,
    /// Title in one line; the name if absent.
    pub title: Option<String>,
    /// Description in some lines.
    pub description: Option<String>,
    /// Time, randomness and pace.
    #[schemars(with = "Option<RunSpec>")]
    pub run: Option<IgnoredAny>,
    /// The map. Required.
    #[schemars(with = "Option<WorldBlock>")]
    pub world: Option<IgnoredAny>,
    /// Capture, exits and end of the run; without them, a world without a game.
    #[schemars(with = "Option<RulesSpec>")]
    pub rules: Option<IgnoredAny>,
    /// Values that all robots share.
    pub defaults: Option<Defaults>,
    /// Values that the robots of a team share, by its name: keys as in `[[robots]]`.
    pub teams: Option<BTreeMap<String, RobotBlock>>,
    /// The robots, 1 to 64.
    #[schemars(with = "Option<Vec<RobotBlock>>", length(min = 1, max = MAX_ROBOTS))]
    pub robots: Option<Vec<IgnoredAny>>,
    /// The processes that drive them: every robot has one.
    #[schemars(with = "Option<Vec<ProcessBlock>>")]
    pub processes: Option<Vec<IgnoredAny>>,
    /// Changes of obstacles, at most 10 000 events.
    #[schemars(with = "Option<Vec<EventBlock>>", length(max = MAX_EVENTS))]
    pub events: Option<Vec<IgnoredAny>>,
    /// Delays and losses of messages.
    #[schemars(with = "Option<Vec<LinkSpec>>")]
    pub links: Option<Vec<IgnoredAny>>,
    /// Contents and format of the log.
    #[schemars(with = "Option<LogSpec>")]
    pub log: Option<IgnoredAny>,
    /// Results that `protean test` expects; a run ignores them.
    pub expect: Option<ExpectSpec>,
}

/// Reads every part, so that all problems are reported, then joins the parts.
///
/// Returns the inputs of drawing the starts beside the scenario.
pub(super) fn resolve(
    ctx: &mut Context<'_>,
    base: &Base,
    stem: &str,
) -> Option<(ResolvedScenario, Vec<Placement>)> {
    let root = ctx.root.clone();
    let top: Option<TopLevel> = ctx.read(&root, &FieldPath::default());
    let run: Option<RunSpec> = ctx.section("run");
    let log: Option<LogSpec> = ctx.section("log");
    let rules: Option<RulesSpec> = ctx.section("rules");
    let map_setup = world::resolve(ctx, base);
    let robots = robots::resolve(ctx);
    let map = map_setup.as_ref().map(|g| &g.map);
    let defaults = RunSpec::default();
    let read = run.as_ref().unwrap_or(&defaults);
    let events = events::resolve(ctx, map, robots.as_deref());
    let processes = processes::resolve(
        ctx,
        base,
        robots.as_deref(),
        map,
        rules.as_ref(),
        &events,
        read,
    );
    let links = links::resolve(ctx, &processes);
    let (top, run, log, rules) = (top?, run?, log?, rules?);
    let (map_setup, robots) = (map_setup?, robots?);
    if !ctx.problems.is_empty() {
        return None;
    }
    check_ticks(ctx, &run, &rules);
    let specs: Vec<RobotSpec> = robots.iter().map(|r| r.spec.clone()).collect();
    let placements: Vec<Placement> = robots
        .iter()
        .zip(RobotSpec::teams(&specs))
        .map(|(r, team)| Placement::new(&r.spec, team, r.draw))
        .collect();
    let starts = feasibility::resolve(ctx, &map_setup, &robots, &placements, &rules, run.seed)?;
    check_end(ctx, &map_setup.map, &robots, &rules);
    let specs = robots.into_iter().zip(starts).map(|(r, start)| {
        let mut spec = r.spec;
        spec.start = start;
        spec
    });
    let scenario = ResolvedScenario {
        name: top.name.unwrap_or_else(|| stem.to_owned()),
        title: top.title.unwrap_or_default(),
        description: top.description.unwrap_or_default().trim().to_owned(),
        world: WorldSpec {
            map: map_setup.map,
            robots: specs.collect(),
            rules,
            seed: run.seed,
        },
        run,
        blur_sigma: map_setup.blur_sigma,
        map_remark: map_setup.remark,
        processes,
        events,
        links,
        log,
    };
    Some((scenario, placements))
}

/// Checks the time limit of the run, in ticks.
fn check_ticks(ctx: &mut Context<'_>, run: &RunSpec, rules: &RulesSpec) {
    let Some(limit) = rules.time_limit.filter(|limit| *limit / run.dt > MAX_TICKS) else {
        return;
    };
    let path = FieldPath::key("rules").then("time_limit");
    ctx.problems.push(
        Diagnostic::new(Code::Limit, "the run would have too many ticks")
            .at(ctx.sources.place(ctx.root.origin_along(&path)))
            .field(&path)
            .value(format!(
                "{limit} (s) in ticks of run.dt = {} (s): {:e} ticks",
                run.dt,
                limit / run.dt
            ))
            .expected(format!("at most {MAX_TICKS:e} ticks")),
    );
}

/// Checks that some condition can end the run.
fn check_end(ctx: &mut Context<'_>, map: &MapSpec, robots: &[Robot], rules: &RulesSpec) {
    let map_exits = match map {
        MapSpec::Vector(map) => !map.exits.is_empty(),
        MapSpec::Cells(map) => !map.exits.is_empty(),
        MapSpec::File { .. } => false,
    };
    let game = rules.capture.is_some() || !rules.exits.is_empty() || map_exits;
    let evaders = robots.iter().any(|r| r.spec.role() == Role::Evader);
    let goals = robots.iter().any(|r| r.spec.goal.is_some());
    if rules.time_limit.is_some() || goals || game && evaders {
        return;
    }
    let path = FieldPath::key("rules").then("time_limit");
    ctx.problems.push(
        Diagnostic::new(Code::Requirement, "this run has no end condition")
            .at(ctx.sources.place(ctx.root.origin_along(&path)))
            .field(&path)
            .expected("a time limit, a robot with a goal, or evaders that can escape or be caught")
            .help("set rules.time_limit = 60.0 (s)"),
    );
}
