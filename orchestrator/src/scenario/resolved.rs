//! A scenario with everything filled in: what a run is a function of.

use config::{Node, write_document};
use platform::shell::quote;
use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json};
use sim_backend::spec::{RulesSpec, WorldSpec};

use super::events::EventSpec;
use super::failure::Supervision;
use super::spec::{LogSpec, RunSpec};

/// Who a process is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Program {
    /// One of our own, by its kind.
    Kind(String),
    /// An executable of the user's: its path and arguments.
    Command(Vec<String>),
}

impl Program {
    /// The command line of a program that is not ours, as a person shall judge it: quoted as for a
    /// shell, and on one line whatever it holds. `None` for one of ours.
    pub fn command_line(&self) -> Option<String> {
        let Self::Command(words) = self else {
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
}

/// One process of the run (the simulator is always there and not listed).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProcessSpec {
    /// Unique name.
    pub name: String,
    /// What is executed.
    pub program: Program,
    /// Indices (into [`WorldSpec::robots`]) of the robots that it commands; sorted.
    pub robots: Vec<usize>,
    /// How it is looked after.
    pub supervision: Supervision,
    /// Its parameters; complete and checked for a [`Program::Kind`], as written for a command.
    pub params: Json,
}

/// A scenario as it runs: presets, teams, defaults, overrides, map and start jitter applied.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// Standard deviation of the Gaussian blur of the map that planners and visibility use [m].
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
        self.processes
            .iter()
            .filter(|p| matches!(p.program, Program::Command(_)))
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
                    "params": p.params,
                });
                match &p.program {
                    Program::Kind(kind) => block["kind"] = json!(kind),
                    Program::Command(command) => block["command"] = json!(command),
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
            Program::Command(words.iter().map(|&w| w.to_owned()).collect()).command_line()
        };
        assert_eq!(line(&["./a", "b"]).unwrap(), "./a b");
        assert_eq!(line(&["sh", "-c", "x; y", ""]).unwrap(), "sh -c 'x; y' ''");
        let forged = line(&["ls", "\nStart them? [y/N] n\n"]).unwrap();
        assert_eq!(forged, r#"ls "\nStart them? [y/N] n\n""#);
        assert_eq!(Program::Kind("pursuer".into()).command_line(), None);
    }
}
