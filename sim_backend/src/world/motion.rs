//! Motion of all robots through one step, with contact.
//!
//! Contact is continuous: at any speed and step, no robot passes through an obstacle or another
//! robot. Most robots touch nothing in most steps, which one look-up in the clearance field and one
//! distance per pair prove; these robots move to the end of their arc. The others, together, move
//! from event to event. Their arcs become chords, and each chord is driven until the first contact
//! (conservative advancement against obstacles, the root of a quadratic between two discs). A robot
//! in contact keeps the part of its velocity that does not lead into the other body.
//!
//! Two robots in contact are each blocked only by their own motion towards the other: a robot that
//! stands, or drives away, is not pushed.

use geometry::map::WorldMap;
use geometry::math;
use geometry::pose::Twist2;
use nalgebra::{Point2, Vector2};

use super::impact::{Mover, TOUCH, leads_away, slide, sweep, time_to_impact};
use crate::robot::Robot;
use crate::spec::ObstacleResponse;
use robot::drive;

/// Maximum distance (m) between an arc and the chords that replace it near contacts.
const SAGITTA: f64 = 1e-5;
/// Maximum number of chords of an arc: above it the chords are farther from the arc, and contact is
/// still exact along them.
const MAX_CHORDS: f64 = 512.0;

/// Contacts of a robot in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Touch {
    /// An obstacle blocked it during the step, or touches it at the end.
    pub wall: bool,
    /// `true` if it lost part of its motion to a contact.
    pub blocked: bool,
}

/// State of a step, kept between steps only to reuse its memory.
#[derive(Debug, Clone, Default)]
pub struct Motion {
    /// Per robot: its contacts in the last step.
    pub touch: Vec<Touch>,
    /// Pairs (lower index, higher index) that touched in the last step, in ascending order.
    pub pairs: Vec<(usize, usize)>,
    /// Per robot: a way (m) that it and its body can move from its place without a contact with an obstacle.
    room: Vec<f64>,
    /// Per robot: `true` if contact is possible in this step.
    involved: Vec<bool>,
    /// The robots with possible contact.
    movers: Vec<Mover>,
    parts: Vec<u32>,
    normals: Vec<Vector2<f64>>,
    /// `true` if `trace` is recorded.
    traced: bool,
    /// The pieces of the paths with contacts, in order: robot and end of the piece.
    pub trace: Vec<(usize, Point2<f64>)>,
}

impl Motion {
    pub fn new(robots: usize, traced: bool) -> Self {
        Self {
            traced,
            trace: Vec::new(),
            touch: vec![Touch::default(); robots],
            pairs: Vec::with_capacity(robots),
            room: vec![f64::NEG_INFINITY; robots],
            involved: vec![false; robots],
            movers: Vec::with_capacity(robots),
            parts: Vec::with_capacity(64),
            normals: Vec::with_capacity(16),
        }
    }

    /// Forgets the distances from obstacles: the map or a place has changed.
    pub fn forget(&mut self) {
        self.room.fill(f64::NEG_INFINITY);
    }

    /// Moves every robot by its twist for `dt` (s) > 0. `solid` returns `true` for robots with a
    /// body.
    pub fn advance(
        &mut self,
        map: &WorldMap,
        robots: &mut [Robot],
        twists: &[Twist2],
        solid: &[bool],
        dt: f64,
        rule: ObstacleResponse,
    ) {
        self.find_involved(map, robots, twists, solid, dt);
        self.pairs.clear();
        self.movers.clear();
        self.trace.clear();
        for (i, (robot, &twist)) in robots.iter_mut().zip(twists).enumerate() {
            self.touch[i] = Touch::default();
            if self.involved[i] {
                self.movers.push(Mover {
                    robot: i,
                    radius: robot.model.radius,
                    position: robot.pose.position(),
                    desired: Vector2::zeros(),
                    velocity: Vector2::zeros(),
                    path: 0.0,
                });
            } else if twist != Twist2::STOP {
                robot.pose = drive::integrate(robot.pose, twist, dt);
                robot.twist = twist;
                robot.distance_travelled += twist.v.abs() * dt;
            } else {
                robot.twist = Twist2::STOP;
            }
        }
        if !self.movers.is_empty() {
            self.move_with_contact(map, robots, twists, dt, rule);
        }
    }

    /// Marks the robots that could touch something within the step.
    fn find_involved(
        &mut self,
        map: &WorldMap,
        robots: &[Robot],
        twists: &[Twist2],
        solid: &[bool],
        dt: f64,
    ) {
        for (i, robot) in robots.iter().enumerate() {
            let way = twists[i].v.abs() * dt;
            let needed = robot.model.radius + way + TOUCH;
            let room = &mut self.room[i];
            if *room < needed && solid[i] {
                let position = robot.pose.position();
                *room = map.clearance_at_least(position);
                if *room < needed {
                    *room = map.distance(position);
                }
            }
            self.involved[i] = solid[i] && *room < needed;
            // A robot that moves far from obstacles needs no look-up; the rounding of the sum is far below `TOUCH`.
            *room = if self.involved[i] {
                f64::NEG_INFINITY
            } else {
                *room - way - 1e-9
            };
        }
        for i in 1..robots.len() {
            if !solid[i] {
                continue;
            }
            let (a, reach) = (&robots[i], robots[i].model.radius + twists[i].v.abs() * dt);
            for j in 0..i {
                let b = &robots[j];
                let needed = reach + b.model.radius + twists[j].v.abs() * dt + TOUCH;
                let (dx, dy) = (a.pose.x - b.pose.x, a.pose.y - b.pose.y);
                if dx * dx + dy * dy <= needed * needed && solid[j] {
                    self.involved[i] = true;
                    self.involved[j] = true;
                }
            }
        }
    }

