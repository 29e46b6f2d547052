//! Perception without its ports.

use geometry::pose::{Pose2, Twist2};
use planner_view::view::{BeliefView, ParticleView, View};
use runtime::error::ProcessError;
use runtime::kind::DirectProcess;
use tracking::tracker::{Perception, TargetTruth, Track};

/// Perception of a [`PerceptionProcess`](crate::process::PerceptionProcess), on the map of the start.
pub struct DirectPerception {
    pub perception: Perception,
    /// Period of a tick (s).
    pub dt: f64,
    pub observers: Vec<usize>,
    pub targets: Vec<usize>,
    /// Hypotheses about the targets, in their order.
    pub particles: Vec<Vec<ParticleView>>,
}

impl DirectProcess for DirectPerception {
    fn steer(&mut self, view: &View<'_>, _: &mut [Option<Twist2>]) -> Result<(), ProcessError> {
        let pose = |robot: usize| {
            let mut robots = view.robots.iter();
            let found = robots.find(|other| other.index == robot && other.active);
            found.map(|robot| robot.pose)
        };
        let (perception, dt) = (&mut self.perception, self.dt);
        let tracks = update(perception, &self.observers, &self.targets, pose, dt)?;
        self.particles.resize_with(tracks.len(), Vec::new);
        let updated = tracks.iter().zip(&mut self.particles);
        for (track, particles) in updated.filter(|(track, _)| track.is_active()) {
            particles.clear();
            particles.extend(track.particles().map(|p| ParticleView {
                x: p.x,
                y: p.y,
                theta: p.theta,
                weight: p.weight,
            }));
        }
        Ok(())
    }

    fn beliefs<'a>(&'a self, beliefs: &mut Vec<BeliefView<'a>>) {
        let tracks = self.perception.tracks().iter().zip(&self.particles);
        beliefs.extend(tracks.map(|(track, particles)| {
            let belief = track.belief();
            BeliefView {
                robot: track.robot(),
                particles,
                mean: belief.mean,
                position_std: (belief.covariance_xx + belief.covariance_yy)
                    .max(0.0)
                    .sqrt(),
                seen: belief.seen,
            }
        }));
    }
}

/// Advances a perception by `dt` (s) with the poses of the robots that take part.
///
/// # Errors
/// [`ProcessError::Algorithm`] if it refuses them.
pub fn update<'a>(
    perception: &'a mut Perception,
    observers: &[usize],
    targets: &[usize],
    pose: impl Fn(usize) -> Option<Pose2>,
    dt: f64,
) -> Result<&'a [Track], ProcessError> {
    let observers: Vec<Pose2> = observers.iter().filter_map(|&robot| pose(robot)).collect();
    let truth = |&robot: &usize| pose(robot).map(|pose| TargetTruth { robot, pose });
    let truths: Vec<TargetTruth> = targets.iter().filter_map(truth).collect();
    let updated = perception.update(&observers, &truths, dt);
    updated.map_err(|error| ProcessError::Algorithm(error.to_string()))
}
