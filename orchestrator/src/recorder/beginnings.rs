//! How a topic's history begins, kept for other runs.
//!
//! The map is by far the largest message of a short run, and in a sweep it is always the same: it
//! need be checked and fingerprinted once.

use std::sync::{Arc, Mutex, PoisonError};

use ipc_types::messages::world::MapCell;

use super::parts::Parts;

/// Most maps that are kept; beyond it the one that came first goes.
const MOST: usize = 16;

/// The first map messages of runs in this process, with the state of the fingerprint behind them.
///
/// Only messages whose cells are shared in memory are known again, by the place of their cells: two
/// messages with the same cells and the same header are the same bytes.
#[derive(Debug, Default)]
pub struct Beginnings {
    known: Mutex<Vec<Arc<Beginning>>>,
}

/// A message that passed the checks, and the state of its stream's hash behind it.
#[derive(Debug)]
pub(super) struct Beginning {
    cells: Arc<[MapCell]>,
    header: Vec<u8>,
    pub(super) hasher: blake3::Hasher,
}

impl Beginnings {
    /// What is known of a message with these cells.
    pub(super) fn find(
        &self,
        cells: &Arc<[MapCell]>,
        message: &Parts<'_>,
    ) -> Option<Arc<Beginning>> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known
            .iter()
            .find(|known| Arc::ptr_eq(&known.cells, cells) && known.header == header(message));
        found.cloned()
    }

    /// Keeps a message that passed the checks, with the state of its stream's hash behind it.
    pub(super) fn keep(&self, cells: &Arc<[MapCell]>, message: &Parts<'_>, hasher: blake3::Hasher) {
        let beginning = Arc::new(Beginning {
            cells: Arc::clone(cells),
            header: header(message),
            hasher,
        });
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() >= MOST {
            known.remove(0);
        }
        known.push(beginning);
    }
}

/// What of the header enters the fingerprint.
fn header(message: &Parts<'_>) -> Vec<u8> {
    let [stamp, rest, _, _] = message.without_clocks();
    [stamp, rest].concat()
}
