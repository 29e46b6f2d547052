//! What is loaded of an experiment beside its file.

use scenario::kind::Kind;

use super::seeds::Seeds;

/// How an experiment is loaded.
#[derive(Debug, Clone)]
pub struct LoadOptions {
    /// The kinds of processes that scenarios may name.
    pub kinds: &'static [Kind],
    /// `key=value` arguments that go over every scenario.
    pub set: Vec<String>,
    /// Seeds in place of the file's.
    pub seeds: Option<Seeds>,
    /// Whether files may lie outside the folder of the experiment.
    pub allow_outside: bool,
    /// Whether scenarios may start programs that are not Protean's own.
    pub allow_external: bool,
}

impl LoadOptions {
    /// Nothing but what the file says, with these kinds of processes.
    pub fn new(kinds: &'static [Kind]) -> Self {
        Self {
            kinds,
            set: Vec::new(),
            seeds: None,
            allow_outside: false,
            allow_external: false,
        }
    }
}
