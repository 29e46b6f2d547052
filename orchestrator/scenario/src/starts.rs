//! Starts drawn from the seed: displaced, or anywhere in free space.

use core::f64::consts::{FRAC_1_SQRT_2, PI, TAU};
use std::sync::Arc;

use geometry::map::{Passages, WorldMap};
use geometry::math;
use geometry::pose::Pose2;
use geometry::region::Region;
use nalgebra::Point2;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use robot::spec::RobotSpec;
use robot::team::{Role, Team};
use sim_backend::spec::RulesSpec;

pub use self::no_start::NoStart;
use self::no_start::{Fault, MAX_DRAWS};
use super::spec::{Distribution, RandomStart, StartJitter};

mod no_start;

/// Domain of the start jitter, which separates it from other uses of the run's seed.
const JITTER_DOMAIN: u64 = 0x7374_6172_745f_6a69;
/// Domain of random starts, as above.
const RANDOM_DOMAIN: u64 = 0x7374_6172_745f_7261;

/// Way in which a start varies with the seed.
#[derive(Debug, Clone, Copy)]
pub enum Draw {
    /// Displaced from the start of the scenario.
    Jitter(StartJitter),
    /// Anywhere in free space.
    Random(RandomStart),
}

impl Draw {
    /// Returns the key that sets it.
    pub fn key(&self) -> &'static str {
        match self {
            Self::Jitter(_) => "start_jitter",
            Self::Random(_) => "random_start",
        }
    }
}

/// A robot to be placed.
#[derive(Debug, Clone, Copy)]
pub struct Placement {
    /// Start of the scenario; of no effect for a random start.
    pub start: Pose2,
    /// Radius of the body (m).
    pub radius: f64,
    /// Team.
    pub team: Team,
    /// Region that it must be able to reach, if any.
    pub goal: Option<Region>,
    /// Way in which the start varies; `None` for a fixed start.
    pub draw: Option<Draw>,
}

impl Placement {
    /// The robot of a specification.
    pub fn new(spec: &RobotSpec, team: Team, draw: Option<Draw>) -> Self {
        Self {
            start: spec.start,
            radius: spec.model().radius,
            team,
            goal: spec.goal,
            draw,
        }
    }
}

/// Draws the poses of all robots. Robots without a [`Draw`] keep their start. The others are drawn in order,
/// and drawn again while they touch a wall or a robot placed before, or break a rule of their
/// [`RandomStart`]. Each robot has its own random stream, so that an added robot at the end does not move
/// the others.
///
/// # Errors
/// The first robot without an allowed start in `MAX_DRAWS` draws.
pub fn place(
    robots: &[Placement],
    seed: u64,
    map: &WorldMap,
    rules: &RulesSpec,
) -> Result<Vec<Pose2>, NoStart> {
    let exits: Vec<Region> = map.exits().iter().chain(&rules.exits).copied().collect();
    let mut placed: Vec<(&Placement, Pose2)> = robots
        .iter()
        .filter(|robot| robot.draw.is_none())
        .map(|robot| (robot, robot.start))
        .collect();
    let mut poses = Vec::with_capacity(robots.len());
    for (i, robot) in robots.iter().enumerate() {
        let pose = match &robot.draw {
            None => robot.start,
            Some(draw) => {
                let domain = match draw {
                    Draw::Jitter(_) => JITTER_DOMAIN,
                    Draw::Random(_) => RANDOM_DOMAIN,
                };
                let mut rng = ChaCha8Rng::seed_from_u64(seed ^ domain);
                rng.set_stream(i as u64);
                let mut refused = NoStart::new(i, *draw);
                let pose = (0..MAX_DRAWS)
                    .map(|_| match draw {
                        Draw::Jitter(jitter) => displaced(robot.start, jitter, &mut rng),
                        Draw::Random(random) => anywhere(random, map, &mut rng),
                    })
                    .find(|pose| {
                        let fault = fault(pose.position(), robot, draw, &placed, map, &exits);
                        fault.map(|fault| refused.count(fault)).is_none()
                    })
                    .ok_or(refused)?;
                placed.push((robot, pose));
                pose
            }
        };
        poses.push(pose);
    }
    Ok(poses)
}

