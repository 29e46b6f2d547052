//! Looks at the processes of a mission while it runs.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::census::{self, Member};
use crate::mission::Hook;

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
    /// Memory of each process when time had ended, before it was told to go [bytes].
    pub at_end: BTreeMap<String, u64>,
}

/// A thread that looks until it is told to end.
#[derive(Debug)]
pub struct Watch {
    over: Arc<AtomicBool>,
    seen: Arc<Mutex<Seen>>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    /// Begins to look at the children of this process. A thread that cannot be started sees nothing.
    pub fn start() -> Self {
        let over = Arc::new(AtomicBool::new(false));
        let seen = Arc::new(Mutex::new(Seen::default()));
        let (told, theirs) = (Arc::clone(&over), Arc::clone(&seen));
        let look = move || {
            while !told.load(Ordering::SeqCst) {
                let members = census::children(std::process::id() as i32).unwrap_or_default();
                lock(&theirs).take(members);
                std::thread::park_timeout(EVERY);
            }
        };
        let thread = std::thread::Builder::new()
            .name("soak-watch".into())
            .spawn(look)
            .ok();
        Self { over, seen, thread }
    }

    /// What looks once more, at the end of the mission: always at the same moment of the processes'
    /// lives, however busy the machine is.
    pub fn last_look(&self) -> Hook {
        let seen = Arc::clone(&self.seen);
        Hook(Arc::new(move || {
            let members = census::children(std::process::id() as i32).unwrap_or_default();
            let mut seen = lock(&seen);
            for member in members {
                let Some(root) = member.root else { continue };
                seen.count(&root);
                seen.at_end.insert(member.name, member.memory_bytes);
            }
        }))
    }

    /// Ends looking; what was seen.
    pub fn end(mut self) -> Seen {
        self.over.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            let _ = thread.join();
        }
        std::mem::take(&mut lock(&self.seen))
    }
}

/// What was seen is whole after every look.
fn lock(seen: &Mutex<Seen>) -> std::sync::MutexGuard<'_, Seen> {
    seen.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Seen {
    /// Counts the pieces of shared memory of a run.
    fn count(&mut self, root: &Path) {
        if let Ok(segments) = census::segments_of(root) {
            self.segments = self.segments.max(segments.len() as u64);
        }
    }

    fn take(&mut self, members: Vec<Member>) {
        for member in members {
            // Without a run's directory: not a process of a mission.
            let Some(root) = member.root else { continue };
            if !self.roots.contains(&root) {
                self.roots.insert(root.clone());
            }
            self.count(&root);
            let held = self.processes.entry(member.name).or_default();
            held.memory.push(member.memory_bytes);
            held.descriptors.push(member.descriptors);
        }
    }
}
