//! A message in its place among the others of a run.

use ipc_types::stamp::Stamp;

use super::topic_info::Role;

/// What the outcome, the log and the observer get, in the order of the log.
#[derive(Debug, Clone, Copy)]
pub(super) struct Message<'a> {
    /// Place of its topic in the list of topics.
    pub(super) rank: usize,
    /// What its topic is for.
    pub(super) role: Role,
    /// Its stamp.
    pub(super) stamp: &'a Stamp,
    /// Time at which it is logged [simulated ns].
    pub(super) time_ns: u64,
    /// Whether it failed the checks.
    pub(super) rejected: bool,
    /// Its CDR form.
    pub(super) bytes: &'a [u8],
}