    fn move_with_contact(
        &mut self,
        map: &WorldMap,
        robots: &mut [Robot],
        twists: &[Twist2],
        dt: f64,
        rule: ObstacleResponse,
    ) {
        let chords = self.movers.iter().fold(1.0f64, |most, mover| {
            let twist = twists[mover.robot];
            // The sagitta of a chord is about length · angle / 8.
            let sagitta = (twist.v * dt * twist.omega * dt).abs() / 8.0;
            most.max((sagitta / SAGITTA).sqrt().ceil())
        });
        let chords = chords.min(MAX_CHORDS);
        let h = dt / chords;
        for chord in 0..chords as usize {
            for mover in &mut self.movers {
                let (robot, twist) = (&robots[mover.robot], twists[mover.robot]);
                mover.desired = if twist.v == 0.0 || robot.trapped {
                    Vector2::zeros()
                } else {
                    let theta = robot.pose.theta + twist.omega * (h * chord as f64);
                    drive::arc_displacement(theta, twist, h) / h
                };
            }
            self.move_along_chords(map, h, rule);
        }
        self.constrain(map, rule, true);
        for mover in &self.movers {
            let (robot, twist) = (&mut robots[mover.robot], twists[mover.robot]);
            let half_turn = 0.5 * twist.omega * dt;
            if self.touch[mover.robot].blocked {
                let (sin, cos) = math::sincos(robot.pose.theta + half_turn);
                let ahead = (mover.position - robot.pose.position()).dot(&Vector2::new(cos, sin));
                let speed = (ahead / dt).clamp(-twist.v.abs(), twist.v.abs());
                robot.twist = Twist2::new(speed, twist.omega);
                robot.pose.x = mover.position.x;
                robot.pose.y = mover.position.y;
                robot.pose.theta = drive::turned(robot.pose.theta, 2.0 * half_turn);
                robot.distance_travelled += mover.path;
            } else {
                // No contact: exactly the arc, as if no body had been near.
                let twist = if robot.trapped {
                    Twist2::new(0.0, twist.omega)
                } else {
                    twist
                };
                robot.pose = drive::integrate(robot.pose, twist, dt);
                robot.twist = twist;
                robot.distance_travelled += twist.v.abs() * dt;
            }
        }
    }

    /// Drives every mover along its straight desired velocity for `h` (s), from contact to contact.
    fn move_along_chords(&mut self, map: &WorldMap, h: f64, rule: ObstacleResponse) {
        let mut left = h;
        for _ in 0..16 + 4 * self.movers.len() {
            self.constrain(map, rule, false);
            let mut time = left;
            for mover in &self.movers {
                let speed = mover.velocity.norm();
                if speed > 0.0 {
                    let way = sweep(
                        map,
                        mover,
                        mover.velocity / speed,
                        speed * time,
                        &mut self.parts,
                    );
                    if let Some(way) = way {
                        time = time.min(way / speed);
                    }
                }
            }
            for (k, a) in self.movers.iter().enumerate() {
                for b in &self.movers[..k] {
                    time = time.min(time_to_impact(a, b));
                }
            }
            for mover in &mut self.movers {
                mover.position += mover.velocity * time;
                mover.path += mover.velocity.norm() * time;
                if self.traced && mover.velocity != Vector2::zeros() {
                    self.trace.push((mover.robot, mover.position));
                }
            }
            left -= time;
            if left <= 0.0 {
                return;
            }
        }
        // Robots that bounce between each other endlessly: the rest of the chord is dropped, and
        // all of them count as blocked.
        for mover in &self.movers {
            self.touch[mover.robot].blocked = true;
        }
    }

    /// Recomputes each mover's velocity from its current contacts, and records the contacts: those
    /// that block, and at the end of the step all (a robot that just drives away no longer
    /// touches).
    fn constrain(&mut self, map: &WorldMap, rule: ObstacleResponse, end: bool) {
        for k in 0..self.movers.len() {
            let Mover {
                robot,
                radius,
                position,
                desired,
                ..
            } = self.movers[k];
            self.normals.clear();
            if map.clearance_at_least(position) < radius + TOUCH {
                let parts = map.parts_within(position, radius + TOUCH, &mut self.parts);
                let surfaces = parts
                    .iter()
                    .map(|&i| map.parts()[i as usize].contact(position));
                let touching = surfaces
                    .chain(map.edge_contacts(position))
                    .filter(|contact| contact.distance <= radius + TOUCH)
                    .map(|contact| contact.normal);
                self.normals.extend(touching);
                self.touch[robot].wall |=
                    self.normals.iter().any(|n| end || !leads_away(desired, *n));
            }
            for (l, other) in self.movers.iter().enumerate() {
                let offset = position - other.position;
                let reach = radius + other.radius + TOUCH;
                if l != k && offset.norm_squared() <= reach * reach {
                    let distance = offset.norm();
                    let normal = if distance > 0.0 {
                        offset / distance
                    } else {
                        Vector2::x()
                    };
                    self.normals.push(normal);
                    let pair = (robot.min(other.robot), robot.max(other.robot));
                    if (end || !leads_away(desired, normal))
                        && let Err(at) = self.pairs.binary_search(&pair)
                    {
                        self.pairs.insert(at, pair);
                    }
                }
            }
            let allowed = match rule {
                ObstacleResponse::Slide => slide(desired, &self.normals),
                ObstacleResponse::Stop => {
                    let free = self.normals.iter().all(|n| leads_away(desired, *n));
                    if free { desired } else { Vector2::zeros() }
                }
            };
            self.touch[robot].blocked |= allowed != desired;
            self.movers[k].velocity = allowed;
        }
    }
}
