//! Interface of the kinds of missions of an experiment.

use std::path::Path;

use config::{FieldPath, Node};

use super::cases::CaseDraft;
use super::cell::Cell;
use super::engine::Call;
use super::grid::LocatedValue;
use super::options::LoadOptions;
use super::parameters::Parameter;
use super::reader::Reader;
use super::row::Record;

/// A finished mission.
#[derive(Debug, Clone, PartialEq)]
pub struct MissionResult<R> {
    /// Its result.
    pub row: R,
    /// CPU time that experiments of plans compare (ms).
    pub cpu_ms: Option<f64>,
}

/// Use of processors by a thread that executes missions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pinning {
    /// Missions run on any processor.
    Never,
    /// Each has its own processor if there are as many parallel missions as processors.
    IfCrowded,
    /// Each has its own processor.
    Always,
}

/// Subject of a cell of an experiment: the type defines how a file is read and a mission is
/// executed.
pub trait Subject: Clone + Sync {
    /// Result of a mission.
    type Row: Record;
    /// Starting point of a case.
    type Draft: Clone;
    /// Executor of missions.
    type Engine: Sync + ?Sized;
    /// Plural noun for missions in messages.
    const UNIT: &'static str;
    /// Top-level keys of the file that this kind does not support, and alternatives.
    const FOREIGN_KEYS: &'static [(&'static str, &'static str)];

    /// Opens the starting point of a case: its target as `protean run` takes it, and the draft.
    /// Without a case, that of an experiment without `[[cases]]`. Reports problems.
    fn open(
        reader: &mut Reader,
        folder: &Path,
        case: Option<(&FieldPath, &Node)>,
        options: &LoadOptions,
    ) -> Option<(String, Self::Draft)>;

    /// Returns the name of the case of an experiment without `[[cases]]`.
    fn case_name(target: &str) -> String;

    /// Returns the cells in order; invalid cells are reported and left out.
    fn cells(
        reader: &mut Reader,
        cases: &[CaseDraft<Self::Draft>],
        parameters: &[Parameter],
        combinations: &[Vec<LocatedValue>],
        options: &LoadOptions,
    ) -> Vec<Cell<Self>>;

    /// Executes the mission of a cell with a seed; `None` if it was interrupted.
    fn carry_out(
        cell: &Cell<Self>,
        seed: u64,
        engine: &Self::Engine,
        call: &Call,
    ) -> Option<MissionResult<Self::Row>>;

    /// Returns the use of processors by missions of this cell.
    fn pinning(cell: &Cell<Self>, engine: &Self::Engine) -> Pinning;
}
