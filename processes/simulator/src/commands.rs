//! Selection of each robot's command: the newest of its driver, while it is fresh.

use geometry::pose::Twist2;
use ipc_types::messages::robot::Command;
use ipc_types::stamp::Stamp;

/// Reasons for which a command is rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// No robot has this index.
    UnknownRobot,
    /// The sender does not drive this robot.
    NotTheDriver,
    /// The command belongs to a future tick.
    FromTheFuture,
    /// A newer command of the robot was accepted before.
    Outdated,
}

#[derive(Debug, Clone, Copy)]
struct CommandEntry {
    stamp: Stamp,
    twist: Twist2,
}

/// Commands in force.
#[derive(Debug)]
pub struct CommandBoard {
    drivers: Vec<Option<u32>>,
    holds: Vec<u64>,
    /// Commands in place of the drivers', each before a tick.
    given: Vec<Option<(Twist2, u64)>>,
    held: Vec<Option<CommandEntry>>,
    in_force: Vec<Option<Twist2>>,
    received_ns: u64,
}

impl CommandBoard {
    /// Returns a board for robots with these drivers (process indices), whose commands count in no tick but their own.
    pub fn new(drivers: Vec<Option<u32>>) -> Self {
        let robots = drivers.len();
        Self {
            drivers,
            holds: vec![0; robots],
            given: vec![None; robots],
            held: vec![None; robots],
            in_force: vec![None; robots],
            received_ns: 0,
        }
    }

    /// Returns the board with commands that count for more ticks, by robot.
    #[must_use]
    pub fn holding(mut self, holds: &[u64]) -> Self {
        self.hold(holds);
        self
    }

    /// Lets commands count for more ticks, by robot.
    pub fn hold(&mut self, holds: &[u64]) {
        for (own, hold) in self.holds.iter_mut().zip(holds) {
            *own = *hold;
        }
    }

    /// Gives a robot a command in place of its driver's, before tick `until`.
    pub fn give(&mut self, robot: usize, twist: Twist2, until: u64) {
        if let Some(given) = self.given.get_mut(robot) {
            *given = Some((twist, until));
        }
    }

    /// Accepts a command that arrived at `now_ns` (monotonic clock) during tick `tick`.
    ///
    /// A non-finite or absurd command is accepted: the world stops the robot and reports it.
    ///
    /// # Errors
    /// [`Refusal`] if the command is rejected.
    pub fn take(
        &mut self,
        stamp: &Stamp,
        command: &Command,
        tick: u64,
        now_ns: u64,
    ) -> Result<(), Refusal> {
        let robot = command.robot as usize;
        let driver = self.drivers.get(robot).ok_or(Refusal::UnknownRobot)?;
        if *driver != Some(stamp.source) {
            return Err(Refusal::NotTheDriver);
        }
        if stamp.tick > tick {
            return Err(Refusal::FromTheFuture);
        }
        let held = &mut self.held[robot];
        if held.is_some_and(|held| held.stamp.tick > stamp.tick) {
            return Err(Refusal::Outdated);
        }
        *held = Some(CommandEntry {
            stamp: *stamp,
            twist: Twist2::new(command.v, command.omega),
        });
        self.received_ns = now_ns;
        Ok(())
    }

    /// Returns the commands in force at tick `tick`: those not older than `max_age` ticks (0 in
    /// lock-step: the command must answer this very state) and those that the robot holds.
    pub fn in_force(&mut self, tick: u64, max_age: u64) -> &[Option<Twist2>] {
        let commands = self.held.iter().zip(&self.holds).zip(&self.given);
        for (force, ((held, hold), given)) in self.in_force.iter_mut().zip(commands) {
            let max_age = max_age.saturating_add(*hold);
            let given = given.filter(|(_, until)| tick < *until);
            *force = given.map(|(twist, _)| twist).or(held
                .filter(|h| h.stamp.tick.saturating_add(max_age) >= tick)
                .map(|h| h.twist));
        }
        &self.in_force
    }

    /// Returns `true` if a robot has a driver but, as of the last [`CommandBoard::in_force`], no
    /// command.
    pub fn is_missing(&self, robot: usize) -> bool {
        self.drivers.get(robot).is_some_and(Option::is_some)
            && self.in_force.get(robot).is_some_and(Option::is_none)
    }

    /// Returns `true` if a robot is stopped because it has no usable command, as of the last
    /// [`CommandBoard::in_force`].
    pub fn is_stopped(&self, robot: usize) -> bool {
        let command = self.in_force.get(robot).copied().flatten();
        self.is_missing(robot) || command.is_some_and(|command| !command.is_command())
    }

