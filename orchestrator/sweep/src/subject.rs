//! The kinds of missions that an experiment can have, on one engine.

use std::path::Path;

use config::{FieldPath, Node};

use super::cases::CaseDraft;
use super::cell::Cell;
use super::engine::Call;
use super::grid::Written;
use super::options::LoadOptions;
use super::parameters::Parameter;
use super::reader::Reader;
use super::row::Record;

/// A mission that has ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Ended<R> {
    /// Its result.
    pub row: R,
    /// CPU time of what is compared by it (ms).
    pub cpu_ms: Option<f64>,
}

/// How the thread that carries out missions uses the processors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pinning {
    /// Missions run on any processor.
    Never,
    /// Each has a processor of its own if there are as many missions at once as processors.
    IfCrowded,
    /// Each has a processor of its own.
    Always,
}

/// What a cell of an experiment is about: the type says how a file is read and a mission carried out.
#[expect(
    private_interfaces,
    reason = "the parts of an experiment file are read inside this crate"
)]
pub trait Subject: Clone + Sync {
    /// What a mission results in.
    type Row: Record;
    /// What a case starts from.
    type Draft: Clone;
    /// What carries missions out.
    type Engine: Sync + ?Sized;
    /// The word for several missions.
    const UNIT: &'static str;
    /// Top-level keys of the file that do not fit, and what to do instead.
    const FOREIGN_KEYS: &'static [(&'static str, &'static str)];

    /// Opens what a case starts from: its target as `protean run` takes it, and the draft. Without a
    /// case, that of an experiment without `[[cases]]`. What is wrong is reported.
    fn open(
        reader: &mut Reader,
        folder: &Path,
        case: Option<(&FieldPath, &Node)>,
        options: &LoadOptions,
    ) -> Option<(String, Self::Draft)>;

    /// The name of the case of an experiment without `[[cases]]`.
    fn case_name(target: &str) -> String;

    /// The cells in their order; those that are wrong are left out, and reported.
    fn cells(
        reader: &mut Reader,
        cases: &[CaseDraft<Self::Draft>],
        parameters: &[Parameter],
        combinations: &[Vec<Written>],
        options: &LoadOptions,
    ) -> Vec<Cell<Self>>;

    /// Carries out the mission of a cell with a seed; `None` if it was interrupted.
    fn carry_out(
        cell: &Cell<Self>,
        seed: u64,
        engine: &Self::Engine,
        call: &Call,
    ) -> Option<Ended<Self::Row>>;

    /// How missions of this cell use the processors.
    fn pinning(cell: &Cell<Self>, engine: &Self::Engine) -> Pinning;
}
