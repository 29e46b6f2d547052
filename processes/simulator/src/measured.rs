//! Robots outside of the simulation: each is where it was measured last.

use geometry::pose::{Pose2, Twist2};
use ipc_types::bus::{Bus, BusError, ReceiveError, Subscriber};
use ipc_types::messages::robot::MeasuredPose;
use ipc_types::topics::MeasuredPoses;
use sim_backend::world::World;

/// The newest measurements.
#[derive(Debug)]
pub struct Measured {
    input: Subscriber<MeasuredPoses>,
    /// Tick of the newest measurement of each robot that has one.
    newest: Vec<Option<u64>>,
}

impl Measured {
    /// Opens `robot/pose` of a run with this many robots.
    ///
    /// # Errors
    /// As [`Bus::subscriber`].
    pub fn open(bus: &Bus, robots: usize) -> Result<Self, BusError> {
        Ok(Self {
            input: bus.subscriber()?,
            newest: vec![None; robots],
        })
    }

    /// Connects to the publishers.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn connect(&self) -> Result<(), ReceiveError> {
        self.input.update_connections()
    }

    /// Puts the robots where they were measured since the last tick; returns the number of rejected measurements.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn take(&mut self, world: &mut World, tick: u64) -> Result<u64, ReceiveError> {
        let mut rejected = 0;
        while let Some(message) = self.input.receive()? {
            for pose in message.elements() {
                let is_sound = [pose.x, pose.y, pose.theta, pose.v, pose.omega]
                    .iter()
                    .all(|value| value.is_finite());
                match self.newest.get_mut(pose.robot as usize) {
                    Some(newest) if is_sound => {
                        *newest = Some(tick);
                        place(world, pose);
                    }
                    _ => rejected += 1,
                }
            }
        }
        Ok(rejected)
    }

    /// Returns `true` if the newest measurement of a robot is more than `max_age` ticks old.
    pub fn is_lost(&self, robot: usize, tick: u64, max_age: u64) -> bool {
        let newest = self.newest.get(robot).copied().flatten();
        newest.is_some_and(|newest| newest.saturating_add(max_age) < tick)
    }
}

fn place(world: &mut World, measured: &MeasuredPose) {
    let pose = Pose2::new(measured.x, measured.y, measured.theta);
    let twist = Twist2::new(measured.v, measured.omega);
    world.place(measured.robot as usize, pose, twist);
}
