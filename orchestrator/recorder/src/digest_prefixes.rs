//! Cache of digest prefixes, shared by runs.
//!
//! The map is the largest message of a short run, and in a sweep it is always the same: it is checked and
//! hashed only once.

use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};

use ipc_types::bus::SharedElements;

use super::parts::Parts;

/// Maximum number of maps; beyond it the oldest is removed.
const MAX_MAPS: usize = 16;

/// First messages of runs in this process, with the hash state after them.
///
/// The cache identifies messages with shared elements by the address of the elements: two messages with the
/// same elements and the same header have the same bytes.
#[derive(Debug, Default)]
pub struct DigestPrefixes {
    known: Mutex<Vec<Arc<DigestPrefix>>>,
}

/// A message that passed the checks, and the hash state after it.
#[derive(Debug)]
pub(super) struct DigestPrefix {
    /// Address of the elements.
    address: usize,
    /// Keeps the elements there.
    _elements: Box<dyn Any + Send + Sync>,
    header: Vec<u8>,
    pub(super) hasher: blake3::Hasher,
}

impl DigestPrefixes {
    /// Returns the entry of a message with these elements.
    pub(super) fn find(
        &self,
        elements: &dyn SharedElements,
        message: &Parts<'_>,
    ) -> Option<Arc<DigestPrefix>> {
        let address = elements.address();
        let is_the_same =
            |known: &DigestPrefix| known.address == address && known.header == header(message);
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.iter().find(|known| is_the_same(known)).cloned()
    }

    /// Adds a message that passed the checks, with the hash state after it.
    pub(super) fn keep(
        &self,
        elements: &dyn SharedElements,
        message: &Parts<'_>,
        hasher: blake3::Hasher,
    ) {
        let beginning = Arc::new(DigestPrefix {
            address: elements.address(),
            _elements: elements.keep(),
            header: header(message),
            hasher,
        });
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() >= MAX_MAPS {
            known.remove(0);
        }
        known.push(beginning);
    }
}

/// Returns the part of the header that the digest covers.
fn header(message: &Parts<'_>) -> Vec<u8> {
    let [stamp, rest, _, _, _] = message.without_clocks();
    [stamp, rest].concat()
}
