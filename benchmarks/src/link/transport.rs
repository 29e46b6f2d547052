//! Services that both sides of a link open.

use std::path::{Path, PathBuf};

use iceoryx2::prelude::{Node, NodeBuilder, SignalHandlingMode, ZeroCopySend, ipc};
use iceoryx2::service::port_factory::{event, publish_subscribe};
use ipc_types::bus::RunSpace;
use ipc_types::messages::robot::ScanHeader;

use super::LinkError;

/// A header of the same size as that of Protean's messages.
#[derive(Debug, Clone, Copy, Default, ZeroCopySend)]
#[repr(C)]
pub struct RawHeader {
    /// Time of sending in the first word.
    pub words: [u64; size_of::<ScanHeader>() / 8],
}

pub(super) type RawService = publish_subscribe::PortFactory<ipc::Service, [f32], RawHeader>;

/// Creates a node of bare iceoryx2 in a run space.
///
/// # Errors
/// [`LinkError`] if iceoryx2 refuses.
pub fn raw_node(space: &RunSpace) -> Result<Node<ipc::Service>, LinkError> {
    NodeBuilder::new()
        .config(&space.config(2)?)
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create::<ipc::Service>()
        .map_err(LinkError::raw("create a node"))
}

/// Opens the service of the baseline, with the buffer sizes of Protean's services.
pub(super) fn raw_service(node: &Node<ipc::Service>) -> Result<RawService, LinkError> {
    let name = "raw/link".try_into();
    node.service_builder(&name.map_err(LinkError::raw("name a service"))?)
        .publish_subscribe::<[f32]>()
        .user_header::<RawHeader>()
        .max_publishers(1)
        .max_subscribers(1)
        .subscriber_max_buffer_size(4)
        .enable_safe_overflow(false)
        .open_or_create()
        .map_err(LinkError::raw("open a service"))
}

/// Opens the event of the baseline.
pub(super) fn raw_event(
    node: &Node<ipc::Service>,
) -> Result<event::PortFactory<ipc::Service>, LinkError> {
    let name = "raw/wake".try_into();
    node.service_builder(&name.map_err(LinkError::raw("name an event"))?)
        .event()
        .open_or_create()
        .map_err(LinkError::raw("open an event"))
}

/// Size of the frame before the payload in a socket or pipe (bytes): time of sending (ns), and
/// payload size (bytes).
pub(super) const FRAME: usize = 16;

pub(super) fn socket_path(root: &Path) -> PathBuf {
    root.join("link.socket")
}

pub(super) fn pipe_path(root: &Path) -> PathBuf {
    root.join("link.pipe")
}
