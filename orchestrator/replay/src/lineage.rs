//! Branches of a run: the changes that its log names, and the run with them.

use std::collections::BTreeMap;
use std::path::Path;

use config::{Node, Origin as TextOrigin};
use geometry::pose::Twist2;
use mcap_log::{LogReadError, Origin};
use mission::MissionError;
use mission::in_process::{Branch, GivenCommand, GivenPlace};
use mission::plan::Plan;
use rand::{Rng as _, RngExt as _};
use runtime::declaration::Flow;
use scenario::files::Base;
use scenario::kind::{Kind, find};
use scenario::{Loader, Program, ResolvedScenario};
use serde::{Deserialize, Serialize};

use crate::ReplayError;
use crate::origin::{changes_nothing, for_log};

/// Name that stands for all processes.
pub const ALL: &str = "all";

/// Change of a run from a moment on, as on the command line.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Change {
    /// Overrides of the scenario in the log, in the form of `--set`; `teams.TEAM.limits.…` stands for all its robots, `processes.KIND.…`
    /// for all its processes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    /// Values of the scenario that are drawn: `KEY=LOW..HIGH`, uniformly, by the number of the random streams. Whole numbers if
    /// both bounds are written as such.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub draw: Vec<String>,
    /// Processes with other kinds: `PROCESS=KIND`, with the default parameters of the kind.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub replace: Vec<String>,
    /// Commands in place of those of the planners: `ROBOT=V,OMEGA` (m/s, rad/s).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub command: Vec<String>,
    /// Time for which the commands count (s), > 0; `None`: to the end.
    #[serde(rename = "for", skip_serializing_if = "Option::is_none")]
    pub for_s: Option<f64>,
    /// Poses to which robots are moved: `ROBOT=X,Y[,HEADING]` (m, rad); their velocities stay.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub place: Vec<String>,
    /// Names of the processes with other random streams, or [`ALL`].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub reseed: Vec<String>,
    /// Number of these streams.
    pub seed: u64,
}

/// A branch that a log names: its run follows the parent up to the tick.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BranchPoint {
    /// Name of the parent's file.
    pub parent: String,
    /// Digest of the parent; absent if its run did not reach its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digest: Option<String>,
    /// First tick with the change.
    pub tick: u64,
    /// Its simulated time (s).
    pub at_s: f64,
    /// The change.
    pub change: Change,
    /// Processes that fail in the run of the parent, with the first tick without each.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub failures: BTreeMap<String, u64>,
}

/// Returns the branches that a log names, oldest first; none for a run without.
///
/// # Errors
/// [`LogReadError`]: they are of another version, or robots of the run follow a recording, which the log does not contain.
pub fn branch_points(origin: &Origin, log: &Path) -> Result<Vec<BranchPoint>, LogReadError> {
    if let Some(bag) = origin.manifest.get(Origin::IMPORTED) {
        return Err(LogReadError::NotRepeatable {
            path: log.to_owned(),
            reason: format!(
                "its robots follow the recording {bag}, which a log does not contain: `protean import` runs it again, \
                 `protean replay --test` tests its processes"
            ),
        });
    }
    let Some(text) = origin.manifest.get(Origin::BRANCHES) else {
        return Ok(Vec::new());
    };
    serde_json::from_str(text).map_err(|source| LogReadError::NotRepeatable {
        path: log.to_owned(),
        reason: format!("its branches cannot be read: {source}"),
    })
}

/// Returns the changes of a run at these points, for its execution in one thread.
///
/// # Errors
/// [`ReplayError`] names the option and its value, or the part of the scenario that no branch can change.
pub fn branches(
    points: &[BranchPoint],
    scenario: &ResolvedScenario,
    kinds: &[Kind],
) -> Result<Vec<Branch>, ReplayError> {
    let mut now = scenario.clone();
    let mut branches = Vec::new();
    for point in points {
        let change = &point.change;
        now = changed(now, change, kinds)?;
        let refused = |option: &str, expected: &str| {
            let robots: Vec<_> = now.world.robots.iter().map(|robot| &*robot.name).collect();
            let robots = robots.join(", ");
            argument(format!(
                "{option}: expected {expected} with ROBOT one of {robots}"
            ))
        };
        let commands = change.command.iter().map(|text| {
            given_command(text, change.for_s, &now)
                .ok_or_else(|| refused(&format!("--command {text}"), "ROBOT=V,OMEGA (m/s, rad/s)"))
        });
        let places = change.place.iter().map(|text| {
            given_place(text, &now)
                .ok_or_else(|| refused(&format!("--place {text}"), "ROBOT=X,Y[,HEADING] (m, rad)"))
        });
        branches.push(Branch {
            tick: point.tick,
            commands: commands.collect::<Result<_, _>>()?,
            places: places.collect::<Result<_, _>>()?,
            seeds: seeds(change, &now)?,
            scenario: now.clone(),
        });
    }
    Ok(branches)
}

