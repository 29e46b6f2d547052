//! The world: robots on a map, under rules, one step at a time.

mod coverage;
mod error;
mod event;
mod impact;
mod motion;
mod obstacles;
mod rules;
mod sense;
mod standstill;
mod start;

pub use coverage::{Coverage, CoverageFigures};
pub use error::WorldError;
pub use event::{ContactWith, EventKind, GameOver, ObstacleAction, WorldEvent};
pub use standstill::STANDSTILL;

use core::time::Duration;

use geometry::map::WorldMap;
use geometry::pose::{Pose2, Twist2};
use geometry::region::Region;
use motion::Motion;
use standstill::Rest;

use crate::random::Stream;
use crate::robot::{Robot, imperfection};
use crate::spec::{OutOfPlay, RulesSpec, WorldSpec};
use robot::drive;
use robot::spec::{ActuatorSpec, OdometrySpec, RobotSpec, ScanSpec};

/// Maximum number of robots in one world.
pub const MAX_ROBOTS: usize = 1024;

/// Robots on a map, under rules.
///
/// ```
/// # use core::time::Duration;
/// # use geometry::map::{MapSpec, VectorMap};
/// # use geometry::pose::{Pose2, Twist2};
/// # use robot::spec::RobotSpec;
/// # use sim_backend::spec::{RulesSpec, WorldSpec};
/// # use robot::team::Role;
/// # use sim_backend::world::World;
/// let mut world = World::new(WorldSpec {
///     map: MapSpec::Vector(VectorMap::empty([0.0, 0.0], [4.0, 3.0], 0.05)),
///     robots: vec![RobotSpec::new("walle", Role::Neutral, Pose2::new(1.0, 1.5, 0.0))],
///     rules: RulesSpec::default(),
///     seed: 1,
/// })?;
/// for _ in 0..20 {
///     world.step(&[Some(Twist2::new(0.2, 0.0))], Duration::from_millis(50));
/// }
/// assert!((world.robots()[0].pose.x - 1.2).abs() < 1e-12);
/// # Ok::<(), sim_backend::world::WorldError>(())
/// ```
#[derive(Debug, Clone)]
pub struct World {
    map: WorldMap,
    rules: RulesSpec,
    /// Exits of the map, then of the rules.
    exits: Vec<Region>,
    seed: u64,
    robots: Vec<Robot>,
    extras: Vec<Extra>,
    time: Duration,
    tick: u64,
    over: Option<GameOver>,
    coverage: Option<Box<Coverage>>,
    events: Vec<WorldEvent>,
    /// Events between steps, delivered by the next step unless they are taken before.
    pending: Vec<EventKind>,
    // Memory of one step, reused so that steps do not allocate.
    motion: Motion,
    twists: Vec<Twist2>,
    solid: Vec<bool>,
    /// Pairs in contact before the step.
    pairs_before: Vec<(usize, usize)>,
}

/// Internal state of a robot, besides its public state.
#[derive(Debug, Clone)]
struct Extra {
    actuator: Option<ActuatorSpec>,
    scan: Option<ScanSpec>,
    odometry: Option<OdometrySpec>,
    /// Pose by its odometry.
    odometry_pose: Pose2,
    /// Velocity of a robot outside of the simulation, as it was measured last.
    measured: Option<Twist2>,
    /// `true` if its last command was invalid.
    invalid_command: bool,
    /// Time for which hostile pursuers have been within the capture radius.
    held: Duration,
    rest: Rest,
}

/// Purposes of random streams; a robot's stream is its index times their number, plus this.
#[derive(Debug, Clone, Copy)]
enum Purpose {
    Actuator = 0,
    Scan = 1,
    Odometry = 2,
}

impl World {
    /// Creates the world of a specification, at time 0.
    ///
    /// # Errors
    /// The error names the field, its value and the expected one: an unreadable map, a value out of its
    /// range, no robots, robots that overlap, are in a wall or outside the map, an exit or goal without a
    /// path to it.
    pub fn new(spec: WorldSpec) -> Result<Self, WorldError> {
        let map = WorldMap::recent(&spec.map)?;
        Self::on_map(WorldMap::clone(&map), spec)
    }

