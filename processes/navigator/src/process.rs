//! Connects [`Navigator`] to its topics and to the optimiser.

use parameters::check;

use geometry::region::Region;
use ipc_types::bus::Bus;
use ipc_types::messages::optimiser::PlanRequest;
use ipc_types::stamp::Stamp;
use ipc_types::topics::OptimiserPlan;
use nalgebra::{Point2, Vector2};
use planner::{Declaration, Input, MAX_PLAN_POINTS, PlannedPoint, Planner, PlannerError};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use runtime::ProcessError;
use runtime::config::{Clock, ProcessConfig, RobotInfo};
use runtime::service_client::ServiceClient;

use crate::navigator::Navigator;
use crate::params::NavigatorParams;
use crate::plan_failure::PlanFailure;
use crate::wire;

/// Process of one robot.
#[derive(Debug)]
pub struct NavigatorPlanner {
    navigator: Navigator,
    params: NavigatorParams,
    name: String,
    /// Distance between the wheels (m).
    wheel_separation: f64,
    link: Option<Link>,
    failure: Option<ProcessError>,
}

/// Connection to the optimiser.
#[derive(Debug)]
struct Link {
    client: ServiceClient<OptimiserPlan>,
    robot: u32,
    clock: Clock,
    /// [`PlanRequest::last`] of the newest plan.
    last: u64,
}

impl Planner for NavigatorPlanner {
    const NAME: &'static str = "navigator";
    const SUMMARY: &'static str =
        "drives to goals on trajectories of the optimiser, around obstacles that appear";

    type Params = NavigatorParams;

    fn presets() -> Vec<(&'static str, NavigatorParams)> {
        vec![("paper", NavigatorParams::paper())]
    }

    fn declare(params: &NavigatorParams) -> Declaration {
        Declaration {
            needs_goals: params.goals.is_empty(),
            ..Declaration::default()
        }
        .reads(Input::SHAPES)
        .asks::<OptimiserPlan>(PlanRequest::MAX_POINTS)
    }

    fn new(params: &NavigatorParams, robot: &RobotInfo, _seed: u64) -> Result<Self, PlannerError> {
        check(params)?;
        let goals = if params.goals.is_empty() {
            robot
                .goal
                .as_ref()
                .map(Region::center)
                .into_iter()
                .collect()
        } else {
            params.goals.iter().copied().map(Point2::from).collect()
        };
        let navigator = Navigator::new(params.clone(), robot.model, goals)
            .map_err(|e| PlannerError::of_robot(&robot.name, e))?;
        Ok(Self {
            navigator,
            params: params.clone(),
            name: robot.name.clone(),
            wheel_separation: robot.model.wheel_separation,
            link: None,
            failure: None,
        })
    }

    fn open(&mut self, config: &ProcessConfig, bus: &Bus, robot: u32) -> Result<(), ProcessError> {
        self.navigator.meet(&config.run.robots);
        self.link = Some(Link {
            client: ServiceClient::open(bus, config.index, PlanRequest::MAX_POINTS)?,
            robot,
            clock: config.run.clock,
            last: 0,
        });
        Ok(())
    }

    fn failure(&mut self) -> Option<ProcessError> {
        self.failure.take()
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.navigate(map, view).unwrap_or_else(|error| {
            self.failure = Some(error);
            Steering::stop()
        })
    }

    fn plan(&self, _: &Steering, out: &mut Vec<PlannedPoint>) {
        let Some(follow) = self.navigator.following() else {
            return;
        };
        let left = follow.left();
        let count = MAX_PLAN_POINTS - 1;
        out.extend((0..=count).map(|i| {
            let time_s = left * i as f64 / count as f64;
            let (pose, twist) = follow.trajectory.at(follow.tau + time_s);
            PlannedPoint {
                at: pose.position(),
                theta: geometry::math::wrap_angle(pose.theta),
                time_s,
                v: twist.v,
            }
        }));
    }
}

impl NavigatorPlanner {
    fn navigate(&mut self, map: &PlannerMap, view: &View<'_>) -> Result<Steering, ProcessError> {
        let link = self
            .link
            .as_mut()
            .ok_or_else(|| ProcessError::Algorithm("the navigator was not opened".into()))?;
        let Some(space) = map.space() else {
            let reason = "the navigator needs the map's exact pieces, but they exceed the capacity \
                          of world/shapes";
            return Err(ProcessError::Algorithm(reason.into()));
        };
        if self.navigator.is_due(view.time_s) {
            let asked = link.client.is_asking();
            let answer = match link.clock {
                // In lock-step a plan takes effect at its tick, whenever it arrives.
                Clock::LockStep => link.client.wait()?,
                Clock::RealTime { .. } => {
                    // Checked before the answer: an optimiser that answers and then ends has
                    // answered.
                    let server_gone = link.client.is_server_gone();
                    let answer = link.client.poll()?;
                    if server_gone {
                        link.client.give_up();
                    }
                    answer
                }
            };
            if let Some((header, samples)) = answer {
                let planned = wire::decode(&header, &samples);
                if let Err(reason) = &planned
                    && self.navigator.is_news(reason)
                {
                    tracing::warn!("{}: {reason}", self.name);
                }
                if planned.is_ok() {
                    link.last = header.stamp.sequence.saturating_add(1);
                }
                self.navigator.take(planned, space, view.time_s);
            } else if asked && !link.client.is_asking() {
                let gone = PlanFailure::NoAnswer("the optimiser has ended".to_owned());
                if self.navigator.is_news(&gone) {
                    tracing::warn!("{}: {gone}", self.name);
                }
                self.navigator.take(Err(gone), space, view.time_s);
            }
        }
        let decision = self.navigator.step(map, space, view);
        if let Some(ask) = &decision.ask {
            let stamp = Stamp {
                tick: (view.time_s / view.dt).round() as u64,
                time_ns: (view.time_s * 1e9).round() as u64,
                ..Stamp::default()
            };
            let deadline_ns = link.deadline_ns(self.params.planning_time_s);
            let plan = &self.params.plan;
            let (header, points) = wire::encode(
                ask,
                plan,
                self.wheel_separation,
                link.robot,
                link.last,
                deadline_ns,
                stamp,
            );
            link.client.ask(header, &points)?;
        }
        Ok(Steering {
            command: decision.command,
            target: None,
            aim: self.navigator.goal(),
            waypoint: None,
            field: Vector2::zeros(),
        })
    }
}

impl Link {
    /// Returns the time limit of an answer (real ns); 0 in lock-step, where simulated time does not
    /// advance meanwhile.
    fn deadline_ns(&self, planning_time_s: f64) -> u64 {
        match self.clock {
            Clock::LockStep => 0,
            Clock::RealTime { factor, .. } => {
                let real_s = planning_time_s / factor.max(1e-3);
                ((real_s * 1e9) as u64).max(1_000_000)
            }
        }
    }
}
