//! Threads that plan.

use std::collections::VecDeque;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Instant;

use ipc_types::clock;
use rustix::event::{EventfdFlags, eventfd};
use trajectory::plan::Plan;
use trajectory_problem::{Options, Problem};

use crate::wire::Refusal;

/// Request in the queue.
pub struct Job {
    /// Unique identifier.
    pub id: u64,
    /// Problem to solve.
    pub problem: Problem,
    /// Options of the solver.
    pub options: Options,
    /// The plan that the robot follows.
    pub last: Option<Arc<Plan>>,
    /// Monotonic time limit (ns), if it applies.
    pub deadline_ns: Option<u64>,
    /// Set when the answer is not needed any more.
    pub cancelled: Arc<AtomicBool>,
}

/// Result of a request.
pub struct JobResult {
    /// [`Job::id`].
    pub id: u64,
    /// The plan, or the reason for the lack of one.
    pub result: Result<Plan, Refusal>,
    /// Computing time (ns).
    pub solve_ns: u64,
}

/// State shared by the threads of a pool.
struct PoolState {
    jobs: Mutex<Jobs>,
    /// Signals a new job, or the end of all jobs.
    changed: Condvar,
    done: Mutex<Vec<JobResult>>,
    /// Readable when a result is ready.
    bell: OwnedFd,
}

#[derive(Default)]
struct Jobs {
    waiting: VecDeque<Job>,
    closed: bool,
}

/// Threads that plan; dropping it ends them.
pub struct Pool {
    shared: Arc<PoolState>,
    threads: Vec<JoinHandle<()>>,
}

impl Pool {
    /// Starts the threads.
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn start(workers: u32) -> std::io::Result<Self> {
        let shared = Arc::new(PoolState {
            jobs: Mutex::default(),
            changed: Condvar::new(),
            done: Mutex::default(),
            bell: eventfd(0, EventfdFlags::NONBLOCK | EventfdFlags::CLOEXEC)?,
        });
        let mut pool = Self {
            shared,
            threads: Vec::new(),
        };
        for worker in 0..workers {
            let shared = Arc::clone(&pool.shared);
            let thread = std::thread::Builder::new()
                .name(format!("planner-{worker}"))
                .spawn(move || shared.work())?;
            pool.threads.push(thread);
        }
        Ok(pool)
    }

    /// Passes a job to the next free thread.
    pub fn give(&self, job: Job) {
        lock(&self.shared.jobs).waiting.push_back(job);
        self.shared.changed.notify_one();
    }

    /// Removes a job that no thread has begun.
    pub fn take_back(&self, id: u64) {
        lock(&self.shared.jobs).waiting.retain(|job| job.id != id);
    }

    /// Moves the results since the last call to `done`.
    pub fn collect(&self, done: &mut Vec<JobResult>) {
        let mut count = [0; 8];
        // Read first: a later result makes it readable again. An empty read is no error.
        let _ = rustix::io::read(&self.shared.bell, &mut count);
        done.append(&mut lock(&self.shared.done));
    }

    /// Readable when a result is ready.
    pub fn bell(&self) -> BorrowedFd<'_> {
        self.shared.bell.as_fd()
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        let mut jobs = lock(&self.shared.jobs);
        jobs.closed = true;
        jobs.waiting.clear();
        drop(jobs);
        self.shared.changed.notify_all();
        for thread in self.threads.drain(..) {
            // A panic in it was caught and logged.
            let _ = thread.join();
        }
    }
}

impl PoolState {
    fn work(&self) {
        while let Some(job) = self.next() {
            let done = work(&job);
            lock(&self.done).push(done);
            // An eventfd that is full is readable already.
            let _ = rustix::io::write(&self.bell, &1u64.to_ne_bytes());
        }
    }

    /// Returns the next job; `None` at the end of all jobs.
    fn next(&self) -> Option<Job> {
        let mut jobs = lock(&self.jobs);
        loop {
            if jobs.closed {
                return None;
            }
            if let Some(job) = jobs.waiting.pop_front() {
                return Some(job);
            }
            jobs = self
                .changed
                .wait(jobs)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }
}

fn work(job: &Job) -> JobResult {
    let start = Instant::now();
    let mut stop = || {
        job.cancelled.load(Ordering::Relaxed)
            || job
                .deadline_ns
                .is_some_and(|deadline| clock::monotonic_ns() >= deadline)
    };
    let result = super::solve(&job.problem, &job.options, job.last.as_deref(), &mut stop);
    JobResult {
        id: job.id,
        result,
        solve_ns: clock::elapsed_ns(start),
    }
}

/// A panic cannot leave the protected data inconsistent.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