    /// The same on a map that was loaded before (`spec.map` is not read).
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn on_map(map: WorldMap, spec: WorldSpec) -> Result<Self, WorldError> {
        start::check_specs(&spec.robots, &spec.rules)?;
        let teams = RobotSpec::teams(&spec.robots);
        let robots = spec.robots.iter().zip(teams);
        let robots: Vec<Robot> = robots.map(|(spec, team)| Robot::new(spec, team)).collect();
        let exits: Vec<Region> = map
            .exits()
            .iter()
            .chain(&spec.rules.exits)
            .copied()
            .collect();
        start::check_places(&map, &robots, &exits)?;
        let extras = spec
            .robots
            .iter()
            .zip(&robots)
            .map(|(spec, robot)| Extra {
                actuator: (!spec.actuator.is_perfect()).then_some(spec.actuator),
                scan: spec.scan,
                odometry: spec.odometry,
                odometry_pose: robot.pose,
                measured: None,
                invalid_command: false,
                held: Duration::ZERO,
                rest: Rest::new(robot.pose.position()),
            })
            .collect();
        let coverage = match &spec.rules.coverage {
            Some(rule) => Some(Coverage::new(rule, &map, &robots).map_err(WorldError::Rules)?),
            None => None,
        };
        let n = robots.len();
        Ok(Self {
            map,
            rules: spec.rules,
            exits,
            seed: spec.seed,
            robots,
            extras,
            time: Duration::ZERO,
            tick: 0,
            over: None,
            motion: Motion::new(n, coverage.is_some()),
            coverage: coverage.map(Box::new),
            events: Vec::with_capacity(4 * n + 4),
            pending: Vec::new(),
            twists: vec![Twist2::STOP; n],
            solid: vec![true; n],
            pairs_before: Vec::with_capacity(n),
        })
    }

    /// Continues by another specification with the same map, robots, starts, goals, exits and accounting of the visited area:
    /// its limits, imperfections, sensors, rules and seed count from now on.
    ///
    /// # Errors
    /// As [`Self::new`], for a value out of its range.
    pub fn continue_by(&mut self, spec: &WorldSpec) -> Result<(), WorldError> {
        start::check_specs(&spec.robots, &spec.rules)?;
        let robots = self.robots.iter_mut().zip(&mut self.extras);
        for ((robot, extra), spec) in robots.zip(&spec.robots) {
            robot.model = spec.model();
            extra.actuator = (!spec.actuator.is_perfect()).then_some(spec.actuator);
            extra.scan = spec.scan;
            extra.odometry = spec.odometry;
        }
        self.rules.clone_from(&spec.rules);
        self.seed = spec.seed;
        Ok(())
    }

    /// Advances the world by `dt`: robots execute their commands, then sensors and rules are updated, in
    /// a fixed order.
    ///
    /// Command *i* is for robot *i*. A missing command stops the robot; one that is not finite stops it
    /// and is reported; one beyond its limits is clamped. Robots out of the game ignore commands.
    /// Captures, exits, goals, standstills and the time limit are decided, in this order, on the poses at
    /// the end of the step.
    ///
    /// Returns the events in the order of decision. The result is a function of the specification and the
    /// commands so far; a step allocates only if it has more events than any before.
    pub fn step(&mut self, commands: &[Option<Twist2>], dt: Duration) -> &[WorldEvent] {
        self.events.clear();
        while !self.pending.is_empty() {
            let kind = self.pending.remove(0);
            self.emit(kind);
        }
        self.tick += 1;
        self.time = self.time.saturating_add(dt);
        let seconds = dt.as_secs_f64();
        if seconds > 0.0 {
            self.execute_commands(commands, seconds);
            self.update_solid();
            if let Some(coverage) = &mut self.coverage {
                coverage.begin(&self.robots);
            }
            core::mem::swap(&mut self.pairs_before, &mut self.motion.pairs);
            self.motion.advance(
                &self.map,
                &mut self.robots,
                &self.twists,
                &self.solid,
                seconds,
                self.rules.blocked,
            );
            for (robot, extra) in self.robots.iter_mut().zip(&self.extras) {
                robot.twist = extra.measured.unwrap_or(robot.twist);
            }
            if let Some(coverage) = &mut self.coverage {
                coverage.end(&self.robots, &self.motion, seconds, self.tick, self.time);
            }
            self.report_contacts();
            self.update_odometry(seconds);
        }
        self.apply_rules(dt);
        &self.events
    }

