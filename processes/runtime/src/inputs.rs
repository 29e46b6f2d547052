//! Last messages of the topics that planners read, checked as untrusted input.

use std::any::Any;
use std::sync::Arc;

use geometry::shape::{Aabb, Convex};
use ipc_types::bus::{Bus, BusError, ReceiveError, ReceivedMessage, Subscriber};
use ipc_types::clock::StampClock;
use ipc_types::messages::perception::{BeliefHeader, Particle};
use ipc_types::messages::robot::ScanHeader;
use ipc_types::messages::world::{MapCell, MapHeader, RobotState, ShapesHeader, WorldHeader};
use ipc_types::topics::{Belief, Scan, Topic, WorldMap, WorldShapes, WorldState};

use crate::config::Clock;
use crate::error::ProcessError;
use crate::maps::Maps;
use crate::shapes;

/// The newest state of the world.
#[derive(Debug)]
pub struct StateInput {
    subscriber: Subscriber<WorldState>,
    clock: StampClock,
    robots_expected: usize,
    /// Header of the newest state.
    pub header: WorldHeader,
    /// Robots of the newest state, in the order of their index.
    pub robots: Vec<RobotState>,
    /// Monotonic clock at the receipt of the newest state (ns).
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
            clock: bus.clock(),
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

    /// Receives all pending messages; returns `true` if there is a newer state than before.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn update(&mut self) -> Result<bool, ReceiveError> {
        self.update_until(|_| false)
    }

    /// Receives messages until the newest state is that of tick `tick`. In lock-step no message
    /// follows it, so this saves a receive call.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn update_to(&mut self, tick: u64) -> Result<bool, ReceiveError> {
        self.update_until(|newest| newest == tick)
    }

    /// Receives the state for tick `tick`: exactly its own in lock-step, the newest in real time and over a link.
    ///
    /// # Errors
    /// [`ProcessError::Protocol`] if in lock-step and without a link the newest valid state is of another tick;
    /// [`ProcessError`] if the transport fails.
    pub fn take_turn(&mut self, tick: u64, clock: Clock) -> Result<(), ProcessError> {
        if clock != Clock::LockStep {
            self.update()?;
            return Ok(());
        }
        self.update_to(tick)?;
        let newest = self.header.stamp.tick;
        if newest != tick && !self.subscriber.may_be_late() {
            return Err(ProcessError::Protocol(format!(
                "it is the turn of tick {tick}, but the newest world/state is of tick {newest}"
            )));
        }
        Ok(())
    }

    fn update_until(&mut self, enough: impl Fn(u64) -> bool) -> Result<bool, ReceiveError> {
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
                self.received_ns = self.clock.now_ns();
                newer = true;
                if enough(self.header.stamp.tick) {
                    break;
                }
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
    /// The newest map, in the sender's memory: only derived data is copied.
    newest: Option<ReceivedMessage<WorldMap>>,
    maps: Option<Arc<Maps>>,
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
            newest: None,
            maps: None,
            rejected: 0,
        })
    }

    /// Shares maps with the other processes of this thread; call it before the first map.
    pub fn share(&mut self, maps: &Arc<Maps>) {
        self.maps = Some(Arc::clone(maps));
    }

    /// Connects to the simulator.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn connect(&self) -> Result<(), ReceiveError> {
        self.subscriber.update_connections()
    }

    /// Cells of the newest map.
    pub fn cells(&self) -> &[MapCell] {
        self.newest.as_ref().map_or(&[], ReceivedMessage::elements)
    }

    /// Returns the value of type `T` that processes of this thread store with the cells of the
    /// newest map; the first call creates the default. `None` if they share no maps.
    pub fn derived<T: Any + Default + Send + Sync>(&self) -> Option<Arc<T>> {
        let shared = self.newest.as_ref().and_then(ReceivedMessage::shared)?;
        self.maps.as_ref()?.derived(shared)
    }

    /// Returns `true` if the cells of a message are valid; cells that processes of this thread
    /// share are checked once.
    fn is_sound(&self, message: &ReceivedMessage<WorldMap>) -> bool {
        let shared = self.maps.as_ref().zip(message.shared());
        if shared.is_some_and(|(maps, cells)| maps.is_checked(cells)) {
            return true;
        }
        let is_sound = message
            .elements()
            .iter()
            .all(|c| c.clearance.is_finite() && c.blurred.is_finite());
        if is_sound && let Some((maps, cells)) = shared {
            maps.mark_checked(cells);
        }
        is_sound
    }

    /// Returns `true` if processes of this thread share their maps.
    pub fn is_shared(&self) -> bool {
        self.maps.is_some()
    }

    /// Receives all pending messages; returns `true` if there is a newer map than before.
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
                && self.is_sound(&message);
            if sound {
                self.header = *header;
                self.newest = Some(message);
                newer = true;
            } else {
                self.rejected += 1;
            }
        }
        Ok(newer)
    }
}

/// The exact pieces of the newest map.
#[derive(Debug)]
pub struct ShapesInput {
    subscriber: Subscriber<WorldShapes>,
    /// Header of the newest shapes.
    pub header: ShapesHeader,
    /// Bounds of the world and its pieces; `None` before the first message, and if the pieces
    /// exceed the capacity of a message.
    pub pieces: Option<(Aabb, Vec<Convex>)>,
    /// Messages that failed the checks.
    pub rejected: u64,
}