    /// Returns the monotonic time at which the last command was accepted (ns).
    pub fn received_ns(&self) -> u64 {
        self.received_ns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command(robot: u32, v: f64) -> Command {
        Command {
            v,
            robot,
            ..Command::default()
        }
    }

    fn stamp(tick: u64, source: u32) -> Stamp {
        Stamp {
            tick,
            source,
            ..Stamp::default()
        }
    }

    #[test]
    fn only_the_driver_commands_and_only_for_ticks_that_have_come() {
        let mut board = CommandBoard::new(vec![Some(3), None]);
        assert_eq!(
            board.take(&stamp(5, 4), &command(0, 1.0), 5, 0),
            Err(Refusal::NotTheDriver)
        );
        assert_eq!(
            board.take(&stamp(5, 3), &command(1, 1.0), 5, 0),
            Err(Refusal::NotTheDriver)
        );
        assert_eq!(
            board.take(&stamp(5, 3), &command(9, 1.0), 5, 0),
            Err(Refusal::UnknownRobot)
        );
        assert_eq!(
            board.take(&stamp(6, 3), &command(0, 1.0), 5, 0),
            Err(Refusal::FromTheFuture)
        );
        assert_eq!(board.in_force(5, 0), [None, None]);
        assert!(board.is_missing(0) && !board.is_missing(1));
        assert_eq!(board.take(&stamp(5, 3), &command(0, 1.0), 5, 77), Ok(()));
        assert_eq!(board.in_force(5, 0), [Some(Twist2::new(1.0, 0.0)), None]);
        assert_eq!(board.received_ns(), 77);
    }

    #[test]
    fn a_robot_with_an_unusable_command_counts_as_stopped() {
        let mut board = CommandBoard::new(vec![Some(3)]);
        let values = [0.5, -1e300, f64::NAN, f64::INFINITY, 0.0, 1e7];
        for (tick, v) in (0..).zip(values) {
            board
                .take(&stamp(tick, 3), &command(0, v), tick, 0)
                .unwrap();
            board.in_force(tick, 0);
            assert_eq!(board.is_stopped(0), v.is_nan() || v.abs() > 1e6, "{v}");
            assert!(!board.is_missing(0));
        }
        board.in_force(99, 0);
        assert!(board.is_missing(0) && board.is_stopped(0));
    }

    #[test]
    fn commands_expire_and_older_ones_never_come_back() {
        let mut board = CommandBoard::new(vec![Some(3)]);
        board.take(&stamp(5, 3), &command(0, 1.0), 5, 0).unwrap();
        assert_eq!(
            board.in_force(6, 0),
            [None],
            "lock-step: a command for the last tick"
        );
        assert!(board.in_force(8, 3)[0].is_some());
        assert_eq!(board.in_force(9, 3), [None], "older than its deadline");
        assert_eq!(
            board.take(&stamp(4, 3), &command(0, 2.0), 9, 0),
            Err(Refusal::Outdated)
        );
    }

    #[test]
    fn a_robot_holds_a_command_until_its_driver_steps_again() {
        let mut board = CommandBoard::new(vec![Some(3), Some(4)]).holding(&[4, 0]);
        for robot in [0, 1] {
            let stamp = stamp(5, 3 + robot);
            board.take(&stamp, &command(robot, 1.0), 5, 0).unwrap();
        }
        let mut stopped = |tick| {
            board.in_force(tick, 0);
            [board.is_stopped(0), board.is_stopped(1)]
        };
        assert_eq!(stopped(5), [false, false]);
        assert_eq!(stopped(9), [false, true]);
        assert_eq!(stopped(10), [true, true]);
    }

    #[test]
    fn a_given_command_replaces_the_drivers_until_its_end() {
        let mut board = CommandBoard::new(vec![Some(3)]);
        board.give(0, Twist2::new(-0.5, 0.1), 7);
        for tick in 5..9 {
            board
                .take(&stamp(tick, 3), &command(0, 1.0), tick, 0)
                .unwrap();
            let twist = if tick < 7 {
                Twist2::new(-0.5, 0.1)
            } else {
                Twist2::new(1.0, 0.0)
            };
            assert_eq!(board.in_force(tick, 0), [Some(twist)], "tick {tick}");
        }
    }

    #[test]
    fn a_stamp_at_the_end_of_time_overflows_nothing() {
        let mut board = CommandBoard::new(vec![Some(3)]);
        let last = stamp(u64::MAX, 3);
        assert_eq!(board.take(&last, &command(0, 1.0), u64::MAX, 0), Ok(()));
        assert!(board.in_force(u64::MAX, 5)[0].is_some());
    }
}
