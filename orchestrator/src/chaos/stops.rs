//! How soon robots stood still whose planner had failed, by the log alone.

use std::collections::BTreeMap;
use std::path::Path;

use ipc_types::cdr;
use ipc_types::messages::world::RobotState;
use ipc_types::topics::{Commands, Topic as _, WorldState};

use crate::logs::reader::{Item, Reader};
use crate::logs::{LogsError, Watch};
use crate::scenario::kinds::{KINDS, find};
use crate::scenario::{Program, ResolvedScenario};

/// What a log shows of the robots of one planner, by tick.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Robots {
    ticks: BTreeMap<u64, Tick>,
    /// Simulated time from tick to tick [ns].
    tick_period_ns: u64,
}

#[derive(Debug, Default, PartialEq)]
struct Tick {
    /// When its state was sent, on the monotonic clock [ns].
    sent_ns: u64,
    /// Of each robot of the planner.
    robots: BTreeMap<u32, Glance>,
    /// Whose commands were given for this tick.
    commanded: Vec<u32>,
}

/// How a robot stands in one state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Glance {
    /// It may move.
    Driven,
    /// It is held for want of a command, and stands.
    Held,
    /// It takes no part any more.
    Out,
}

/// What became of robots whose planner failed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stopped {
    /// Simulated time from the failure until the last of them stood [s].
    pub(super) after_s: f64,
    /// Ticks since the failure, or since a command after it, for which one of them drove on, or more.
    pub(super) ticks: u64,
}

/// The robots that a process drives; none if it drives none.
pub(super) fn driven_by(scenario: &ResolvedScenario, name: &str) -> Vec<u32> {
    let process = scenario.processes.iter().find(|p| p.name == name);
    let driver = process.filter(|process| match &process.program {
        Program::Kind(kind) => find(KINDS, kind).is_some_and(|kind| kind.drives_robots),
        Program::Command(_) => true,
    });
    let robots = driver.into_iter().flat_map(|process| &process.robots);
    robots.map(|&robot| robot as u32).collect()
}

impl Robots {
    /// Reads a log.
    ///
    /// # Errors
    /// [`LogsError`] if it cannot be read at all; a damaged one is read as far as it goes.
    pub(super) fn read(log: &Path, robots: &[u32], watch: &mut Watch) -> Result<Self, LogsError> {
        let mut reader = Reader::open(log, Some(watch))?;
        let (mut states, mut commands) = (None, None);
        let mut found = Self::default();
        while let Some(item) = reader.next()? {
            match item {
                Item::Channel(channel) if channel.topic == WorldState::NAME => {
                    states = Some(channel.id);
                }
                Item::Channel(channel) if channel.topic == Commands::NAME => {
                    commands = Some(channel.id);
                }
                Item::Message(header, data) if Some(header.channel_id) == states => {
                    let Ok((header, all)) = cdr::decode::<WorldState>(data) else {
                        continue;
                    };
                    found.tick_period_ns = header.tick_period_ns;
                    let tick = found.ticks.entry(header.stamp.tick).or_default();
                    tick.sent_ns = header.stamp.sent_ns;
                    let ours = all.iter().filter(|robot| robots.contains(&robot.robot));
                    tick.robots = ours.map(|robot| (robot.robot, Glance::of(robot))).collect();
                }
                Item::Message(header, data) if Some(header.channel_id) == commands => {
                    if let Ok((header, command)) = cdr::decode::<Commands>(data) {
                        let whose = command.iter().map(|c| c.robot);
                        let tick = found.ticks.entry(header.stamp.tick).or_default();
                        tick.commanded.extend(whose.filter(|r| robots.contains(r)));
                    }
                }
                _ => {}
            }
        }
        Ok(found)
    }

