//! Referee: judges every moment of a chase by its guaranteed outcome.
//!
//! Its inputs are the true state of the world, not a team's beliefs, and the limits of all robots. From
//! geodesic waves (`navigation::dominance`) and rollouts of the drive (`pursuit_evasion::escape`) it computes,
//! for every evader, if it escapes whatever the pursuers do, and for every place, the robot that
//! reaches it first. It steers no robot.

pub mod params;
pub mod process;
pub mod referee;

pub use params::RefereeParams;
pub use referee::{Game, Judgement, Referee};
