//! The ticks at which the obstacles of a scenario change.

use ipc_types::messages::world::ObstacleEvent;
use runtime::obstacle::{self, ObstacleMessageError};
use simulator::event_schedule::{DueCondition, PlannedChange};

use scenario::{EventSpec, Moment};

/// A change of an obstacle at a tick known in advance.
#[derive(Debug, Clone)]
pub struct ScheduledChange {
    /// Tick at whose start the change is applied.
    pub tick: u64,
    /// The change.
    pub event: ObstacleEvent,
}

/// Returns the changes at ticks known in advance, by tick.
pub(super) fn scheduled(
    events: &[EventSpec],
    tick_period_ns: u64,
) -> Result<Vec<ScheduledChange>, ObstacleMessageError> {
    events
        .iter()
        .filter(|event| !event.in_turn)
        .filter_map(|event| match event.moment {
            Moment::At { time_s } => Some((time_s, event.change()?)),
            Moment::When { .. } => None,
        })
        .map(|(time_s, change)| {
            Ok(ScheduledChange {
                tick: first_tick(time_s, tick_period_ns),
                event: obstacle::to_message(&change)?,
            })
        })
        .collect()
}

/// Returns the first tick at or after a time (s).
fn first_tick(time_s: f64, tick_period_ns: u64) -> u64 {
    (time_s * 1e9 / tick_period_ns as f64 - 1e-9)
        .ceil()
        .max(0.0) as u64
}

/// Returns the simulator's event schedule: all changes of obstacles with a change that waits for a robot.
pub(super) fn event_schedule(
    events: &[EventSpec],
    tick_period_ns: u64,
) -> Result<Vec<PlannedChange>, ObstacleMessageError> {
    events
        .iter()
        .filter(|event| event.in_turn)
        .filter_map(|event| Some((event, event.change()?)))
        .map(|(event, change)| {
            // The change must fit its message when it happens.
            obstacle::to_message(&change)?;
            Ok(PlannedChange {
                obstacle: event.obstacle.clone(),
                change,
                due: match &event.moment {
                    Moment::At { time_s } => {
                        DueCondition::Tick(first_tick(*time_s, tick_period_ns))
                    }
                    Moment::When { when, after_s } => DueCondition::When {
                        robot: when.index,
                        condition: when.condition,
                        after: first_tick(*after_s, tick_period_ns),
                    },
                },
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {

    use sim_backend::spec::Condition;

    use super::*;
    use crate::plan::{Plan, Role};
    use kinds::load;

    fn plan(overrides: &[&str]) -> Plan {
        let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
        let scenario = load("chase_popup", &overrides, None).unwrap();
        Plan::new(&scenario, "warn").unwrap()
    }

    #[test]
    fn events_happen_at_the_first_tick_at_or_after_their_time() {
        let ticks = |dt: &str| -> Vec<u64> {
            let dt = format!("run.dt={dt}");
            plan(&[&dt])
                .obstacle_changes
                .iter()
                .map(|change| change.tick)
                .collect()
        };
        assert_eq!(ticks("0.05"), [200, 300, 600, 1200, 1500]);
        assert_eq!(ticks("0.3"), [34, 50, 100, 200, 250]);
    }

    #[test]
    fn obstacles_that_wait_for_robots_are_left_to_the_simulator_with_all_their_changes() {
        let when = "{ robot = \"evader_1\", within = 0.8, of = [4.5, 3.0] }";
        let plan = plan(&[
            "run.dt=0.3",
            // The third event waits for a condition of a robot instead of a time.
            &format!(
                "events.2={{ when = {when}, after_s = 1.0, action = \"move\", obstacle = \
                     \"road_works\", shape = {{ circle = {{ center = [4.5, 3.0], radius = 0.4 }} }} }}"
            ),
        ]);
        let ticks: Vec<u64> = plan
            .obstacle_changes
            .iter()
            .map(|change| change.tick)
            .collect();
        assert_eq!(ticks, [50, 250], "the lorry alone");
        let Role::Simulator(params) = &plan.launches[0].role else {
            panic!("{:?}", plan.launches[0]);
        };
        let condition = Condition::Within {
            within: 0.8,
            of: [4.5, 3.0],
        };
        let due: Vec<DueCondition> = params
            .event_schedule
            .iter()
            .map(|planned| planned.due)
            .collect();
        assert_eq!(
            due,
            [
                DueCondition::Tick(34),
                DueCondition::When {
                    robot: 4,
                    condition,
                    after: 4,
                },
                DueCondition::Tick(200),
            ]
        );
        assert!(
            params
                .event_schedule
                .iter()
                .all(|p| p.obstacle == "road_works")
        );
        assert_eq!(plan.run.events, 5);
    }
}
