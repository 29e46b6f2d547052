//! What runs keep for each other.

use std::any::Any;
use std::sync::Arc;

use runtime::maps::Maps;

use crate::recorder::Beginnings;

/// What runs in one process keep for each other, because it depends on their maps alone and costs
/// more than a run: share one between all runs of a sweep. Results do not depend on it.
#[derive(Debug, Default)]
pub struct Cache {
    maps: Arc<Maps>,
    beginnings: Arc<Beginnings>,
}

impl Cache {
    /// What is known of their messages.
    pub(super) fn beginnings(&self) -> Arc<Beginnings> {
        Arc::clone(&self.beginnings)
    }

    /// The maps, as the processes of a run find them on their bus.
    pub(super) fn commons(&self) -> Arc<dyn Any + Send + Sync> {
        Arc::clone(&self.maps) as Arc<dyn Any + Send + Sync>
    }
}
