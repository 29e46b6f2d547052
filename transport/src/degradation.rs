//! Connections of ports that cannot be established, or break.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use iceoryx2::port::{DegradationAction, DegradationCause, DegradationInfo};

use crate::error::BusError;

/// Failures of the connections of a port. By default, iceoryx2 continues without a connection that cannot be
/// established (for example with too many open files), and the messages over it are lost. While a port is created it
/// does so in any case.
#[derive(Default)]
pub struct Failures(Arc<AtomicBool>);

impl Failures {
    /// Returns the reaction of a port to a connection that fails: sending or receiving fails, too.
    pub(crate) fn handler(
        &self,
    ) -> impl Fn(DegradationCause, &DegradationInfo) -> DegradationAction + Send + 'static {
        let has_failed = Arc::clone(&self.0);
        move |cause, _| match cause {
            DegradationCause::FailedToEstablishConnection => {
                has_failed.store(true, Ordering::Relaxed);
                DegradationAction::DegradeAndFail
            }
            // The other end is dead: the supervisor decides.
            DegradationCause::ConnectionCorrupted => DegradationAction::Warn,
        }
    }

    /// Returns the port that was created, if it has all connections.
    pub(crate) fn checked<P, E: core::fmt::Debug>(
        &self,
        topic: &'static str,
        port: &'static str,
        created: Result<P, E>,
    ) -> Result<P, BusError> {
        let failed = |reason| BusError::Port {
            topic,
            port,
            reason,
        };
        let created = created.map_err(|e| failed(format!("{e:?}")))?;
        if self.0.load(Ordering::Relaxed) {
            return Err(failed("it cannot connect to another process".into()));
        }
        Ok(created)
    }
}
