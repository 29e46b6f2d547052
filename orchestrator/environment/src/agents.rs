//! Robots that the learner steers.

use mission::in_process::placement::{processes_of, steers};
use scenario::ResolvedScenario;

use crate::error::EnvironmentError;

/// Agents of a scenario.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Agents {
    /// Indices of the robots, in the order of their names in the options.
    pub robots: Vec<usize>,
    /// Indices of the processes in whose place the learner steers.
    pub processes: Vec<usize>,
}

impl Agents {
    /// Returns the robots of these names, each once.
    pub fn new(scenario: &ResolvedScenario, names: &[String]) -> Result<Self, EnvironmentError> {
        let mut agents = Self {
            robots: Vec::new(),
            processes: Vec::new(),
        };
        for name in names {
            for index in processes_of(scenario, name)? {
                if agents.processes.contains(&index) {
                    continue;
                }
                agents.processes.push(index);
                let process = scenario.processes.get(index);
                agents
                    .robots
                    .extend(process.iter().flat_map(|process| &process.robots));
            }
        }
        Ok(agents)
    }

    /// Checks that the agents can step in every tick, and nothing is late to or from them.
    pub fn check_links(&self, scenario: &ResolvedScenario) -> Result<(), EnvironmentError> {
        let links = scenario.links_by_receiver();
        for (process, index) in scenario.processes.iter().zip(1..) {
            let is_from = links.iter().flatten().any(|link| link.source == index);
            let is_to = links.get(index as usize).is_some_and(|to| !to.is_empty());
            let is_agent = self.processes.contains(&(index as usize - 1));
            if is_agent && (process.period != 1 || is_from || is_to) {
                return Err(EnvironmentError::Linked(process.name.clone()));
            }
        }
        Ok(())
    }

    /// Returns `true` if nothing but the agents' commands has an effect on the world.
    pub fn are_alone(&self, scenario: &ResolvedScenario) -> bool {
        let others = scenario.processes.iter().enumerate();
        let mut others = others.filter(|(index, _)| !self.processes.contains(index));
        scenario.events.is_empty() && !others.any(|(_, process)| steers(process))
    }
}
