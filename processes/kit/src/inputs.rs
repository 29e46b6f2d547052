//! The last messages of the topics that planners read, checked as if their senders were hostile.

use ipc_types::bus::{Bus, BusError, ReceiveError, Subscriber};
use ipc_types::clock;
use ipc_types::messages::perception::{BeliefHeader, Particle};
use ipc_types::messages::robot::ScanHeader;
use ipc_types::messages::world::{MapCell, MapHeader, RobotState, WorldHeader};
use ipc_types::topics::{Belief, Scan, WorldMap, WorldState};

/// The newest state of the world.
#[derive(Debug)]
pub struct StateInput {
    subscriber: Subscriber<WorldState>,
    robots_expected: usize,
    /// Header of the newest state.
    pub header: WorldHeader,
    /// Robots of the newest state, in the order of their index.
    pub robots: Vec<RobotState>,
    /// Monotonic clock when the newest state was taken up [ns].
    pub received_ns: u64,
    /// States that failed the checks.
    pub rejected: u64,
}

impl StateInput {
    /// Opens `world/state` of a run with this many robots.
    ///
    /// # Errors
    /// As [`Bus::subscriber`].
    pub fn open(bus: &Bus, robots_expected: usize) -> Result<Self, BusError> {
        Ok(Self {
            subscriber: bus.subscriber()?,
            robots_expected,
            header: WorldHeader::default(),
            robots: Vec::with_capacity(robots_expected),
            received_ns: 0,
            rejected: 0,
        })
    }

    /// Connects to the simulator.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn connect(&self) -> Result<(), ReceiveError> {
        self.subscriber.update_connections()
    }

    /// Takes up everything that came; true if there is a newer state than before.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn update(&mut self) -> Result<bool, ReceiveError> {
        let mut newer = false;
        while let Some(message) = self.subscriber.receive()? {
            let robots = message.elements();
            let sound = robots.len() == self.robots_expected
                && robots.iter().enumerate().all(|(i, r)| {
                    r.robot as usize == i
                        && [r.x, r.y, r.theta, r.v, r.omega]
                            .iter()
                            .all(|v| v.is_finite())
                });
            if sound {
                self.header = *message.header();
                self.robots.clear();
                self.robots.extend_from_slice(robots);
                self.received_ns = clock::monotonic_ns();
                newer = true;
            } else {
                self.rejected += 1;
            }
        }
        Ok(newer)
    }
}

/// The newest map.
#[derive(Debug)]
pub struct MapInput {
    subscriber: Subscriber<WorldMap>,
    /// Header of the newest map.
    pub header: MapHeader,
    /// Cells of the newest map.
    pub cells: Vec<MapCell>,
    /// Maps that failed the checks.
    pub rejected: u64,
}

impl MapInput {
    /// Opens `world/map`.
    ///
    /// # Errors
    /// As [`Bus::subscriber`].
    pub fn open(bus: &Bus) -> Result<Self, BusError> {
        Ok(Self {
            subscriber: bus.subscriber()?,
            header: MapHeader::default(),
            cells: Vec::new(),
            rejected: 0,
        })
    }

    /// Connects to the simulator.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn connect(&self) -> Result<(), ReceiveError> {
        self.subscriber.update_connections()
    }

    /// Takes up everything that came; true if there is a newer map than before.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn update(&mut self) -> Result<bool, ReceiveError> {
        let mut newer = false;
        while let Some(message) = self.subscriber.receive()? {
            let header = message.header();
            let cells = message.elements();
            let sound = u64::from(header.width) * u64::from(header.height) == cells.len() as u64
                && !cells.is_empty()
                && header.resolution.is_finite()
                && header.resolution > 0.0
                && header.origin_x.is_finite()
                && header.origin_y.is_finite()
                && header.revision > self.header.revision
                && cells
                    .iter()
                    .all(|c| c.clearance.is_finite() && c.blurred.is_finite());
            if sound {
                self.header = *header;
                self.cells.clear();
                self.cells.extend_from_slice(cells);
                newer = true;
            } else {
                self.rejected += 1;
            }
        }
        Ok(newer)
    }
}

/// One robot's belief as last received.
#[derive(Debug, Clone, Default)]
pub struct BeliefState {
    /// Moments.
    pub header: BeliefHeader,
    /// Particles.
    pub particles: Vec<Particle>,
}

/// The newest belief about every opponent.
#[derive(Debug)]
pub struct BeliefInput {
    subscriber: Subscriber<Belief>,
    robots: usize,
    /// Newest beliefs, sorted by the robot they are about.
    pub beliefs: Vec<BeliefState>,
    /// Monotonic clock when the newest belief was taken up [ns].
    pub received_ns: u64,
    /// Beliefs that failed the checks.
    pub rejected: u64,
}

