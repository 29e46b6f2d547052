//! How a topic's history begins, kept for other runs.
//!
//! The map is by far the largest message of a short run, and in a sweep it is always the same: it
//! need be checked and fingerprinted once.

use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};

use super::parts::Parts;

/// Most maps that are kept; beyond it the one that came first goes.
const MAX_MAPS: usize = 16;

/// The first messages of runs in this process, with the state of the fingerprint behind them.
///
/// Only messages whose elements are shared in memory are known again, by the place of their elements:
/// two messages with the same elements and the same header are the same bytes.
#[derive(Debug, Default)]
pub struct DigestPrefixes {
    known: Mutex<Vec<Arc<DigestPrefix>>>,
}

/// A message that passed the checks, and the state of its stream's hash behind it.
#[derive(Debug)]
pub(super) struct DigestPrefix {
    /// An `Arc<[E]>`.
    elements: Box<dyn Any + Send + Sync>,
    header: Vec<u8>,
    pub(super) hasher: blake3::Hasher,
}

impl DigestPrefixes {
    /// What is known of a message with these elements.
    pub(super) fn find<E: Send + Sync + 'static>(
        &self,
        elements: &Arc<[E]>,
        message: &Parts<'_>,
    ) -> Option<Arc<DigestPrefix>> {
        let is_the_same = |known: &DigestPrefix| {
            let of_known = known.elements.downcast_ref::<Arc<[E]>>();
            of_known.is_some_and(|of_known| Arc::ptr_eq(of_known, elements))
                && known.header == header(message)
        };
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.iter().find(|known| is_the_same(known)).cloned()
    }

    /// Keeps a message that passed the checks, with the state of its stream's hash behind it.
    pub(super) fn keep<E: Send + Sync + 'static>(
        &self,
        elements: &Arc<[E]>,
        message: &Parts<'_>,
        hasher: blake3::Hasher,
    ) {
        let beginning = Arc::new(DigestPrefix {
            elements: Box::new(Arc::clone(elements)),
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

/// What of the header enters the fingerprint.
fn header(message: &Parts<'_>) -> Vec<u8> {
    let [stamp, rest, _, _] = message.without_clocks();
    [stamp, rest].concat()
}
