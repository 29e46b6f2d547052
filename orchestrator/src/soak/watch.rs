//! Looks at the processes of a mission while it runs.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::census::{self, Member};

/// How often is looked.
const EVERY: Duration = Duration::from_millis(50);

/// What one process held each time it was looked at.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Held {
    /// Memory of its own [bytes].
    pub memory: Vec<u64>,
    /// Open descriptors.
    pub descriptors: Vec<u64>,
}

/// What was seen of a mission.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Seen {
    /// By the processes' names.
    pub processes: BTreeMap<String, Held>,
    /// Directories of the runs that were seen: one, unless something else runs below this process.
    pub roots: BTreeSet<PathBuf>,
    /// Most pieces of shared memory at once.
    pub segments: u64,
}

/// A thread that looks until it is told to end.
#[derive(Debug)]
pub struct Watch {
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<Seen>>,
}

impl Watch {
    /// Begins to look at the children of this process. A thread that cannot be started sees nothing.
    pub fn start() -> Self {
        let over = Arc::new(AtomicBool::new(false));
        let told = Arc::clone(&over);
        let look = move || {
            let mut seen = Seen::default();
            while !told.load(Ordering::SeqCst) {
                if let Ok(members) = census::children(std::process::id() as i32) {
                    seen.take(members);
                }
                std::thread::park_timeout(EVERY);
            }
            seen
        };
        let thread = std::thread::Builder::new()
            .name("soak-watch".into())
            .spawn(look)
            .ok();
        Self { over, thread }
    }

    /// Ends looking; what was seen.
    pub fn end(mut self) -> Seen {
        self.over.store(true, Ordering::SeqCst);
        let Some(thread) = self.thread.take() else {
            return Seen::default();
        };
        thread.thread().unpark();
        thread.join().unwrap_or_default()
    }
}

impl Seen {
    fn take(&mut self, members: Vec<Member>) {
        for member in members {
            // Without a run's directory: not a process of a mission.
            let Some(root) = member.root else { continue };
            if !self.roots.contains(&root) {
                self.roots.insert(root.clone());
            }
            if let Ok(segments) = census::segments_of(&root) {
                self.segments = self.segments.max(segments.len() as u64);
            }
            let held = self.processes.entry(member.name).or_default();
            held.memory.push(member.memory_bytes);
            held.descriptors.push(member.descriptors);
        }
    }
}
