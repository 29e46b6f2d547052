//! Manifest and scenario at the head of a log.

use std::collections::BTreeMap;
use std::path::Path;

use super::LogReadError;
use super::known;
use super::reader::Channel;

/// Manifest and scenario of a log.
#[derive(Debug, Default)]
pub struct Origin {
    /// Metadata of the run, by name.
    pub manifest: BTreeMap<String, String>,
    /// The resolved scenario, as TOML.
    pub scenario: Option<Vec<u8>>,
}

impl Origin {
    /// Checks that manifest and scenario exist.
    ///
    /// # Errors
    /// The manifest or the scenario is missing: [`LogReadError`].
    pub fn check(&self, log: &Path) -> Result<(), LogReadError> {
        let missing = match (self.manifest.is_empty(), self.scenario.is_none()) {
            (true, _) => "manifest",
            (_, true) => "scenario",
            _ => return Ok(()),
        };
        let path = log.to_owned();
        Err(LogReadError::Foreign { path, missing })
    }

    /// Checks that the channel of a project topic has the layout of this version.
    ///
    /// # Errors
    /// The channel is of another version: [`LogReadError`].
    pub fn check_layout(&self, log: &Path, channel: &Channel) -> Result<(), LogReadError> {
        let Some(found) = channel.metadata.get("schema_hash") else {
            return Ok(());
        };
        match known::topic_of(channel) {
            Some(_) => Ok(()),
            None => Err(self.layout(log, &channel.topic, found)),
        }
    }

    /// Returns the error of a topic that has another layout in this version.
    pub fn layout(&self, log: &Path, topic: &str, found: &str) -> LogReadError {
        let version = self.manifest.get("version");
        known::other_layout(log, topic, found, version.map_or("", String::as_str))
    }
}
