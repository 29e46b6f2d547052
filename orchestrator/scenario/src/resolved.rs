//! A scenario with all values filled in: the complete input of a run.

use std::collections::BTreeMap;

use config::{Node, write_document};
use geometry::map::MapSpec;
use platform::shell::quote;
use runtime::declaration::{Declaration, Flow, WrittenDeclaration};
use serde_json::{Value as Json, json};
use sim_backend::spec::{RulesSpec, WorldSpec};

use super::events::EventSpec;
use super::failure::Supervision;
use super::kind::ConfiguredKind;
use super::spec::{LinkSpec, LogSpec, RunSpec};

/// Value of `declaration` of a program that is asked for it.
pub(super) const ASK: &str = "ask";

/// Program of a process.
#[derive(Debug, Clone, PartialEq)]
pub enum Program {
    /// A kind of this program, with its parameters.
    Kind(ConfiguredKind),
    /// An external executable.
    Command {
        /// Its path and arguments.
        words: Vec<String>,
        /// Its working directory, an absolute path.
        folder: String,
        /// Its parameters as written.
        params: Json,
        /// Its declaration in words.
        declared: ProgramDeclaration,
    },
}

/// Declaration of an external program.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum ProgramDeclaration {
    /// Its inputs and outputs are unknown: it may read all, and commands its robots.
    #[default]
    Nothing,
    /// The program states it when it is asked, before the run.
    OnRequest,
    /// Its inputs and outputs, as written and with their topics.
    Written(Box<(WrittenDeclaration, Declaration)>),
}

impl ProcessSpec {
    /// Returns its inputs and outputs; `None` for an external program that does not declare them.
    pub fn declaration(&self) -> Option<Declaration> {
        match &self.program {
            Program::Kind(kind) => Some(kind.declaration()),
            Program::Command { declared, .. } => match declared {
                ProgramDeclaration::Written(known) => Some(known.1.clone()),
                ProgramDeclaration::Nothing | ProgramDeclaration::OnRequest => None,
            },
        }
    }

    /// Returns `true` for an external program that states its declaration when it is asked.
    pub fn is_to_be_asked(&self) -> bool {
        matches!(&self.program, Program::Command { declared, .. } if *declared == ProgramDeclaration::OnRequest)
    }

    /// Returns `true` if it is known to write this flow.
    pub fn writes(&self, flow: Flow) -> bool {
        let declaration = self.declaration();
        declaration.is_some_and(|declaration| declaration.output(flow).is_some())
    }
}

impl Program {
    /// Returns the command line of an external program and its working directory for review by the user: quoted as
    /// for a shell, always on one line. Returns `None` for a kind of this program.
    pub fn command_line(&self) -> Option<String> {
        let Self::Command { words, folder, .. } = self else {
            return None;
        };
        let shown = |word: &String| {
            if word.contains(char::is_control) {
                format!("{word:?}")
            } else {
                quote(word)
            }
        };
        let line = words.iter().map(shown).collect::<Vec<_>>().join(" ");
        Some(format!("{line} (in {})", shown(folder)))
    }

    /// Returns the kind, if it is one of this program.
    pub fn kind(&self) -> Option<&ConfiguredKind> {
        match self {
            Self::Kind(kind) => Some(kind),
            Self::Command { .. } => None,
        }
    }

    /// Returns the name of the kind, if it is one of this program.
    pub fn kind_name(&self) -> Option<&'static str> {
        self.kind().map(|kind| kind.kind().name)
    }

    /// Returns the parameters as JSON.
    pub fn params(&self) -> Json {
        match self {
            Self::Kind(kind) => kind.json(),
            Self::Command { params, .. } => params.clone(),
        }
    }
}

/// One process of the run. The simulator always runs and is not listed.
#[derive(Debug, Clone, PartialEq)]
pub struct ProcessSpec {
    /// Unique name.
    pub name: String,
    /// Program and its parameters.
    pub program: Program,
    /// Indices (into [`WorldSpec::robots`]) of the robots that it commands; sorted.
    pub robots: Vec<usize>,
    /// Supervision of the process.
    pub supervision: Supervision,
    /// It steps in the ticks that are multiples of this number, ≥ 1.
    pub period: u64,
}

/// A scenario ready to run, with presets, teams, defaults, overrides, map and start jitter applied.
#[derive(Debug, Clone, PartialEq)]
pub struct ResolvedScenario {
    /// Short name; default: the name of the file.
    pub name: String,
    /// Title in one line.
    pub title: String,
    /// Description in some lines.
    pub description: String,
    /// Time, randomness and timeouts.
    pub run: RunSpec,
    /// Map (written out), robots at their starts, rules and seed.
    pub world: WorldSpec,
    /// Standard deviation of the Gaussian blur of the map that planners and visibility use (m).
    pub blur_sigma: f64,
    /// Remark about the file of the map, if there is one.
    pub map_remark: Option<String>,
    /// Processes in the order of their start: those that others wait for come first.
    pub processes: Vec<ProcessSpec>,
    /// Changes of the obstacles: first those with known times, by time; then, in order, those of
    /// obstacles with a change that waits for a robot.
    pub events: Vec<EventSpec>,
    /// Links with delays and losses.
    pub links: Vec<LinkSpec>,
    /// Contents and format of the log.
    pub log: LogSpec,
}