impl ShapesInput {
    /// Opens `world/shapes`.
    ///
    /// # Errors
    /// As [`Bus::subscriber`].
    pub fn open(bus: &Bus) -> Result<Self, BusError> {
        Ok(Self {
            subscriber: bus.subscriber()?,
            header: ShapesHeader::default(),
            pieces: None,
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

    /// Receives all pending messages; returns `true` if there are newer shapes than before.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn update(&mut self) -> Result<bool, ReceiveError> {
        let mut newer = false;
        while let Some(message) = self.subscriber.receive()? {
            let header = message.header();
            let pieces = shapes::from_message(header, message.elements());
            match pieces {
                Ok(pieces) if header.revision > self.header.revision => {
                    self.header = *header;
                    self.pieces = (header.complete == 1).then_some(pieces);
                    newer = true;
                }
                Ok(_) => self.rejected += 1,
                Err(error) => {
                    tracing::warn!("world/shapes rejected: {error}");
                    self.rejected += 1;
                }
            }
        }
        Ok(newer)
    }
}

/// Topic with messages per robot, and the validity of such a message.
pub trait PerRobot: Topic {
    /// Returns the robot of a message.
    fn robot(header: &Self::Header) -> u32;

    /// Returns `true` if a planner can compute with the message.
    fn is_sound(header: &Self::Header, elements: &[Self::Element]) -> bool;
}

impl PerRobot for Belief {
    fn robot(header: &BeliefHeader) -> u32 {
        header.robot
    }

    fn is_sound(header: &BeliefHeader, particles: &[Particle]) -> bool {
        [header.mean_x, header.mean_y, header.mean_theta]
            .iter()
            .all(|v| v.is_finite())
            && particles.iter().fold(true, |is_sound, p| {
                // Without branches: every planner checks all particles in every tick, with them in 4 % of the time of `chase`.
                let [x, y, theta, weight] = [p.x, p.y, p.theta, p.weight].map(f32::is_finite);
                let is_share = p.weight >= 0.0;
                is_sound & x & y & theta & weight & is_share
            })
    }
}

impl PerRobot for Scan {
    fn robot(header: &ScanHeader) -> u32 {
        header.robot
    }

    fn is_sound(header: &ScanHeader, ranges: &[f32]) -> bool {
        [header.angle_min, header.angle_increment, header.range_max]
            .iter()
            .all(|v| v.is_finite())
            && header.range_max > 0.0
            && ranges.iter().all(|range| !range.is_nan())
    }
}

/// Last message about one robot.
#[derive(Debug, Clone)]
pub struct Latest<T: Topic> {
    /// Its header.
    pub header: T::Header,
    /// Its elements.
    pub elements: Vec<T::Element>,
}

/// Newest message about every robot.
#[derive(Debug)]
pub struct RobotInput<T: Topic> {
    subscriber: Subscriber<T>,
    clock: StampClock,
    robots: usize,
    /// Newest messages, sorted by their robots.
    pub latest: Vec<Latest<T>>,
    /// Monotonic clock at the receipt of the newest message (ns).
    pub received_ns: u64,
    /// Messages that failed the checks.
    pub rejected: u64,
}

/// Beliefs about the opponents.
pub type BeliefInput = RobotInput<Belief>;
/// Range scans; ranges (m) are +∞ where nothing was hit, −∞ where it was too near (REP-117).
pub type ScanInput = RobotInput<Scan>;

impl<T: PerRobot> RobotInput<T> {
    /// Opens the topic in a run with this many robots.
    ///
    /// # Errors
    /// As [`Bus::subscriber`].
    pub fn open(bus: &Bus, robots: usize) -> Result<Self, BusError> {
        let subscriber = bus.subscriber()?;
        Ok(Self {
            subscriber,
            clock: bus.clock(),
            robots,
            latest: Vec::new(),
            received_ns: 0,
            rejected: 0,
        })
    }

    /// Connects to the publishers.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn connect(&self) -> Result<(), ReceiveError> {
        self.subscriber.update_connections()
    }

    /// Receives all pending messages.
    ///
    /// # Errors
    /// [`ReceiveError`] if the transport fails.
    pub fn update(&mut self) -> Result<(), ReceiveError> {
        while let Some(message) = self.subscriber.receive()? {
            let (header, elements) = (message.header(), message.elements());
            let robot = T::robot(header);
            if robot as usize >= self.robots || !T::is_sound(header, elements) {
                self.rejected += 1;
                continue;
            }
            self.received_ns = self.clock.now_ns();
            match self
                .latest
                .binary_search_by_key(&robot, |latest| T::robot(&latest.header))
            {
                Ok(at) => {
                    let latest = &mut self.latest[at];
                    latest.header = *header;
                    latest.elements.clear();
                    latest.elements.extend_from_slice(elements);
                }
                Err(at) => {
                    let latest = Latest {
                        header: *header,
                        elements: elements.to_vec(),
                    };
                    self.latest.insert(at, latest);
                }
            }
        }
        Ok(())
    }

    /// The newest message about a robot.
    pub fn latest(&self, robot: u32) -> Option<&Latest<T>> {
        let at = self
            .latest
            .binary_search_by_key(&robot, |latest| T::robot(&latest.header))
            .ok()?;
        self.latest.get(at)
    }
}

/// Returns the stamp of an output that answers the given state.
pub fn reply_stamp(state: &WorldHeader, received_ns: u64) -> ipc_types::stamp::Stamp {
    ipc_types::stamp::Stamp {
        tick: state.stamp.tick,
        time_ns: state.stamp.time_ns,
        origin_ns: state.stamp.origin_ns,
        received_ns,
        ..ipc_types::stamp::Stamp::default()
    }
}
