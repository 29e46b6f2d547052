//! From a path or a name to a [`ResolvedScenario`].

use std::path::{Path, PathBuf};

use config::{
    Code, Diagnostic, Diagnostics, FieldPath, Node, SourceKind, Sources, list_choices, nearest,
    parse_document,
};
use sim_backend::map::MapSpec;
use sim_backend::spec::{RulesSpec, WorldSpec};

use super::context::Context;
use super::draft::Draft;
use super::files::{Base, read_text};
use super::jitter::Placement;
use super::kind::Kind;
use super::resolved::ResolvedScenario;
use super::spec::{LogSpec, MAX_TICKS, RunSpec, TopLevel};
use super::{builtin, events, geometry, processes, robots, world};

/// Largest scenario file that is read (bytes); one with its map written out is far smaller.
const MAX_SCENARIO: u64 = 64 << 20;

/// Loads scenarios.
#[derive(Clone, Copy)]
pub struct Loader<'k> {
    kinds: &'k [Kind],
    allow_outside: bool,
}

impl<'k> Loader<'k> {
    /// A loader that knows these kinds of processes.
    pub fn new(kinds: &'k [Kind]) -> Self {
        Self {
            kinds,
            allow_outside: false,
        }
    }

    /// Whether the scenario's files may lie outside its folder.
    #[must_use]
    pub fn allow_outside(self, allow_outside: bool) -> Self {
        Self {
            allow_outside,
            ..self
        }
    }

    /// Loads a scenario.
    ///
    /// `target` is the path of a TOML file or the name of a built-in scenario, `overrides` are
    /// `key=value` arguments, applied in order, and `seed` is applied last.
    ///
    /// # Errors
    /// Everything that is wrong with it, each with its place.
    pub fn load(
        &self,
        target: &str,
        overrides: &[String],
        seed: Option<u64>,
    ) -> Result<ResolvedScenario, Diagnostics> {
        let mut draft = self.draft(target)?;
        draft.apply_all(overrides, seed);
        draft.resolve()
    }

    /// Reads a scenario without resolving it yet: what several runs with different overrides and
    /// seeds have in common.
    ///
    /// # Errors
    /// It cannot be read, or is not TOML.
    pub fn draft(&self, target: &str) -> Result<Draft<'k>, Diagnostics> {
        let path = Path::new(target);
        let is_bare_name = !target.contains(['/', '.']);
        let built_in = builtin::scenario(target);
        if let Some(scenario) = built_in.filter(|_| is_bare_name || !path.exists()) {
            let file = format!("{}.toml", scenario.name);
            return self.draft_text(&file, scenario.text, &Base::Builtin);
        }
        let text = match read_text(path, MAX_SCENARIO) {
            Ok(text) => text,
            Err(refused) => {
                let names = builtin::SCENARIOS.map(|s| s.name);
                let stem = path
                    .file_stem()
                    .and_then(|s| s.to_str())
                    .unwrap_or_default();
                let mut problem = Diagnostic::new(Code::File, refused.message)
                    .value(target)
                    .expected(format!(
                        "the path of a scenario, or the name of a built-in one: {}",
                        list_choices(&names)
                    ));
                if let Some(near) = nearest(stem, names) {
                    problem = problem.help(format!("did you mean `{near}`?"));
                }
                return Err(problem.into());
            }
        };
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
            _ => PathBuf::from("."),
        };
        let base = Base::Folder {
            folder,
            allow_outside: self.allow_outside,
        };
        self.draft_text(target, &text, &base)
    }

    /// Loads the text of a scenario; `file` is what errors call it, and paths in it lead where
    /// `base` says ([`Base::Nothing`] for one that comes from a log).
    ///
    /// # Errors
    /// As [`Loader::load`].
    pub fn load_text(
        &self,
        file: &str,
        text: &str,
        base: &Base,
        overrides: &[String],
        seed: Option<u64>,
    ) -> Result<ResolvedScenario, Diagnostics> {
        let mut draft = self.draft_text(file, text, base)?;
        draft.apply_all(overrides, seed);
        draft.resolve()
    }

    fn draft_text(&self, file: &str, text: &str, base: &Base) -> Result<Draft<'k>, Diagnostics> {
        let mut sources = Sources::default();
        let mut problems = Diagnostics::default();
        let source = sources.add(SourceKind::File, file, text);
        let Some(root) = parse_document(&sources, source, &mut problems) else {
            problems.push_if_empty(|| Diagnostic::new(Code::Syntax, "not a scenario"));
            return Err(problems.sorted());
        };
        let stem = Path::new(file)
            .file_stem()
            .and_then(|s| s.to_str())
            .unwrap_or("scenario");
        Ok(Draft {
            sources,
            root,
            problems,
            kinds: self.kinds,
            base: base.clone(),
            stem: stem.to_owned(),
        })
    }
}

