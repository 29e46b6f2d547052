//! What a picture shows of a run.

use geometry::pose::Pose2;
use sim_backend::team::Team;

use super::layers::{DominanceTrace, PlanTrace, TreeTrace};
use super::static_scene::StaticScene;
use super::trail::Trail;

/// What a picture shows of a run, up to one moment of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunTrace {
    /// The scenario's title.
    pub title: String,
    /// What the scenario says it is.
    pub description: String,
    /// The scenario's name.
    pub scenario: String,
    /// The seed, as the log has it.
    pub seed: String,
    /// The moment that the picture shows (simulated s).
    pub time_s: f64,
    /// When the run ended (simulated s).
    pub end_s: f64,
    /// What does not drive.
    pub static_scene: StaticScene,
    /// The robots, by their index in the scenario.
    pub robots: Vec<RobotTrace>,
    /// What was believed at that moment; empty for a picture of the end.
    pub beliefs: Vec<BeliefTrace>,
    /// What the robots meant to do at that moment; empty for a picture of the end.
    pub plans: Vec<PlanTrace>,
    /// The trees in which they searched for it; empty for a picture of the end.
    pub trees: Vec<TreeTrace>,
    /// Who would have reached what first; `None` at the end and without a referee.
    pub dominance: Option<DominanceTrace>,
    /// What happened until then, in order.
    pub marks: Vec<Mark>,
}

/// A robot and its way so far.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotTrace {
    /// Its name.
    pub name: String,
    /// Its side.
    pub team: Team,
    /// Radius of its disc (m).
    pub radius: f64,
    /// Where it is (m, m, rad).
    pub pose: Pose2,
    /// Whether it still plays.
    pub active: bool,
    /// Where it was.
    pub trail: Trail,
}

/// What is believed about a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct BeliefTrace {
    /// Index of the robot that the belief is about.
    pub robot: usize,
    /// Mean of the particles, x and y (m).
    pub mean: [f64; 2],
    /// The particles, x and y (m).
    pub particles: Vec<[f32; 2]>,
}

/// Something that happened at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// What.
    pub kind: MarkKind,
    /// Index of the robot that it happened to.
    pub robot: usize,
    /// Where, x and y (m).
    pub at: [f64; 2],
    /// When (simulated s).
    pub time_s: f64,
}

/// What happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarkKind {
    /// The robot was caught.
    Captured,
    /// The robot got out.
    Escaped,
    /// The robot arrived.
    GoalReached,
}

impl MarkKind {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Captured => "caught",
            Self::Escaped => "escaped",
            Self::GoalReached => "arrived",
        }
    }
}
