//! Options for loading an experiment, beside its file.

use scenario::kind::Kind;

use super::seeds::Seeds;

/// Options for loading an experiment.
#[derive(Debug, Clone)]
pub struct LoadOptions {
    /// The kinds of processes that scenarios may name.
    pub kinds: &'static [Kind],
    /// `key=value` overrides of every scenario.
    pub set: Vec<String>,
    /// Seeds instead of those of the file.
    pub seeds: Option<Seeds>,
    /// `true` if files may be outside the folder of the experiment.
    pub allow_outside: bool,
    /// `true` if scenarios may start external programs.
    pub allow_external: bool,
}

impl LoadOptions {
    /// Returns options that change nothing in the file, with these kinds of processes.
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
