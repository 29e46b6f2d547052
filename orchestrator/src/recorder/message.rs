//! A message in its place among the others of a run.

use ipc_types::stamp::Stamp;
use ipc_types::topics::TopicId;

/// What the outcome, the log and the observer get, in the order of the log.
#[derive(Debug, Clone, Copy)]
pub(super) struct Message<'a> {
    /// Its topic.
    pub(super) topic: TopicId,
    /// Its stamp.
    pub(super) stamp: &'a Stamp,
    /// Time at which it is logged (simulated ns).
    pub(super) time_ns: u64,
    /// Whether it failed the checks.
    pub(super) rejected: bool,
    /// Its CDR form.
    pub(super) bytes: &'a [u8],
}
