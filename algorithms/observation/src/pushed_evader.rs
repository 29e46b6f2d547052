//! The potential-field evader as a controller of a policy, whose action is a push.

use nalgebra::Vector2;
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use sim_backend::team::Role;
use steering::potential_evader::{Evader, EvaderParams};
use steering::potential_field::FIELD_SPEED;

use crate::action::ACTION_LENGTH;
use crate::facts::RobotFacts;

/// Robot that [`Evader`] steers with its default parameters in every tick, with the push of the last action in its field.
#[derive(Debug, Clone)]
pub struct PushedEvader {
    evader: Evader,
    /// Push in the world frame (m/s).
    push: Option<Vector2<f64>>,
}

impl PushedEvader {
    /// Creates the controller of the robot with index `me`; `None` if it is no evader.
    pub fn new(own: &RobotFacts, me: usize) -> Option<Self> {
        let model = &own.model;
        let limits = Limits::new(model.v_max, model.v_reverse_max, model.omega_max).ok();
        let limits = limits.filter(|_| own.team.role == Role::Evader)?;
        let evader = Evader::new(EvaderParams::default(), limits, me as u64).ok()?;
        Some(Self { evader, push: None })
    }

    /// Takes the action of a robot with this heading (rad), until the next one.
    ///
    /// Its numbers are the parts of the push ahead and to the left. 1 is as strong as the attraction of the exit; numbers
    /// beyond ±1 are clamped. An action that is not finite is no push.
    pub fn push(&mut self, action: [f32; ACTION_LENGTH], theta: f64) {
        let [ahead, left] = action.map(|part| f64::from(part.clamp(-1.0, 1.0)) * FIELD_SPEED);
        let (sin, cos) = geometry::math::sincos(theta);
        let push = Vector2::new(cos * ahead - sin * left, sin * ahead + cos * left);
        self.push = Some(push).filter(|push| push.norm().is_finite());
    }

    /// Returns the steering of this tick.
    pub fn steering(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.evader.pushed(map, view, self.push)
    }
}
