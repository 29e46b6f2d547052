//! Facts of a run that its log holds besides the messages of topics, for pictures and reports.

use std::collections::BTreeMap;
use std::path::Path;

use ipc_types::messages::world::{MapCell, MapHeader};
use mcap_log::LogReadError;
use mcap_log::output::{FILTERED, MANIFEST, RECOVERED, RESULT};
use mcap_log::{AttachmentHeader, Metadata};

use super::logged::LoggedScenario;
use super::static_scene::StaticScene;

/// Facts of a run, as far as the log has been read.
#[derive(Debug, Default)]
pub(crate) struct LogFacts {
    /// Scenario name, seed, version and others; empty without a manifest.
    pub(crate) manifest: BTreeMap<String, String>,
    /// Result of the run; empty if the run did not end in order.
    pub(crate) result: BTreeMap<String, String>,
    /// Whether the log is a part of another.
    pub(crate) is_filtered: bool,
    /// Whether the log was repaired.
    pub(crate) is_recovered: bool,
    /// Text of the resolved scenario.
    pub(crate) scenario_text: String,
    scenario: Option<LoggedScenario>,
    /// Bounds and cells of map messages.
    grid: StaticScene,
}

impl LogFacts {
    /// Takes up a metadata record.
    pub(crate) fn metadata(&mut self, record: Metadata) {
        match record.name.as_str() {
            MANIFEST => self.manifest = record.metadata,
            RESULT => self.result = record.metadata,
            FILTERED => self.is_filtered = true,
            RECOVERED => self.is_recovered = true,
            _ => {}
        }
    }

    /// Takes up an attachment.
    ///
    /// # Errors
    /// [`LogReadError::NotRepeatable`] if the scenario cannot be understood.
    pub(crate) fn attachment(
        &mut self,
        log: &Path,
        header: &AttachmentHeader,
        data: &[u8],
    ) -> Result<(), LogReadError> {
        if header.name != "scenario.toml" {
            return Ok(());
        }
        let scenario =
            LoggedScenario::parse(data).map_err(|reason| LogReadError::NotRepeatable {
                path: log.to_owned(),
                reason: format!("the scenario in it cannot be understood: {reason}"),
            })?;
        self.scenario = Some(scenario);
        self.scenario_text = String::from_utf8_lossy(data).into_owned();
        Ok(())
    }

    /// Replaces the cells of the map.
    pub(crate) fn map(&mut self, header: &MapHeader, cells: &[MapCell]) {
        self.grid.use_cells(header, cells);
    }

    /// Whether a map has been taken up.
    pub(crate) fn has_map(&self) -> bool {
        self.grid.cells.is_some()
    }

    /// Version of Protean that recorded the log; empty if the log does not say.
    pub(crate) fn version(&self) -> &str {
        self.manifest.get("version").map_or("", String::as_str)
    }

    /// Takes the scenario out.
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

    /// Takes out what does not drive: the scenario's vectors, or the cells of the map messages.
    pub(crate) fn take_ground(&mut self, scenario: &LoggedScenario) -> StaticScene {
        let mut static_scene = StaticScene::of(&scenario.world.map, &scenario.rules.exits);
        if !static_scene.has_vectors() && self.grid.cells.is_some() {
            (static_scene.min, static_scene.max) = (self.grid.min, self.grid.max);
            static_scene.cells = self.grid.cells.take();
        }
        static_scene
    }
}
