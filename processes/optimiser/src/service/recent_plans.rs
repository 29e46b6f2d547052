//! Recent plans that robots may still follow; new plans start from them.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use ipc_types::messages::optimiser::PlanRequest;
use trajectory::plan::Plan;

/// Maximum number of robots with stored plans: invalid requests must not fill the memory.
const ROBOTS: u32 = 256;
/// Number of plans stored for each robot: it may not have received the newest ones.
const EACH: usize = 4;

/// The newest plans of every robot, by the requests that they answer.
///
/// The result for a request depends on the plan that it names and on no other request in between. A
/// client only names plans that it has received, each of which was stored before, and never one
/// older than its last.
#[derive(Debug, Default)]
pub struct Memory {
    plans: BTreeMap<u32, VecDeque<(Key, Arc<Plan>)>>,
}

/// Identity of a request: its client and its sequence number there.
type Key = (u32, u64);

impl Memory {
    /// Stores the plan that answers a request.
    pub fn keep(&mut self, request: &PlanRequest, mut plan: Plan) {
        if request.robot >= ROBOTS {
            return;
        }
        let plans = self.plans.entry(request.robot).or_default();
        let key = (request.stamp.source, request.stamp.sequence);
        // A client that restarts its count is a restarted process: it has no earlier answers.
        plans.retain(|(known, _)| known.0 != key.0 || known.1 < key.1);
        if plans.len() == EACH {
            plans.pop_front();
        }
        plan.samples.shrink_to_fit();
        plans.push_back((key, Arc::new(plan)));
    }

    /// Returns the plan that a request names as followed by its robot, and drops the plans before
    /// it.
    pub fn followed(&mut self, request: &PlanRequest) -> Option<Arc<Plan>> {
        let key = (request.stamp.source, request.last.checked_sub(1)?);
        let plans = self.plans.get_mut(&request.robot)?;
        let (_, plan) = plans.iter().find(|(known, _)| *known == key)?;
        let plan = Arc::clone(plan);
        plans.retain(|(known, _)| known.0 != key.0 || known.1 >= key.1);
        Some(plan)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trajectory::plan::{Basis, Status};
    use trajectory_problem::Method;

    fn plan(final_time: f64) -> Plan {
        Plan {
            status: Status::Planned,
            method: Method::Bspline,
            samples: Vec::new(),
            final_time,
            lower_bound: 0.0,
            length: 0.0,
            min_clearance: 0.0,
            iterations: 0,
            work: 0,
            control_points: 0,
            basis: Basis::Curve,
            failed_searches: 0,
        }
    }

    fn request(robot: u32, sequence: u64, last: u64) -> PlanRequest {
        let mut request = PlanRequest {
            robot,
            last,
            ..PlanRequest::default()
        };
        request.stamp.sequence = sequence;
        request
    }

    #[test]
    fn a_request_finds_the_plan_it_names_and_no_other() {
        let mut memory = Memory::default();
        for sequence in 0..6 {
            memory.keep(&request(1, sequence, 0), plan(sequence as f64));
            memory.keep(&request(2, sequence, 0), plan(10.0 + sequence as f64));
        }
        let mut time = |request: PlanRequest| memory.followed(&request).map(|plan| plan.final_time);
        assert_eq!(time(request(1, 9, 6)), Some(5.0));
        assert_eq!(time(request(2, 9, 4)), Some(13.0));
        // None named, a dropped one, an unknown one, another robot's.
        assert_eq!(time(request(1, 9, 0)), None);
        assert_eq!(time(request(1, 9, 2)), None);
        assert_eq!(time(request(1, 9, u64::MAX)), None);
        assert_eq!(time(request(3, 9, 6)), None);
    }

    #[test]
    fn plans_before_the_followed_one_are_dropped() {
        let mut memory = Memory::default();
        for sequence in 0..4 {
            memory.keep(&request(1, sequence, 0), plan(sequence as f64));
        }
        assert!(memory.followed(&request(1, 4, 3)).is_some());
        let left: Vec<f64> = memory.plans[&1].iter().map(|(_, p)| p.final_time).collect();
        // The followed one, and one that the robot may still receive.
        assert_eq!(left, [2.0, 3.0]);
        // An unknown plan drops nothing.
        assert_eq!(memory.followed(&request(1, 4, 1000)), None);
        assert!(memory.followed(&request(1, 4, 3)).is_some());
    }

    #[test]
    fn a_restarted_client_finds_no_plans_of_its_predecessor() {
        let mut memory = Memory::default();
        for sequence in 0..3 {
            memory.keep(&request(1, sequence, 0), plan(sequence as f64));
        }
        memory.keep(&request(1, 0, 0), plan(10.0));
        let found = memory.followed(&request(1, 1, 1)).map(|p| p.final_time);
        assert_eq!(found, Some(10.0));
        assert_eq!(memory.followed(&request(1, 1, 3)), None);
    }

    #[test]
    fn one_client_cannot_fill_it() {
        let mut memory = Memory::default();
        for robot in 0..10_000 {
            memory.keep(&request(robot, 0, 0), plan(1.0));
        }
        assert_eq!(memory.plans.len(), ROBOTS as usize);
    }
}