/// Reads every part, so that all problems show, then puts the parts together.
///
/// Beside the scenario stands what its drawn starts follow from.
pub(super) fn resolve(
    ctx: &mut Context<'_>,
    base: &Base,
    stem: &str,
) -> Option<(ResolvedScenario, Vec<Placement>)> {
    let root = ctx.root.clone();
    let top: Option<TopLevel> = ctx.read(&root, &FieldPath::default());
    let run = read_run(ctx);
    let log = read_log(ctx);
    let rules: Option<RulesSpec> = ctx.section("rules");
    if let Some(rules) = &rules
        && let Err(e) = rules.validate()
    {
        let path = FieldPath::key("rules");
        let node = ctx.root.follow(&path).clone();
        ctx.refuse(&node, &path, e);
    }
    let ground = world::resolve(ctx, base);
    let robots = robots::resolve(ctx);
    let map = ground.as_ref().map(|g| &g.map);
    let defaults = RunSpec::default();
    let read = run.as_ref().unwrap_or(&defaults);
    let processes = processes::resolve(ctx, robots.as_deref(), map, read);
    let events = events::resolve(ctx, ground.as_ref().map(|g| &g.map), robots.as_deref());
    let (top, run, log, rules) = (top?, run?, log?, rules?);
    let (ground, robots) = (ground?, robots?);
    if !ctx.problems.is_empty() {
        return None;
    }
    check_ticks(ctx, &run, &rules);
    let placements = geometry::placements(&robots);
    let starts = geometry::resolve(ctx, &ground.map, &robots, &rules, run.seed)?;
    check_end(ctx, &ground.map, &robots, &rules);
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
            map: ground.map,
            robots: specs.collect(),
            rules,
            seed: run.seed,
        },
        run,
        blur_sigma: ground.blur_sigma,
        processes,
        events,
        log,
    };
    Some((scenario, placements))
}

fn read_run(ctx: &mut Context<'_>) -> Option<RunSpec> {
    let run: RunSpec = ctx.section("run")?;
    ctx.check_range("run.dt", run.dt, 1e-4, 1.0, "s");
    ctx.check_range("run.real_time_factor", run.real_time_factor, 1e-3, 1e3, "");
    for (field, value) in [
        ("run.hang_timeout_s", run.hang_timeout_s),
        ("run.ready_timeout_s", run.ready_timeout_s),
    ] {
        ctx.check_range(field, value, 0.1, 3600.0, "s");
    }
    ctx.check_range(
        "run.command_deadline_s",
        run.command_deadline_s,
        1e-3,
        60.0,
        "s",
    );
    Some(run)
}

fn read_log(ctx: &mut Context<'_>) -> Option<LogSpec> {
    let log: LogSpec = ctx.section("log")?;
    ctx.check_range("log.viewer_rate_hz", log.viewer_rate_hz, 0.0, 1e3, "Hz");
    Some(log)
}

/// The time limit must come within a lifetime, and the log of it fit on a disk.
fn check_ticks(ctx: &mut Context<'_>, run: &RunSpec, rules: &RulesSpec) {
    let Some(limit) = rules.time_limit.filter(|limit| *limit / run.dt > MAX_TICKS) else {
        return;
    };
    let path = FieldPath::key("rules").then("time_limit");
    let problem = Diagnostic::new(Code::Limit, "the run would have too many ticks")
        .at(ctx.sources.place(ctx.root.origin_along(&path)))
        .field(&path)
        .value(format!(
            "{limit} [s] in ticks of run.dt = {} [s]: {:e} ticks",
            run.dt,
            limit / run.dt
        ))
        .expected(format!("at most {MAX_TICKS:e} ticks"));
    ctx.problems.push(problem);
}

/// Something must be able to end the run.
fn check_end(ctx: &mut Context<'_>, map: &MapSpec, robots: &[robots::Robot], rules: &RulesSpec) {
    let map_exits = match map {
        MapSpec::Vector(map) => !map.exits.is_empty(),
        MapSpec::Cells(map) => !map.exits.is_empty(),
        MapSpec::File { .. } => false,
    };
    let game = rules.capture.is_some() || !rules.exits.is_empty() || map_exits;
    let evaders = robots
        .iter()
        .any(|r| r.spec.team == sim_backend::team::Team::Evader);
    let goals = robots.iter().any(|r| r.spec.goal.is_some());
    if rules.time_limit.is_some() || goals || game && evaders {
        return;
    }
    let path = FieldPath::key("rules").then("time_limit");
    let problem = Diagnostic::new(Code::Requirement, "nothing ever ends this run")
        .at(ctx.sources.place(ctx.root.origin_along(&path)))
        .field(&path)
        .expected("a time limit, a robot with a goal, or evaders that can escape or be caught")
        .help("set rules.time_limit = 60.0 [s]");
    ctx.problems.push(problem);
}

/// A built-in scenario as `protean list` shows it.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Listed {
    /// What `protean run` takes.
    pub name: String,
    /// Its title.
    pub title: String,
    /// First line of its description.
    pub summary: String,
}

/// The built-in scenarios, the default first.
pub fn list() -> Vec<Listed> {
    builtin::SCENARIOS
        .iter()
        .map(|s| {
            let mut sources = Sources::default();
            let source = sources.add(SourceKind::File, s.name, s.text);
            let root = parse_document(&sources, source, &mut Diagnostics::default());
            let text = |key: &str| {
                let node = root.as_ref().and_then(|r| r.get(key));
                node.and_then(Node::as_str)
                    .unwrap_or_default()
                    .trim()
                    .to_owned()
            };
            Listed {
                name: s.name.to_owned(),
                title: text("title"),
                summary: text("description")
                    .lines()
                    .next()
                    .unwrap_or_default()
                    .to_owned(),
            }
        })
        .collect()
}
