//! What a log says about its run besides the messages.

use serde::Deserialize;
use sim_backend::map::MapSpec;
use sim_backend::spec::{RobotSpec, RulesSpec};

/// The parts of the scenario in a log that a picture needs; the rest is passed over, so that a
/// picture does not depend on it.
#[derive(Debug, Deserialize)]
pub(crate) struct LoggedScenario {
    #[serde(default)]
    pub(crate) title: String,
    #[serde(default)]
    pub(crate) description: String,
    pub(crate) world: LoggedWorld,
    #[serde(default)]
    pub(crate) rules: RulesSpec,
    pub(crate) robots: Vec<RobotSpec>,
}

/// `[world]` of it.
#[derive(Debug, Deserialize)]
pub(crate) struct LoggedWorld {
    pub(crate) map: MapSpec,
}

impl LoggedScenario {
    /// Reads the attachment and checks what will be drawn.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Self, String> {
        let text = str::from_utf8(bytes).map_err(|e| e.to_string())?;
        let scenario: Self = toml::from_str(text).map_err(|e| e.to_string())?;
        if let MapSpec::Vector(map) = &scenario.world.map {
            map.validate().map_err(|e| e.to_string())?;
        }
        scenario.rules.validate().map_err(|e| e.to_string())?;
        for robot in &scenario.robots {
            robot
                .validate()
                .map_err(|e| format!("{}: {e}", robot.name))?;
        }
        Ok(scenario)
    }
}
