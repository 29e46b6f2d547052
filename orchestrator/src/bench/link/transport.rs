//! What both sides of a link open.

use std::path::{Path, PathBuf};

use iceoryx2::prelude::{Node, ZeroCopySend, ipc};
use iceoryx2::service::port_factory::{event, publish_subscribe};
use ipc_types::messages::robot::ScanHeader;

use super::SinkConfig;
use crate::bench::{BenchError, raw};

/// As many bytes as the header of our messages has.
#[derive(Debug, Clone, Copy, Default, ZeroCopySend)]
#[repr(C)]
pub struct RawHeader {
    /// When the message was begun, first.
    pub words: [u64; size_of::<ScanHeader>() / 8],
}

pub(super) type RawService = publish_subscribe::PortFactory<ipc::Service, [f32], RawHeader>;

/// The service of the baseline, with the buffers that ours has.
pub(super) fn raw_service(
    node: &Node<ipc::Service>,
    config: &SinkConfig,
) -> Result<RawService, BenchError> {
    node.service_builder(&raw::name("raw/link")?)
        .publish_subscribe::<[f32]>()
        .user_header::<RawHeader>()
        .max_nodes(config.crowd + 4)
        .max_publishers(1)
        .max_subscribers(1 + config.crowd)
        .subscriber_max_buffer_size(4)
        .enable_safe_overflow(config.crowd > 0)
        .open_or_create()
        .map_err(BenchError::raw("open a service"))
}

/// The event of the baseline.
pub(super) fn raw_event(
    node: &Node<ipc::Service>,
) -> Result<event::PortFactory<ipc::Service>, BenchError> {
    node.service_builder(&raw::name("raw/wake")?)
        .event()
        .open_or_create()
        .map_err(BenchError::raw("open an event"))
}

/// Bytes before the payload in a socket or pipe: when it was begun [ns], and the payload's bytes.
pub(super) const FRAME: usize = 16;

pub(super) fn socket_path(root: &Path) -> PathBuf {
    root.join("link.socket")
}

pub(super) fn pipe_path(root: &Path) -> PathBuf {
    root.join("link.pipe")
}
