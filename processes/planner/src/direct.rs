//! The planners of a process without its ports.

use std::sync::Arc;

use geometry::pose::Twist2;
use planner_view::map::PlannerMap;
use planner_view::view::View;
use runtime::error::ProcessError;
use runtime::kind::DirectProcess;

use crate::planner::Planner;

/// Planner of one robot.
pub struct PlannerSlot<P> {
    pub robot: u32,
    pub planner: P,
}

/// Planners of a [`PlannerProcess`](crate::PlannerProcess) that needs no messages but state, map and beliefs, on the map of the start.
pub struct DirectPlanners<P> {
    pub map: Arc<PlannerMap>,
    /// Period of its steps (s).
    pub dt: f64,
    pub reads_beliefs: bool,
    pub driven: Vec<PlannerSlot<P>>,
}

impl<P: Planner> DirectProcess for DirectPlanners<P> {
    fn steer(
        &mut self,
        view: &View<'_>,
        commands: &mut [Option<Twist2>],
    ) -> Result<(), ProcessError> {
        let beliefs = if self.reads_beliefs {
            view.beliefs
        } else {
            &[]
        };
        for driven in &mut self.driven {
            let me = driven.robot as usize;
            let view = View {
                dt: self.dt,
                me,
                beliefs,
                ..*view
            };
            let steering = driven.planner.steer(&self.map, &view);
            if let Some(error) = driven.planner.failure() {
                return Err(error);
            }
            if let Some(command) = commands.get_mut(me) {
                *command = Some(steering.command);
            }
        }
        Ok(())
    }
}
