//! Facts of a run from the metadata and attachments of its log, for pictures and reports.

use std::collections::BTreeMap;
use std::path::Path;

use ipc_types::messages::world::{MapCell, MapHeader};
use mcap_log::LogReadError;
use mcap_log::output::{FILTERED, MANIFEST, RECOVERED, RESULT};
use mcap_log::{AttachmentHeader, Metadata};
use recorder::RunInfo;

use super::scenario::LoggedScenario;
use super::static_scene::StaticScene;

/// Facts of a run, from the part of the log that has been read.
#[derive(Debug, Default)]
pub(crate) struct Facts {
    /// Scenario name, seed, version and others; empty without a manifest.
    pub(crate) manifest: BTreeMap<String, String>,
    /// Result of the run; empty if the run was killed.
    pub(crate) result: BTreeMap<String, String>,
    /// `true` if the log is a part of another.
    pub(crate) is_filtered: bool,
    /// `true` if the log was repaired.
    pub(crate) is_recovered: bool,
    /// Text of the resolved scenario.
    pub(crate) scenario_text: String,
    scenario: Option<LoggedScenario>,
    /// Description of the run; `None` if it is not in the log or cannot be read.
    pub(crate) run: Option<RunInfo>,
    /// Bounds and cells of map messages.
    grid: StaticScene,
}

impl Facts {
    /// Adds a metadata record.
    pub(crate) fn metadata(&mut self, record: Metadata) {
        match record.name.as_str() {
            MANIFEST => self.manifest = record.metadata,
            RESULT => self.result = record.metadata,
            FILTERED => self.is_filtered = true,
            RECOVERED => self.is_recovered = true,
            _ => {}
        }
    }

    /// Adds an attachment.
    ///
    /// # Errors
    /// [`LogReadError::NotRepeatable`] if the scenario cannot be parsed.
    pub(crate) fn attachment(
        &mut self,
        log: &Path,
        header: &AttachmentHeader,
        data: &[u8],
    ) -> Result<(), LogReadError> {
        if header.name == RunInfo::ATTACHMENT {
            self.run = serde_json::from_slice(data).ok();
        }
        if header.name != "scenario.toml" {
            return Ok(());
        }
        let scenario =
            LoggedScenario::parse(data).map_err(|reason| LogReadError::NotRepeatable {
                path: log.to_owned(),
                reason: format!("its scenario cannot be parsed: {reason}"),
            })?;
        self.scenario = Some(scenario);
        self.scenario_text = String::from_utf8_lossy(data).into_owned();
        Ok(())
    }

    /// Replaces the cells of the map.
    pub(crate) fn map(&mut self, header: &MapHeader, cells: &[MapCell]) {
        self.grid.use_cells(header, cells);
    }

    /// Returns `true` if a map has been read.
    pub(crate) fn has_map(&self) -> bool {
        self.grid.cells.is_some()
    }

    /// Returns the version of Protean that recorded the log; empty if it is not in the log.
    pub(crate) fn version(&self) -> &str {
        self.manifest.get("version").map_or("", String::as_str)
    }

    /// Moves the scenario out.
    ///
    /// # Errors
    /// [`LogReadError::Foreign`] without a manifest or a scenario.
    pub(crate) fn take_scenario(&mut self, log: &Path) -> Result<LoggedScenario, LogReadError> {
        let foreign = |missing| LogReadError::Foreign {
            path: log.to_owned(),
            missing,
        };
        if self.manifest.is_empty() {
            return Err(foreign("manifest"));
        }
        self.scenario.take().ok_or_else(|| foreign("scenario"))
    }

    /// Moves the static scene out: the scenario's shapes, or the cells of the map messages.
    pub(crate) fn take_static_scene(&mut self, scenario: &LoggedScenario) -> StaticScene {
        let mut static_scene = StaticScene::of(&scenario.world.map, &scenario.rules.exits);
        if !static_scene.has_vectors() && self.grid.cells.is_some() {
            (static_scene.min, static_scene.max) = (self.grid.min, self.grid.max);
            static_scene.cells = self.grid.cells.take();
        }
        static_scene
    }
}