/// Returns the reason why a robot may not start at a point (m), if there is one.
fn fault(
    at: Point2<f64>,
    robot: &Placement,
    draw: &Draw,
    placed: &[(&Placement, Pose2)],
    map: &WorldMap,
    exits: &[Region],
) -> Option<Fault> {
    let away = |other: &Placement| {
        let bodies = robot.radius + other.radius;
        match draw {
            Draw::Jitter(_) => bodies,
            Draw::Random(random) if robot.team.is_hostile_to(other.team) => bodies
                .max(random.robot_distance)
                .max(random.opponent_distance),
            Draw::Random(random) => bodies.max(random.robot_distance),
        }
    };
    let region = match draw {
        Draw::Jitter(_) => None,
        Draw::Random(random) => random.region,
    };
    if region.is_some_and(|region| !region.contains(at)) {
        return Some(Fault::Region);
    }
    if !map.is_clear(at, robot.radius) {
        return Some(Fault::Wall);
    }
    let is_near = |(other, pose): &(&Placement, Pose2)| {
        let distance = (pose.position() - at).norm();
        distance <= away(other)
    };
    if placed.iter().any(is_near) {
        return Some(Fault::Robot);
    }
    match draw {
        Draw::Jitter(_) => None,
        Draw::Random(random) => unsuited(at, robot, random, map, exits),
    }
}

/// Returns [`Fault::Exit`] or [`Fault::Reach`] if a free place does not suit a random start.
fn unsuited(
    at: Point2<f64>,
    robot: &Placement,
    random: &RandomStart,
    map: &WorldMap,
    exits: &[Region],
) -> Option<Fault> {
    let evades = robot.team.role == Role::Evader && !exits.is_empty();
    let is_far = |exit: &Region| (exit.center() - at).norm() >= random.exit_distance;
    if evades && !exits.iter().all(is_far) {
        return Some(Fault::Exit);
    }
    if !evades && robot.goal.is_none() {
        return None;
    }
    let passages = passages(map, robot.radius);
    let reach = passages.reach([at]);
    let reaches = robot.goal.is_none_or(|goal| reach.meets(&goal))
        && (!evades || exits.iter().any(|exit| reach.meets(exit)));
    (!reaches).then_some(Fault::Reach)
}

/// Returns the cells that a disc of this radius (m) can pass. A cell counts as passable within one cell's
/// diagonal, so that the grid never closes a gap that is open.
pub fn passages(map: &WorldMap, radius: f64) -> Arc<Passages> {
    let enough = (radius - map.frame().resolution * FRAC_1_SQRT_2) as f32;
    map.shapes().passages(f64::from(enough))
}

/// Draws a pose uniformly in the region's rectangle, the square around its circle, or the whole map.
fn anywhere(random: &RandomStart, map: &WorldMap, rng: &mut ChaCha8Rng) -> Pose2 {
    let mut draw = |half: f64| half * (2.0 * unit(rng) - 1.0);
    let bounds = map.bounds();
    let (center, half, angle) = match random.region {
        None => (
            [
                0.5 * (bounds.min.x + bounds.max.x),
                0.5 * (bounds.min.y + bounds.max.y),
            ],
            [
                0.5 * (bounds.max.x - bounds.min.x),
                0.5 * (bounds.max.y - bounds.min.y),
            ],
            0.0,
        ),
        Some(Region::Circle { center, radius }) => (center, [radius; 2], 0.0),
        Some(Region::Rectangle {
            center,
            half_extents,
            angle,
        }) => (center, half_extents, angle),
    };
    let (x, y, theta) = (draw(half[0]), draw(half[1]), draw(PI));
    let (sin, cos) = math::sincos(angle);
    Pose2::new(
        center[0] + cos * x - sin * y,
        center[1] + sin * x + cos * y,
        theta,
    )
}

fn displaced(start: Pose2, jitter: &StartJitter, rng: &mut ChaCha8Rng) -> Pose2 {
    let mut draw = |size: f64| size * deviate(jitter.distribution, rng);
    let (dx, dy, dtheta) = (draw(jitter.x), draw(jitter.y), draw(jitter.theta));
    Pose2::new(start.x + dx, start.y + dy, start.theta + dtheta)
}

/// Draws a number in [−1, 1], or a standard normal one cut off at ±3.
fn deviate(distribution: Distribution, rng: &mut ChaCha8Rng) -> f64 {
    match distribution {
        Distribution::Uniform => 2.0 * unit(rng) - 1.0,
        Distribution::Normal => {
            // Box–Muller transform; 1 − u lies in (0, 1], so that the logarithm is finite.
            let radius = (-2.0 * math::ln(1.0 - unit(rng))).sqrt();
            let (sin, _) = math::sincos(TAU * unit(rng));
            (radius * sin).clamp(-3.0, 3.0)
        }
    }
}

/// Draws a number in [0, 1) with 53 random bits.
fn unit(rng: &mut ChaCha8Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

#[cfg(test)]
mod tests;
