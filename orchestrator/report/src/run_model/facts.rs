//! Facts of a run from the metadata and attachments of its log, for pictures and reports.

use std::path::Path;

use ipc_types::messages::world::{MapCell, MapHeader};
use mcap_log::output::RECOVERED;
use mcap_log::reader::Item;
use mcap_log::{LogReadError, Origin};
use recorder::RunInfo;

use super::scenario::LoggedScenario;
use super::static_scene::StaticScene;

/// Facts of a run, from the part of the log that has been read.
#[derive(Debug, Clone, Default)]
pub struct Facts {
    /// Manifest, scenario and result.
    pub(crate) origin: Origin,
    /// `true` if the log was repaired.
    pub(crate) is_recovered: bool,
    scenario: Option<LoggedScenario>,
    /// Description of the run; `None` if it is not in the log or cannot be read.
    pub(crate) run: Option<RunInfo>,
    /// Bounds and cells of map messages.
    grid: StaticScene,
}

impl Facts {
    /// Adds a metadata record or an attachment.
    ///
    /// # Errors
    /// [`LogReadError::NotRepeatable`] if the scenario cannot be parsed.
    pub(crate) fn add(&mut self, log: &Path, item: &Item<'_>) -> Result<(), LogReadError> {
        self.origin.add(item);
        match item {
            Item::Metadata(record) if record.name == RECOVERED => self.is_recovered = true,
            Item::Attachment(header, _) if header.name == Origin::RUN => {
                self.run = RunInfo::from_log(&self.origin);
            }
            Item::Attachment(header, data) if header.name == Origin::SCENARIO => {
                let scenario = LoggedScenario::parse(data);
                self.scenario = Some(scenario.map_err(|reason| LogReadError::NotRepeatable {
                    path: log.to_owned(),
                    reason: format!("its scenario cannot be parsed: {reason}"),
                })?);
            }
            _ => {}
        }
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

    /// Moves the scenario out.
    ///
    /// # Errors
    /// [`LogReadError::Foreign`] without a manifest or a scenario.
    pub(crate) fn take_scenario(&mut self, log: &Path) -> Result<LoggedScenario, LogReadError> {
        self.origin.check(log)?;
        self.scenario.take().ok_or_else(|| LogReadError::Foreign {
            path: log.to_owned(),
            missing: "scenario",
        })
    }

    /// Moves the static scene out: the scenario's shapes, or the cells of the map messages.
    pub(crate) fn take_static_scene(&mut self, scenario: &LoggedScenario) -> StaticScene {
        let mut static_scene = StaticScene::from_map(&scenario.world.map, &scenario.rules.exits);
        if !static_scene.has_vectors() && self.grid.cells.is_some() {
            (static_scene.min, static_scene.max) = (self.grid.min, self.grid.max);
            static_scene.cells = self.grid.cells.take();
        }
        static_scene
    }
}