fn argument(text: String) -> LogReadError {
    LogReadError::Argument(text)
}

fn given_command(text: &str, for_s: Option<f64>, now: &ResolvedScenario) -> Option<GivenCommand> {
    let (robot, command) = text.split_once('=')?;
    let (v, omega) = command.split_once(',')?;
    let twist = Twist2::new(v.trim().parse().ok()?, omega.trim().parse().ok()?);
    let ticks = for_s.map_or(u64::MAX, |for_s| (for_s / now.run.dt).round() as u64);
    let robot = now.world.robots.iter().position(|own| own.name == robot)?;
    twist.is_command().then_some(GivenCommand {
        robot,
        twist,
        ticks,
    })
}

fn given_place(text: &str, now: &ResolvedScenario) -> Option<GivenPlace> {
    let (robot, place) = text.split_once('=')?;
    let numbers = place.split(',').map(|number| number.trim().parse());
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().ok()?;
    let (position, heading) = match numbers[..] {
        [x, y] => ([x, y], None),
        [x, y, heading] => ([x, y], Some(heading)),
        _ => return None,
    };
    let robot = now.world.robots.iter().position(|own| own.name == robot)?;
    numbers
        .iter()
        .all(|number| number.is_finite())
        .then_some(GivenPlace {
            robot,
            position,
            heading,
        })
}

/// Returns the seeds of the processes with other random streams. A process whose links lose messages keeps its own, from
/// which the losses follow, and so does one that answers requests.
fn seeds(change: &Change, now: &ResolvedScenario) -> Result<BTreeMap<String, u64>, ReplayError> {
    let plan = Plan::new(now, "warn").map_err(MissionError::from)?;
    let launches = plan.launches.iter().filter(|launch| {
        let mut outputs = launch.declaration.iter().flat_map(|d| &d.outputs);
        launch.config.links.iter().all(|link| link.loss <= 0.0)
            && !outputs.any(|output| matches!(output.flow, Flow::Answers(_)))
    });
    let names: Vec<&str> = launches.map(|launch| &*launch.config.name).collect();
    let mut reseeded = Vec::new();
    for wanted in &change.reseed {
        if wanted == ALL {
            reseeded.extend(names.iter().copied());
        } else if names.contains(&wanted.as_str()) {
            reseeded.push(wanted);
        } else {
            return Err(argument(format!(
                "--reseed {wanted}: expected {ALL} or a process without losses on its links that answers no requests, \
                 one of {}",
                names.join(", ")
            ))
            .into());
        }
    }
    let purpose = format!("branch {}", change.seed);
    let seed = |name: &str| runtime::seed::stream(now.run.seed, name, "", &purpose).next_u64();
    let seeds = reseeded
        .into_iter()
        .map(|name| (name.to_owned(), seed(name)));
    Ok(seeds.collect())
}

/// Returns the scenario with the overrides and kinds of a change.
fn changed(
    now: ResolvedScenario,
    change: &Change,
    kinds: &[Kind],
) -> Result<ResolvedScenario, LogReadError> {
    let drawn = change.draw.iter().map(|text| {
        drawn(text, now.run.seed, change.seed).ok_or_else(|| {
            argument(format!(
                "--draw {text}: expected KEY=LOW..HIGH with finite numbers, LOW < HIGH"
            ))
        })
    });
    let drawn: Vec<String> = drawn.collect::<Result<_, _>>()?;
    let given = [&change.set[..], &drawn].concat();
    if given.is_empty() && change.replace.is_empty() {
        return Ok(now);
    }
    let mut draft = now.clone();
    for text in &change.replace {
        let (name, kind) = text.split_once('=').unwrap_or((text, ""));
        let process = draft.processes.iter_mut().find(|p| p.name == name);
        let kind = find(kinds, kind);
        let params = Node::empty_table(TextOrigin::Implied);
        let (Some(process), Some(Ok(kind))) = (process, kind.map(|kind| kind.read(&params))) else {
            let names: Vec<_> = now.processes.iter().map(|p| &*p.name).collect();
            let names = names.join(", ");
            return Err(argument(format!(
                "--replace {text}: expected PROCESS=KIND with a kind of `protean list` that needs no parameters and PROCESS \
                 one of {names}"
            )));
        };
        process.program = Program::Kind(kind);
    }
    let set = for_log(&given, &now);
    let loader = Loader::new(kinds);
    let (text, option) = (
        draft.to_toml(),
        if set.is_empty() { "--replace" } else { "--set" },
    );
    let mut next = loader
        .load_text("scenario.toml", &text, &Base::Nothing, &set, None)
        .map_err(|problems| argument(format!("{option}:\n{problems}")))?;
    let place = |name: &str| now.processes.iter().position(|own| own.name == name);
    next.processes.sort_by_key(|process| place(&process.name));
    let texts = [given, change.replace.clone()].concat().join(" ");
    if next == now && change.draw.is_empty() {
        return Err(changes_nothing(&format!("{option} {texts}")));
    }
    if let Some(what) = fixed_part(&now, &next) {
        return Err(argument(format!(
            "{option} {texts}: changes {what}: expected parameters of processes, limits, imperfections and noise of robots, \
             or rules; `protean diff LOG --set-b …` runs the whole mission with any change"
        )));
    }
    Ok(next)
}

