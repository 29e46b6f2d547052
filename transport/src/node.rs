//! The node of a process: its membership in a run.

use core::fmt;
use std::fs::File;

use iceoryx2::prelude::{Config, LogLevel, Node, NodeBuilder, NodeName, SignalHandlingMode, ipc};

use super::run_space::RunSpace;
use crate::error::BusError;

/// The iceoryx2 configuration type, for tools that inspect a run from outside.
pub type TransportConfig = Config;

/// Sets the log level of iceoryx2 to errors; its warnings concern intended properties of the run
/// space.
pub fn quiet_transport() {
    iceoryx2::prelude::set_log_level(LogLevel::Error);
}

/// A node.
pub trait Home: fmt::Debug {
    /// The node of iceoryx2.
    fn node(&self) -> &Node<ipc::Service>;

    /// Frees resources of dead processes of the run; returns the number of cleaned nodes.
    fn clean_up_dead(&self) -> u64;
}

#[derive(Debug)]
struct LockedNode {
    node: Node<ipc::Service>,
    /// Lock of the run's shared memory, released after the node.
    _lock: File,
}

impl Home for LockedNode {
    fn node(&self) -> &Node<ipc::Service> {
        &self.node
    }

    fn clean_up_dead(&self) -> u64 {
        self.node.try_cleanup_dead_nodes().cleanups
    }
}

/// Joins a run with this number of nodes as the process with this name.
///
/// # Errors
/// [`BusError`] if iceoryx2 refuses.
pub fn join(space: &RunSpace, nodes: usize, process: &str) -> Result<Box<dyn Home>, BusError> {
    let failed = |reason: String| BusError::Node {
        root: space.root().to_owned(),
        reason,
    };
    let lock = space.hold().map_err(|e| failed(e.to_string()))?;
    let name = NodeName::new(process).map_err(|e| failed(format!("{e:?}")))?;
    let node = NodeBuilder::new()
        .config(&space.config(nodes)?)
        .name(&name)
        // The processes handle their signals themselves.
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create::<ipc::Service>()
        .map_err(|e| failed(format!("{e:?}")))?;
    space.keep_others_out().map_err(|e| failed(e.to_string()))?;
    Ok(Box::new(LockedNode { node, _lock: lock }))
}
