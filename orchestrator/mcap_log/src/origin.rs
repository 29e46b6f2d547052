//! Description and result of the run in a log.

use std::collections::BTreeMap;
use std::path::Path;

use super::LogReadError;
use super::known;
use super::output::{MANIFEST, RESULT};
use super::reader::{Channel, Item, Reader};

/// Description and result of the run in a log, as far as it has been read.
#[derive(Debug, Clone, Default)]
pub struct Origin {
    /// Metadata of the run, by name.
    pub manifest: BTreeMap<String, String>,
    /// The resolved scenario, as TOML.
    pub scenario: Option<Vec<u8>>,
    /// Processes and robots of the run, as JSON.
    pub run: Option<Vec<u8>>,
    /// Result of the run, by name; empty if the run was killed, or before its end.
    pub result: BTreeMap<String, String>,
}

impl Origin {
    /// Name of the attachment with the scenario.
    pub const SCENARIO: &str = "scenario.toml";
    /// Name of the attachment with the processes and robots of the run.
    pub const RUN: &str = "run.json";

    /// Key of the manifest for the branches of the run: a JSON list of changes, each from a tick on.
    pub const BRANCHES: &str = "branches";
    /// Key of the manifest for the bag in which robots of the run were recorded.
    pub const IMPORTED: &str = "imported";

    /// Reads what precedes the messages of a log.
    ///
    /// # Errors
    /// [`LogReadError`]: the log cannot be read or is not a Protean log.
    pub fn read(log: &Path) -> Result<Self, LogReadError> {
        let mut reader = Reader::open(log, None)?;
        let mut origin = Self::default();
        while let Some(item) = reader.next()? {
            if matches!(item, Item::Message(..)) {
                break;
            }
            origin.add(&item);
        }
        origin.check(log)?;
        Ok(origin)
    }

    /// Adds a record of the log.
    pub fn add(&mut self, item: &Item<'_>) {
        match item {
            Item::Metadata(record) if record.name == MANIFEST => {
                self.manifest.clone_from(&record.metadata);
            }
            Item::Metadata(record) if record.name == RESULT => {
                self.result.clone_from(&record.metadata);
            }
            Item::Attachment(header, data) => match header.name.as_str() {
                Self::SCENARIO => self.scenario = Some(data.to_vec()),
                Self::RUN => self.run = Some(data.to_vec()),
                _ => {}
            },
            _ => {}
        }
    }

    /// Returns the version of Protean that recorded the log; empty if it is not in the log.
    pub fn version(&self) -> &str {
        self.manifest.get("version").map_or("", String::as_str)
    }

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
        known::other_layout(log, topic, found, self.version())
    }
}
