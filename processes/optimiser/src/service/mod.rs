//! The optimiser as a service: parallel requests and answers.
//!
//! A *dispatcher* thread owns the ports. It sleeps until a client or a worker wakes it, receives
//! requests, passes them to the *workers* of a pool, cancels dropped ones, and sends the answers.
//! The process's main thread takes no part, so that it is never late for its tick.

mod dispatcher;
mod pool;
mod recent_plans;

use core::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

pub use dispatcher::{Dispatcher, DispatcherInput};
pub use recent_plans::Memory;
use rustix::time::{ClockId, clock_gettime};
use trajectory::{Options, Plan, Problem};

use crate::wire::Refusal;

/// Plans; a panic, which would be a bug, becomes an answer instead of the end of the run.
///
/// `last` is the plan that the robot follows. No other state of earlier requests is used. An answer
/// depends on its request and on that plan alone, whatever was requested, cancelled or late before
/// it.
///
/// # Errors
/// [`Refusal`] if there is no plan.
pub fn solve(
    problem: &Problem,
    options: &Options,
    last: Option<&Plan>,
    stop: &mut dyn FnMut() -> bool,
) -> Result<Plan, Refusal> {
    let begun = cpu_time();
    // No partial state of the planning outlives it.
    let planned = catch_unwind(AssertUnwindSafe(|| {
        trajectory::plan(problem, options, last, stop)
    }));
    if let Ok(Ok(plan)) = &planned {
        tracing::debug!(
            "planned {:.3} s of motion ({}): {} failed searches, {} programs, work {}, {} us of CPU time",
            plan.final_time,
            plan.basis.name(),
            plan.failed_searches,
            plan.iterations,
            plan.work,
            cpu_time().saturating_sub(begun).as_micros()
        );
    }
    match planned {
        Ok(result) => result.map_err(Refusal::Plan),
        Err(panic) => {
            let words = words(panic.as_ref());
            tracing::error!("planning panicked: {words}");
            Err(Refusal::Failed(words))
        }
    }
}

/// CPU time of this thread, for the log only.
fn cpu_time() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    let seconds = Duration::from_secs(time.tv_sec.unsigned_abs());
    seconds + Duration::from_nanos(time.tv_nsec.unsigned_abs())
}

fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("without words").to_owned()
}
