//! The content of a picture of a run.

use draw::palette;
use geometry::pose::Pose2;
use robot::team::Role;

use super::layers::{DominanceTrace, PlanTrace, TreeTrace, VerdictTrace};
use super::trail::Trail;
use crate::run_model::StaticScene;
use crate::run_model::TaskTrace;

/// The content of a picture of a run, up to one moment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunTrace {
    /// Title of the scenario.
    pub title: String,
    /// Description of the scenario.
    pub description: String,
    /// Name of the scenario.
    pub scenario: String,
    /// Seed, as in the log.
    pub seed: String,
    /// Moment of the picture (simulated s).
    pub time_s: f64,
    /// End of the run (simulated s); 0 for a picture of a scenario, without a run.
    pub end_s: f64,
    /// Walls, obstacles, exits.
    pub static_scene: StaticScene,
    /// The robots, by index in the scenario.
    pub robots: Vec<RobotTrace>,
    /// Beliefs at that moment; empty for a picture of the end.
    pub beliefs: Vec<BeliefTrace>,
    /// Plans of the robots at that moment; empty for a picture of the end.
    pub plans: Vec<PlanTrace>,
    /// Search trees of these plans; empty for a picture of the end.
    pub trees: Vec<TreeTrace>,
    /// Dominance regions of the teams; `None` at the end and without a referee.
    pub dominance: Option<DominanceTrace>,
    /// Verdicts of a referee at that moment; empty at the end and without a referee.
    pub verdicts: Vec<VerdictTrace>,
    /// Events up to that moment, in order.
    pub marks: Vec<Mark>,
    /// Geometry of the robots' tasks.
    pub task: TaskTrace,
}

impl RunTrace {
    /// Returns `true` for a picture of a scenario, without a run.
    pub(super) fn is_before_run(&self) -> bool {
        self.end_s <= 0.0
    }

    /// Returns the colour of a robot: a shade of its role's.
    pub(super) fn color(&self, robot: usize) -> &'static str {
        let Some(role) = self.robots.get(robot).map(|robot| robot.role) else {
            return palette::FAINT_INK;
        };
        let before = self.robots.iter().take(robot);
        let place = before.filter(|other| other.role == role).count();
        let shades = palette::shades(role);
        shades
            .get(place % shades.len())
            .copied()
            .unwrap_or(palette::FAINT_INK)
    }
}

/// Returns the name in texts of the pursuers among robots with these teams and roles.
pub(crate) fn pursuers<'a>(mut robots: impl Iterator<Item = (&'a str, Role)>) -> &'static str {
    let is_police = |(team, role)| role != Role::Pursuer || team == Role::Pursuer.team();
    if robots.all(is_police) {
        "the Police"
    } else {
        "the pursuers"
    }
}

/// A robot and its trail.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotTrace {
    /// Name.
    pub name: String,
    /// Name of its team.
    pub team: String,
    /// Role of its team.
    pub role: Role,
    /// Radius of its disc (m).
    pub radius: f64,
    /// Pose (m, m, rad).
    pub pose: Pose2,
    /// `true` while the robot is in the game.
    pub active: bool,
    /// Its trail.
    pub trail: Trail,
    /// Radius of the disc that it sweeps (m); `None` if the swept area is not accounted.
    pub sweeps: Option<f64>,
}

/// A belief about a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct BeliefTrace {
    /// Index of the robot that the belief is about.
    pub robot: usize,
    /// Mean of the particles, x and y (m).
    pub mean: [f64; 2],
    /// The particles, x and y (m).
    pub particles: Vec<[f32; 2]>,
}

/// An event at a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Kind of the event.
    pub kind: MarkKind,
    /// Index of the robot.
    pub robot: usize,
    /// Position, x and y (m).
    pub at: [f64; 2],
    /// Time (simulated s).
    pub time_s: f64,
}

/// Kind of an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarkKind {
    /// The robot was caught.
    Captured,
    /// The robot escaped.
    Escaped,
    /// The robot reached its goal.
    GoalReached,
}

impl MarkKind {
    /// Name of the kind in a legend.
    pub fn words(self) -> &'static str {
        match self {
            Self::Captured => "caught",
            Self::Escaped => "escaped",
            Self::GoalReached => "arrived",
        }
    }
}
