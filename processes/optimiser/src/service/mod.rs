//! The optimiser as a service: requests in, answers out, several at once.
//!
//! A *dispatcher* thread owns the ports. It sleeps until a client or a worker wakes it, takes up
//! requests, hands them to the *workers* of a pool, gives up those that nobody wants any more, and
//! sends the answers. The process's own thread takes no part, so that it is never late for its turn.

mod dispatcher;
mod pool;
mod recent_plans;

use core::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

pub use dispatcher::{Dispatcher, DispatcherInput};
pub use recent_plans::Memory;
use trajectory::{Options, Plan, Problem};

use crate::wire::Refusal;

/// Plans; a panic, which would be a bug, becomes an answer instead of the end of everybody's run.
///
/// `last` is the plan that the robot follows. Nothing else is known of earlier requests: an answer
/// depends on its request and on that plan alone, whatever was asked, cancelled or late before it.
///
/// # Errors
/// [`Refusal`] if there is no plan.
pub fn solve(
    problem: &Problem,
    options: &Options,
    last: Option<&Plan>,
    stop: &mut dyn FnMut() -> bool,
) -> Result<Plan, Refusal> {
    // Nothing that the planning leaves half done outlives it.
    let planned = catch_unwind(AssertUnwindSafe(|| {
        trajectory::plan(problem, options, last, stop)
    }));
    match planned {
        Ok(result) => result.map_err(Refusal::Plan),
        Err(panic) => {
            let words = words(panic.as_ref());
            tracing::error!("the planning panicked: {words}");
            Err(Refusal::Failed(words))
        }
    }
}

fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("without words").to_owned()
}
