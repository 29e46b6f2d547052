//! Wake-ups between processes that do not share the tick barrier.

use core::fmt::Debug;
use std::os::fd::BorrowedFd;
use std::time::Duration;

use iceoryx2::port::listener::ListenerWaitError;
use iceoryx2::port::notifier::NotifierNotifyError;
use iceoryx2::prelude::{EventId, FileDescriptorBased as _, Node, ipc};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::service::{TopicHolder, service_name};
use crate::error::{BusError, ReceiveError, SendError};

/// Creates an event for these numbers of ports and nodes, with ids up to `largest`.
///
/// # Errors
/// [`BusError`] if iceoryx2 refuses.
pub fn create(
    node: &Node<ipc::Service>,
    name: &'static str,
    ports: usize,
    nodes: usize,
    largest: usize,
) -> Result<TopicHolder, BusError> {
    let service = node
        .service_builder(&service_name(name)?)
        .event()
        .max_notifiers(ports)
        .max_listeners(ports)
        .max_nodes(nodes)
        .event_id_max_value(largest)
        .create()
        .map_err(|e| BusError::Create {
            topic: name,
            reason: format!("{e:?}"),
        })?;
    Ok(TopicHolder::new(name, service))
}

fn open(
    node: &Node<ipc::Service>,
    name: &'static str,
) -> Result<iceoryx2::service::port_factory::event::PortFactory<ipc::Service>, BusError> {
    node.service_builder(&service_name(name)?)
        .event()
        .open()
        .map_err(|e| BusError::Open {
            topic: name,
            reason: format!("{e:?}"),
        })
}

/// The notifying port.
trait Wake: Debug {
    fn notify(&self, id: EventId) -> Result<usize, NotifierNotifyError>;
}

impl Wake for iceoryx2::port::notifier::Notifier<ipc::Service> {
    fn notify(&self, id: EventId) -> Result<usize, NotifierNotifyError> {
        self.notify_with_custom_event_id(id)
    }
}

/// The waiting port.
trait Sleep: Debug {
    /// Sleeps until a wake-up; calls back once per id.
    fn wait(
        &self,
        timeout: Duration,
        woken: &mut dyn FnMut(usize),
    ) -> Result<u64, ListenerWaitError>;

    /// Calls back once per received id.
    fn take(&self, woken: &mut dyn FnMut(usize)) -> Result<u64, ListenerWaitError>;

    /// File descriptor that becomes readable with a wake-up.
    fn descriptor(&self) -> BorrowedFd<'_>;
}

impl Sleep for iceoryx2::port::listener::Listener<ipc::Service> {
    fn wait(
        &self,
        timeout: Duration,
        woken: &mut dyn FnMut(usize),
    ) -> Result<u64, ListenerWaitError> {
        self.timed_wait(|activation| woken(activation.id.as_value()), timeout)
    }

    fn take(&self, woken: &mut dyn FnMut(usize)) -> Result<u64, ListenerWaitError> {
        self.try_wait(|activation| woken(activation.id.as_value()))
    }

    fn descriptor(&self) -> BorrowedFd<'_> {
        let own = self.file_descriptor();
        // SAFETY: the descriptor belongs to the listener, which outlives this borrow and does not close
        // it; it is only polled.
        unsafe { BorrowedFd::borrow_raw(own.native_handle()) }
    }
}

/// Wakes the listeners of an event.
#[derive(Debug)]
pub struct Notifier {
    name: &'static str,
    port: Box<dyn Wake>,
}

impl Notifier {
    /// The port of the event with this name, which exists.
    ///
    /// # Errors
    /// [`BusError`] if iceoryx2 refuses.
    pub fn open(node: &Node<ipc::Service>, name: &'static str) -> Result<Self, BusError> {
        let port = open(node, name)?
            .notifier_builder()
            .create()
            .map_err(|e| BusError::Port {
                topic: name,
                port: "notifier",
                reason: format!("{e:?}"),
            })?;
        Ok(Self {
            name,
            port: Box::new(port),
        })
    }

    /// Wakes every listener with this id; returns their number.
    ///
    /// # Errors
    /// [`SendError::Transport`] if iceoryx2 fails or the id exceeds the service's largest.
    pub fn notify(&self, id: usize) -> Result<usize, SendError> {
        self.port
            .notify(EventId::new(id))
            .map_err(|e| SendError::Transport {
                topic: self.name,
                reason: format!("{e:?}"),
            })
    }
}

/// Waits for an event.
#[derive(Debug)]
pub struct Listener {
    name: &'static str,
    port: Box<dyn Sleep>,
}

impl Listener {
    /// The port of the event with this name, which exists.
    ///
    /// # Errors
    /// [`BusError`] if iceoryx2 refuses.
    pub fn open(node: &Node<ipc::Service>, name: &'static str) -> Result<Self, BusError> {
        let port = open(node, name)?
            .listener_builder()
            .create()
            .map_err(|e| BusError::Port {
                topic: name,
                port: "listener",
                reason: format!("{e:?}"),
            })?;
        Ok(Self {
            name,
            port: Box::new(port),
        })
    }

    /// Sleeps until a wake-up, a signal or the end of the time; calls back once per received id.
    ///
    /// # Errors
    /// [`ReceiveError::Transport`] if iceoryx2 fails.
    pub fn wait(
        &self,
        timeout: Duration,
        mut woken: impl FnMut(usize),
    ) -> Result<(), ReceiveError> {
        self.waited(self.port.wait(timeout, &mut woken))
    }

    /// Result of a wait. A wake-up by a signal is no failure (a stopped and continued process gets one
    /// too): the caller checks its conditions and waits again.
    fn waited(&self, result: Result<u64, ListenerWaitError>) -> Result<(), ReceiveError> {
        match result {
            Ok(_) | Err(ListenerWaitError::InterruptSignal) => Ok(()),
            Err(error) => Err(ReceiveError::Transport {
                topic: self.name,
                reason: format!("{error:?}"),
            }),
        }
    }

    /// As [`Listener::wait`], but also wakes when a file of this process (for example an eventfd)
    /// becomes readable; its content is not read.
    ///
    /// # Errors
    /// [`ReceiveError::Transport`] if iceoryx2 or the system fails.
    pub fn wait_or(
        &self,
        other: BorrowedFd<'_>,
        timeout: Duration,
        mut woken: impl FnMut(usize),
    ) -> Result<(), ReceiveError> {
        let failed = |reason: String| ReceiveError::Transport {
            topic: self.name,
            reason,
        };
        let mut either = [
            PollFd::from_borrowed_fd(self.port.descriptor(), PollFlags::IN),
            PollFd::from_borrowed_fd(other, PollFlags::IN),
        ];
        let timeout = Timespec {
            tv_sec: timeout.as_secs() as i64,
            tv_nsec: i64::from(timeout.subsec_nanos()),
        };
        match poll(&mut either, Some(&timeout)) {
            // A signal woke it: see above.
            Ok(_) | Err(rustix::io::Errno::INTR) => {}
            Err(error) => return Err(failed(error.to_string())),
        }
        self.waited(self.port.take(&mut woken))
    }
}