impl ResolvedScenario {
    /// Returns the names of the obstacles that have one, by id.
    pub fn obstacle_names(&self) -> BTreeMap<u32, String> {
        let obstacles = match &self.world.map {
            MapSpec::Vector(map) => map.obstacles.as_slice(),
            _ => &[],
        };
        let of_map = (0..).zip(obstacles.iter().map(|obstacle| obstacle.name.clone()));
        let of_events = self
            .events
            .iter()
            .map(|event| (event.id, event.obstacle.clone()));
        of_map
            .filter(|(_, name)| !name.is_empty())
            .chain(of_events)
            .collect()
    }

    /// Returns the indices of the robots with the task of this one, itself included: of its team, driven by processes of one
    /// kind around one contour with the same zones and time limit of a lap, on one graph, or over the same rectangles.
    pub fn companions(&self, robot: usize) -> Vec<usize> {
        let (robots, map) = (&self.world.robots, &self.world.map);
        let task = |robot: usize| {
            let driver = self.processes.iter().find(|p| p.robots.contains(&robot));
            let (kind, spec) = (driver?.program.kind()?, robots.get(robot)?);
            let limit_s = kind.declaration().lap_limit_s;
            let sketch = kind.sketch(spec, map);
            let is_shared = !sketch.rectangles.is_empty() || sketch.graph.is_some();
            (limit_s.is_some() || is_shared).then_some((
                kind.kind().name,
                &spec.team,
                limit_s,
                sketch,
            ))
        };
        let Some(own) = task(robot) else {
            return Vec::new();
        };
        let is_same = |&other: &usize| task(other).as_ref() == Some(&own);
        (0..robots.len()).filter(is_same).collect()
    }

    /// Returns the rules of the game.
    pub fn rules(&self) -> &RulesSpec {
        &self.world.rules
    }

    /// Returns `true` if a run executes external programs.
    pub fn uses_external_commands(&self) -> bool {
        self.external_commands().next().is_some()
    }

    /// Returns the processes that run external programs.
    pub fn external_commands(&self) -> impl Iterator<Item = &ProcessSpec> {
        self.processes.iter().filter(|p| p.program.kind().is_none())
    }

    /// Writes the scenario as a self-contained TOML file that loads to the same [`ResolvedScenario`]: it
    /// contains the map and the drawn starts.
    pub fn to_toml(&self) -> String {
        let robot_name = |&i: &usize| {
            self.world
                .robots
                .get(i)
                .map(|r| r.name.clone())
                .unwrap_or_default()
        };
        let processes: Vec<Json> = self
            .processes
            .iter()
            .map(|p| {
                let Supervision {
                    on_failure,
                    ready_timeout_s,
                } = p.supervision;
                let mut block = json!({
                    "name": p.name,
                    "on_failure": on_failure,
                    "ready_timeout_s": ready_timeout_s,
                    "params": p.program.params(),
                });
                match &p.program {
                    Program::Kind(kind) => block["kind"] = json!(kind.kind().name),
                    Program::Command {
                        words,
                        folder,
                        declared,
                        ..
                    } => {
                        block["command"] = json!(words);
                        block["folder"] = json!(folder);
                        match declared {
                            ProgramDeclaration::Nothing => {}
                            ProgramDeclaration::OnRequest => block["declaration"] = json!(ASK),
                            ProgramDeclaration::Written(known) => {
                                block["declaration"] = json!(known.0);
                            }
                        }
                    }
                }
                if p.period != 1 {
                    block["period"] = json!(p.period);
                }
                if !p.robots.is_empty() {
                    block["robots"] = p.robots.iter().map(robot_name).collect();
                    block["grouping"] = json!("together");
                }
                block
            })
            .collect();
        let mut root = json!({
            "name": self.name,
            "title": self.title,
            "description": self.description,
            "run": self.run,
            "world": { "map": self.world.map, "blur_sigma": self.blur_sigma },
            "rules": self.world.rules,
            "robots": self.world.robots,
            "processes": processes,
            "events": self.events,
            "log": self.log,
        });
        if !self.links.is_empty() {
            root["links"] = json!(self.links);
        }
        Node::from_json(&root)
            .map(|node| write_document(&node))
            .unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_line_is_one_line_with_separable_words() {
        let line = |words: &[&str]| {
            Program::Command {
                words: words.iter().map(|&w| w.to_owned()).collect(),
                folder: "/my missions".to_owned(),
                params: Json::Null,
                declared: ProgramDeclaration::Nothing,
            }
            .command_line()
        };
        assert_eq!(line(&["./a", "b"]).unwrap(), "./a b (in '/my missions')");
        let quoted = line(&["sh", "-c", "x; y", ""]).unwrap();
        assert!(quoted.starts_with("sh -c 'x; y' '' (in "), "{quoted}");
        let forged = line(&["ls", "\nStart them? [y/N] n\n"]).unwrap();
        assert!(
            forged.starts_with(r#"ls "\nStart them? [y/N] n\n" (in "#),
            "{forged}"
        );
    }
}
