//! A scenario with everything filled in: what a run is a function of.

use config::{Node, write_document};
use platform::shell::quote;
use runtime::kind::{Need, Product};
use serde_json::{Value as Json, json};
use sim_backend::spec::{RulesSpec, WorldSpec};

use super::events::EventSpec;
use super::failure::Supervision;
use super::kind::ConfiguredKind;
use super::spec::{LogSpec, RunSpec};

/// What a process is.
#[derive(Debug, Clone, PartialEq)]
pub enum Program {
    /// A kind of this program, with its parameters.
    Kind(ConfiguredKind),
    /// An executable of the user's.
    Command {
        /// Its path and arguments.
        words: Vec<String>,
        /// Its parameters as written.
        params: Json,
    },
}

impl ProcessSpec {
    /// Whether it makes something for others; of a command that is not known.
    pub fn makes(&self, product: Product) -> bool {
        let kind = self.program.kind();
        kind.is_some_and(|kind| kind.kind().makes(product))
    }

    /// Whether another part of the scenario must provide something; of a command that is not known.
    pub fn needs(&self, need: Need) -> bool {
        self.program.kind().is_some_and(|kind| kind.needs(need))
    }
}

impl Program {
    /// The command line of a program that is not ours, as a person shall judge it: quoted as for a
    /// shell, and on one line whatever it holds. `None` for one of ours.
    pub fn command_line(&self) -> Option<String> {
        let Self::Command { words, .. } = self else {
            return None;
        };
        let shown = |word: &String| {
            if word.contains(char::is_control) {
                format!("{word:?}")
            } else {
                quote(word)
            }
        };
        Some(words.iter().map(shown).collect::<Vec<_>>().join(" "))
    }

    /// The kind, if it is one of this program.
    pub fn kind(&self) -> Option<&ConfiguredKind> {
        match self {
            Self::Kind(kind) => Some(kind),
            Self::Command { .. } => None,
        }
    }

    /// The name of the kind, if it is one of this program.
    pub fn kind_name(&self) -> Option<&'static str> {
        self.kind().map(|kind| kind.kind().name)
    }

    /// The parameters as JSON.
    pub fn params(&self) -> Json {
        match self {
            Self::Kind(kind) => kind.json(),
            Self::Command { params, .. } => params.clone(),
        }
    }
}

/// One process of the run (the simulator is always there and not listed).
#[derive(Debug, Clone, PartialEq)]
pub struct ProcessSpec {
    /// Unique name.
    pub name: String,
    /// What is executed, with which parameters.
    pub program: Program,
    /// Indices (into [`WorldSpec::robots`]) of the robots that it commands; sorted.
    pub robots: Vec<usize>,
    /// How it is looked after.
    pub supervision: Supervision,
}

/// A scenario as it runs: presets, teams, defaults, overrides, map and start jitter applied.
#[derive(Debug, Clone, PartialEq)]
pub struct ResolvedScenario {
    /// Short name, from the file's name unless the file says otherwise.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Some lines for people.
    pub description: String,
    /// Time, chance, waiting.
    pub run: RunSpec,
    /// Map (written out), robots where they start, rules, seed.
    pub world: WorldSpec,
    /// Standard deviation of the Gaussian blur of the map that planners and visibility use (m).
    pub blur_sigma: f64,
    /// The processes in the order in which they are started: first those that others wait for.
    pub processes: Vec<ProcessSpec>,
    /// Changes of the obstacles: by time those whose times are known, then in their order those of
    /// obstacles with a change that waits for a robot.
    pub events: Vec<EventSpec>,
    /// What is recorded.
    pub log: LogSpec,
}

impl ResolvedScenario {
    /// The rules of the game.
    pub fn rules(&self) -> &RulesSpec {
        &self.world.rules
    }

    /// Whether running it executes programs that are not ours.
    pub fn uses_external_commands(&self) -> bool {
        self.external_commands().next().is_some()
    }

    /// The processes that are not ours.
    pub fn external_commands(&self) -> impl Iterator<Item = &ProcessSpec> {
        self.processes.iter().filter(|p| p.program.kind().is_none())
    }

    /// The scenario as a TOML file that is complete in itself and loads to the same
    /// [`ResolvedScenario`]: the map is written out, the starts are the drawn ones.
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
                    Program::Command { words, .. } => block["command"] = json!(words),
                }
                if !p.robots.is_empty() {
                    block["robots"] = p.robots.iter().map(robot_name).collect();
                    block["grouping"] = json!("together");
                }
                block
            })
            .collect();
        let root = json!({
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
        Node::from_json(&root)
            .map(|node| write_document(&node))
            .unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_line_is_one_line_from_which_its_words_can_be_told() {
        let line = |words: &[&str]| {
            Program::Command {
                words: words.iter().map(|&w| w.to_owned()).collect(),
                params: Json::Null,
            }
            .command_line()
        };
        assert_eq!(line(&["./a", "b"]).unwrap(), "./a b");
        assert_eq!(line(&["sh", "-c", "x; y", ""]).unwrap(), "sh -c 'x; y' ''");
        let forged = line(&["ls", "\nStart them? [y/N] n\n"]).unwrap();
        assert_eq!(forged, r#"ls "\nStart them? [y/N] n\n""#);
    }
}