    /// What became of them after a moment on the monotonic clock. `None` if none was driven then, or
    /// the log ends, or they are out, before it shows anything.
    ///
    /// `max_age` is how many ticks a command is good for: one for which none came in time is followed
    /// that long, and then the robot is held.
    pub(super) fn stopped(&self, at_ns: u64, max_age: u64) -> Option<Stopped> {
        let states = || self.ticks.iter().filter(|(_, tick)| tick.sent_ns > 0);
        let (&failed, last) = states().rfind(|(_, tick)| tick.sent_ns <= at_ns)?;
        let mut all: Option<(u64, u64)> = None;
        for (&robot, _) in last.robots.iter().filter(|&(_, &g)| g == Glance::Driven) {
            // The newest command as the ticks go by; those before the failure count from it.
            let mut newest = failed;
            let mut stood = None;
            for (&number, tick) in self.ticks.range(failed + 1..) {
                match tick.robots.get(&robot) {
                    // Held since the state before.
                    Some(Glance::Held) => stood = Some(number - 1),
                    // Driven on for longer than any command is good for: judged as it is.
                    Some(Glance::Driven) if number - 1 > newest + max_age + 1 => {
                        stood = Some(number);
                    }
                    Some(Glance::Driven) | None => {}
                    Some(Glance::Out) => break,
                }
                if stood.is_some() {
                    break;
                }
                if tick.commanded.contains(&robot) {
                    newest = number;
                }
            }
            if let Some(stood) = stood {
                let (after, ticks) = (stood - failed, stood.saturating_sub(newest));
                let so_far = all.unwrap_or_default();
                all = Some((so_far.0.max(after), so_far.1.max(ticks)));
            }
        }
        all.map(|(after, ticks)| Stopped {
            after_s: (after * self.tick_period_ns) as f64 * 1e-9,
            ticks,
        })
    }
}

impl Glance {
    fn of(robot: &RobotState) -> Self {
        if robot.status != 0 {
            Self::Out
        } else if robot.fail_safe != 0 && robot.v == 0.0 && robot.omega == 0.0 {
            Self::Held
        } else {
            Self::Driven
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A planner that commands robot 0 up to a tick and fails when `fails` has just been sent; the
    /// robot is held from a state on.
    fn robots(commanded_to: u64, held_from: u64, end: u64) -> Robots {
        let tick = |number: u64| Tick {
            sent_ns: 1000 + 10 * number,
            robots: [(
                0,
                if number < held_from {
                    Glance::Driven
                } else {
                    Glance::Held
                },
            )]
            .into(),
            commanded: if number <= commanded_to {
                vec![0]
            } else {
                vec![]
            },
        };
        Robots {
            ticks: (0..end).map(|number| (number, tick(number))).collect(),
            tick_period_ns: 50_000_000,
        }
    }

    /// Just after the state of this tick was sent.
    fn after(tick: u64) -> u64 {
        1005 + 10 * tick
    }

    #[test]
    fn a_robot_drives_on_for_as_long_as_its_last_command_is_good() {
        // Failed at tick 10 before it answered; its last command is good for 9 to 14.
        let stopped = robots(9, 16, 30).stopped(after(10), 5).unwrap();
        assert_eq!(stopped.ticks, 5);
        assert!((stopped.after_s - 0.25).abs() < 1e-12, "{stopped:?}");
        // It had still answered: a tick more.
        let stopped = robots(10, 17, 30).stopped(after(10), 5).unwrap();
        assert_eq!(stopped.ticks, 6);
        // In lock-step a robot is held at the tick that nobody answers.
        let stopped = robots(9, 11, 30).stopped(after(10), 0).unwrap();
        assert_eq!((stopped.ticks, stopped.after_s), (0, 0.0));
    }

    #[test]
    fn commands_that_were_on_their_way_count_from_their_tick() {
        let stopped = robots(13, 20, 30).stopped(after(10), 5).unwrap();
        assert_eq!(stopped.ticks, 6);
        assert!((stopped.after_s - 0.45).abs() < 1e-12, "{stopped:?}");
    }

    #[test]
    fn a_robot_that_drives_on_is_told() {
        // 6 are allowed; from 8 on nobody waits for it to stand.
        for (held_from, ticks) in [(18, 7), (19, 8), (u64::MAX, 8)] {
            let stopped = robots(9, held_from, 30).stopped(after(10), 5).unwrap();
            assert_eq!(stopped.ticks, ticks, "{stopped:?}");
        }
    }

    #[test]
    fn nothing_is_said_of_what_the_log_does_not_show() {
        assert_eq!(robots(9, 16, 14).stopped(after(10), 5), None, "ends before");
        assert_eq!(robots(9, 5, 30).stopped(after(10), 5), None, "held before");
        assert_eq!(Robots::default().stopped(after(10), 5), None);
        let mut out = robots(9, 16, 30);
        for (_, tick) in out.ticks.range_mut(12..) {
            tick.robots.insert(0, Glance::Out);
        }
        assert_eq!(out.stopped(after(10), 5), None, "out before");
    }
}