    /// Takes the events since the last step (changed obstacles, pushed robots) for delivery before the
    /// next step; that step does not deliver them again.
    pub fn take_pending(&mut self) -> impl Iterator<Item = EventKind> + '_ {
        self.pending.drain(..)
    }

    /// Moves robots of the game to poses at once; their velocities stay, and no way is driven. Sensors and rules of the next
    /// step see them there. An unknown index is ignored.
    ///
    /// # Errors
    /// [`WorldError`]: one is outside the map, in an obstacle or in another robot there, or has left the game. The world stays
    /// as it was.
    pub fn shift(&mut self, places: &[(usize, Pose2)]) -> Result<(), WorldError> {
        let mut robots = self.robots.clone();
        for &(index, pose) in places {
            if let Some(robot) = robots.get_mut(index) {
                robot.pose = pose;
            }
        }
        for &(index, _) in places {
            let Some(robot) = robots.get(index) else {
                continue;
            };
            if !robot.is_active() {
                let name = robot.name.clone();
                return Err(WorldError::LeftTheGame { index, name });
            }
            start::check_place(&self.map, &robots, index, |other| {
                other != index && has_body(&robots[other], &self.rules)
            })?;
        }
        self.robots = robots;
        self.motion.forget();
        Ok(())
    }

    /// Puts a robot outside of the simulation where it was measured, with its velocity. From then on it moves by such calls
    /// alone, not by its commands; sensors and rules of the next step see it there. An unknown index is ignored.
    pub fn place(&mut self, robot: usize, pose: Pose2, twist: Twist2) {
        if let (Some(robot), Some(extra)) = (self.robots.get_mut(robot), self.extras.get_mut(robot))
        {
            let way = (pose.position() - robot.pose.position()).norm();
            robot.distance_travelled += way;
            robot.pose = pose;
            robot.twist = twist;
            extra.measured = Some(twist);
            self.motion.forget();
        }
    }

    /// Computes the motion of each drive in this step.
    fn execute_commands(&mut self, commands: &[Option<Twist2>], dt: f64) {
        for i in 0..self.robots.len() {
            let (robot, extra) = (&mut self.robots[i], &mut self.extras[i]);
            if !robot.is_active() || extra.measured.is_some() {
                self.twists[i] = Twist2::STOP;
                continue;
            }
            let mut command = commands.get(i).copied().flatten().unwrap_or(Twist2::STOP);
            let invalid = !command.is_command();
            let first_invalid = invalid && !extra.invalid_command;
            extra.invalid_command = invalid;
            if invalid {
                command = Twist2::STOP;
                robot.invalid_commands += 1;
            }
            let mut twist = drive::limit(&robot.model, robot.twist, command, dt);
            if let Some(actuator) = &extra.actuator {
                let stream = stream_number(i, Purpose::Actuator);
                let mut noise = Stream::new(self.seed, stream, self.tick);
                twist = imperfection::perturb(&robot.model, actuator, twist, &mut noise);
            }
            self.twists[i] = twist;
            if first_invalid {
                self.emit(EventKind::InvalidCommand { robot: i });
            }
        }
    }

    fn update_solid(&mut self) {
        for (solid, robot) in self.solid.iter_mut().zip(&self.robots) {
            *solid = has_body(robot, &self.rules);
        }
    }

    /// Counts contacts and reports those that began or ended.
    fn report_contacts(&mut self) {
        for i in 0..self.robots.len() {
            let (before, now) = (self.robots[i].touches_wall, self.motion.touch[i].wall);
            let robot = &mut self.robots[i];
            robot.touches_wall = now;
            robot.contacts.wall_ticks += u64::from(now);
            robot.contacts.wall += u32::from(now && !before);
            if now != before {
                self.emit_contact(now, i, ContactWith::Wall);
            }
        }
        if self.pairs_before.is_empty() && self.motion.pairs.is_empty() {
            return;
        }
        for k in 0..self.pairs_before.len() {
            let (a, b) = self.pairs_before[k];
            if self.motion.pairs.binary_search(&(a, b)).is_err() {
                self.emit_contact(false, a, ContactWith::Robot(b));
            }
        }
        for k in 0..self.motion.pairs.len() {
            let (a, b) = self.motion.pairs[k];
            if self.pairs_before.binary_search(&(a, b)).is_err() {
                self.robots[a].contacts.robot += 1;
                self.robots[b].contacts.robot += 1;
                self.emit_contact(true, a, ContactWith::Robot(b));
            }
        }
        for (i, robot) in self.robots.iter_mut().enumerate() {
            let touches = self.motion.pairs.iter().any(|&(a, b)| a == i || b == i);
            robot.contacts.robot_ticks += u64::from(touches);
        }
    }

    fn emit_contact(&mut self, began: bool, robot: usize, with: ContactWith) {
        self.emit(if began {
            EventKind::ContactBegan { robot, with }
        } else {
            EventKind::ContactEnded { robot, with }
        });
    }

    fn emit(&mut self, kind: EventKind) {
        self.events.push(WorldEvent {
            time: self.time,
            tick: self.tick,
            kind,
        });
    }

    /// Returns `true` if a robot's body is in the world, in play or not; `false` for an unknown index.
    pub fn is_present(&self, robot: usize) -> bool {
        self.robots
            .get(robot)
            .is_some_and(|robot| has_body(robot, &self.rules))
    }

    /// The robots, in the order of the specification.
    pub fn robots(&self) -> &[Robot] {
        &self.robots
    }

    /// The current map.
    pub fn map(&self) -> &WorldMap {
        &self.map
    }

    /// The rules.
    pub fn rules(&self) -> &RulesSpec {
        &self.rules
    }

    /// The visited area, if the rules include its accounting.
    pub fn coverage(&self) -> Option<&Coverage> {
        self.coverage.as_deref()
    }

    /// All exits: the map's, then those of the rules.
    pub fn exits(&self) -> &[Region] {
        &self.exits
    }

    /// Simulated time since the start, to the nanosecond.
    pub fn time(&self) -> Duration {
        self.time
    }

    /// Number of steps taken.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// The events of the last step.
    pub fn events(&self) -> &[WorldEvent] {
        &self.events
    }

    /// Returns `true` if the mission has ended. Further steps are allowed and do not change that.
    pub fn is_over(&self) -> bool {
        self.over.is_some()
    }

    /// Reason for the end of the mission.
    pub fn game_over(&self) -> Option<GameOver> {
        self.over
    }
}

fn stream_number(robot: usize, purpose: Purpose) -> u64 {
    robot as u64 * 4 + purpose as u64
}

/// Returns `true` if other robots can hit a robot's body.
fn has_body(robot: &Robot, rules: &RulesSpec) -> bool {
    use crate::robot::RobotStatus::{Active, Arrived, Caught, Escaped, TimedOut};
    match robot.status {
        Active | Arrived | TimedOut => true,
        Caught => rules.caught == OutOfPlay::Stay,
        Escaped => rules.escaped == OutOfPlay::Stay,
    }
}

#[cfg(test)]
mod tests;