impl BeliefInput {
    /// Opens `perception/belief` of a run with this many robots.
    ///
    /// # Errors
    /// As [`Bus::subscriber`].
    pub fn open(bus: &Bus, robots: usize) -> Result<Self, BusError> {
        Ok(Self {
            subscriber: bus.subscriber()?,
            robots,
            beliefs: Vec::new(),
            received_ns: 0,
            rejected: 0,
        })
    }

    /// Connects to perception.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn connect(&self) -> Result<(), ReceiveError> {
        self.subscriber.update_connections()
    }

    /// Takes up everything that came.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn update(&mut self) -> Result<(), ReceiveError> {
        while let Some(message) = self.subscriber.receive()? {
            let header = message.header();
            let sound = (header.robot as usize) < self.robots
                && [header.mean_x, header.mean_y, header.mean_theta]
                    .iter()
                    .all(|v| v.is_finite())
                && message.elements().iter().all(|p| {
                    p.x.is_finite()
                        && p.y.is_finite()
                        && p.theta.is_finite()
                        && p.weight.is_finite()
                        && p.weight >= 0.0
                });
            if !sound {
                self.rejected += 1;
                continue;
            }
            self.received_ns = clock::monotonic_ns();
            let at = self
                .beliefs
                .binary_search_by_key(&header.robot, |b| b.header.robot);
            let belief = match at {
                Ok(i) => &mut self.beliefs[i],
                Err(i) => {
                    self.beliefs.insert(i, BeliefState::default());
                    &mut self.beliefs[i]
                }
            };
            belief.header = *header;
            belief.particles.clear();
            belief.particles.extend_from_slice(message.elements());
        }
        Ok(())
    }
}

/// One robot's scan as last received.
#[derive(Debug, Clone, Default)]
pub struct ScanState {
    /// Geometry of the scan.
    pub header: ScanHeader,
    /// Ranges [m]: +∞ where nothing was hit, −∞ where it was too near (REP-117); never NaN.
    pub ranges: Vec<f32>,
}

/// The newest scan of every robot that has a sensor.
#[derive(Debug)]
pub struct ScanInput {
    subscriber: Subscriber<Scan>,
    robots: usize,
    /// Newest scans, sorted by robot.
    pub scans: Vec<ScanState>,
    /// Monotonic clock when the newest scan was taken up [ns].
    pub received_ns: u64,
    /// Scans that failed the checks.
    pub rejected: u64,
}

impl ScanInput {
    /// Opens `robot/scan` of a run with this many robots.
    ///
    /// # Errors
    /// As [`Bus::subscriber`].
    pub fn open(bus: &Bus, robots: usize) -> Result<Self, BusError> {
        Ok(Self {
            subscriber: bus.subscriber()?,
            robots,
            scans: Vec::new(),
            received_ns: 0,
            rejected: 0,
        })
    }

    /// Connects to the simulator.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn connect(&self) -> Result<(), ReceiveError> {
        self.subscriber.update_connections()
    }

    /// Takes up everything that came.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn update(&mut self) -> Result<(), ReceiveError> {
        while let Some(message) = self.subscriber.receive()? {
            let header = message.header();
            let sound = (header.robot as usize) < self.robots
                && header.angle_min.is_finite()
                && header.angle_increment.is_finite()
                && header.range_max.is_finite()
                && header.range_max > 0.0
                && message.elements().iter().all(|r| !r.is_nan());
            if !sound {
                self.rejected += 1;
                continue;
            }
            self.received_ns = clock::monotonic_ns();
            let at = self
                .scans
                .binary_search_by_key(&header.robot, |s| s.header.robot);
            let scan = match at {
                Ok(i) => &mut self.scans[i],
                Err(i) => {
                    self.scans.insert(i, ScanState::default());
                    &mut self.scans[i]
                }
            };
            scan.header = *header;
            scan.ranges.clear();
            scan.ranges.extend_from_slice(message.elements());
        }
        Ok(())
    }

    /// The newest scan of a robot.
    pub fn of(&self, robot: u32) -> Option<&ScanState> {
        let at = self
            .scans
            .binary_search_by_key(&robot, |s| s.header.robot)
            .ok()?;
        self.scans.get(at)
    }
}

/// What a message of this topic answers to: the stamp of an output for the given state.
pub fn reply_stamp(state: &WorldHeader, received_ns: u64) -> ipc_types::stamp::Stamp {
    ipc_types::stamp::Stamp {
        tick: state.stamp.tick,
        time_ns: state.stamp.time_ns,
        origin_ns: state.stamp.origin_ns,
        received_ns,
        ..ipc_types::stamp::Stamp::default()
    }
}