/// Returns the override with the value that a text of `--draw` has in this run for a number of random streams.
fn drawn(text: &str, run_seed: u64, seed: u64) -> Option<String> {
    let (key, range) = text.split_once('=')?;
    let (low, high) = range.split_once("..")?;
    let mut stream = runtime::seed::stream(run_seed, key, "", &format!("draw {seed}"));
    let whole = (low.trim().parse::<i64>(), high.trim().parse::<i64>());
    if let (Ok(low), Ok(high)) = whole {
        return (low < high).then(|| format!("{key}={}", stream.random_range(low..=high)));
    }
    let (low, high): (f64, f64) = (low.trim().parse().ok()?, high.trim().parse().ok()?);
    let value = low + (high - low) * stream.random::<f64>();
    (low < high && value.is_finite()).then(|| format!("{key}={value:?}"))
}

/// Returns what differs of that which no branch can change.
fn fixed_part(a: &ResolvedScenario, b: &ResolvedScenario) -> Option<&'static str> {
    let (x, y) = (&a.world, &b.world);
    let robots = || {
        let mut pairs = x.robots.iter().zip(&y.robots);
        x.robots.len() == y.robots.len()
            && pairs.all(|(p, q)| {
                let scans = [p, q].map(|robot| robot.scan.as_ref().map(|scan| scan.beams));
                (&p.name, &p.team, p.role(), &p.hostile_to)
                    == (&q.name, &q.team, q.role(), &q.hostile_to)
                    && (p.start, p.goal, p.model().radius) == (q.start, q.goal, q.model().radius)
                    && scans[0] == scans[1]
            })
    };
    let processes = || {
        let mut pairs = a.processes.iter().zip(&b.processes);
        a.processes.len() == b.processes.len()
            && pairs.all(|(p, q)| (&p.name, &p.robots) == (&q.name, &q.robots))
    };
    if x.map != y.map || a.blur_sigma != b.blur_sigma {
        Some("the map")
    } else if !robots() {
        Some("the robots, or their teams, starts, radii, goals or beams")
    } else if x.rules.exits != y.rules.exits || x.rules.coverage != y.rules.coverage {
        Some("the exits or the accounting of the visited area")
    } else if !processes() {
        Some("the set of processes, or their robots")
    } else if a.events != b.events || a.links != b.links {
        Some("the events or the links")
    } else if a.run != b.run {
        Some("a key of `run`")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_drawn_from_their_range_by_seed() {
        let draw = |text: &str, seed| drawn(text, 7, seed);
        let mut values: Vec<f64> = (1..=100)
            .map(|seed| draw("a.b=-0.5..2", seed).unwrap())
            .map(|set| set.strip_prefix("a.b=").unwrap().parse().unwrap())
            .collect();
        values.sort_by(f64::total_cmp);
        let [low, middle, high] = [values[0], values[50], values[99]];
        assert!((-0.5..-0.3).contains(&low) && (1.8..2.0).contains(&high));
        assert!((0.45..1.05).contains(&middle), "{middle}");
        assert_eq!(draw("a=1..3", 4), draw("a=1..3", 4));
        let whole: std::collections::BTreeSet<_> =
            (1..=50).map(|seed| draw("a=1..3", seed)).collect();
        let expected = ["a=1", "a=2", "a=3"].map(|text| Some(text.to_owned()));
        assert!(whole.into_iter().eq(expected));
        for text in ["a", "a=1", "a=2..1", "a=1..1", "a=0.5..nan", "a=0..inf"] {
            assert_eq!(draw(text, 1), None, "{text}");
        }
    }

    #[test]
    fn keys_of_teams_and_kinds_are_those_of_robots_and_processes() {
        let now = kinds::load("chase", &[], Some(1)).unwrap();
        for (key, own) in [
            ("teams.evader.limits.v_max", "robots.evader_N.limits.v_max"),
            (
                "processes.evader_potential.on_failure",
                "processes.evader_potential_evader_N.on_failure",
            ),
        ] {
            let own = ["1", "2"].map(|n| own.replace('N', n) + "=1");
            assert_eq!(for_log(&[format!("{key}=1")], &now), own);
        }
        // A name of a process, a key without one, and an unknown kind.
        for text in ["processes.perception.a=1", "rules.a=1", "processes.b.c=1"] {
            assert_eq!(for_log(&[text.to_owned()], &now), [text]);
        }
    }
}
