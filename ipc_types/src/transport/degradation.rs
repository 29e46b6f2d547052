//! Connections of ports that cannot be established, or break.

use iceoryx2::port::{DegradationAction, DegradationCause, DegradationInfo};

/// Reaction of a port to a connection that fails: by default, iceoryx2 continues without a connection that cannot be
/// established (for example with too many open files), and the messages over it are lost.
#[expect(
    clippy::needless_pass_by_value,
    reason = "the signature of a handler of iceoryx2"
)]
pub(super) fn degrade(cause: DegradationCause, _: &DegradationInfo) -> DegradationAction {
    match cause {
        DegradationCause::FailedToEstablishConnection => DegradationAction::DegradeAndFail,
        // The other end is dead: the supervisor decides.
        DegradationCause::ConnectionCorrupted => DegradationAction::Warn,
    }
}
