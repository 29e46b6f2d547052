//! All opponents of a team: sightings and beliefs for each tick.

use std::sync::Arc;

use geometry::pose::Pose2;
use parameters::{ParamsError, check};
use rand_chacha::ChaCha8Rng;
use thiserror::Error;

use crate::belief::{Belief, Particle};
use crate::params::PerceptionParams;
use crate::particle_filter::{MotionLimits, ParticleFilter};
use crate::sighting::{Sighting, sense};
use crate::space::Space;
use crate::watch::Watch;

/// Error of setting up or updating perception.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PerceptionError {
    /// A parameter is out of its range.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// A limit of an opponent is negative or not finite.
    #[error("opponent {robot}: {field} = {value}: expected a finite number ≥ 0")]
    Limits {
        /// The opponent's robot index.
        robot: usize,
        /// Name of the invalid limit.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// The time step is not positive.
    #[error("the time step is {dt} s: expected a finite number above 0")]
    TimeStep {
        /// The invalid step (s).
        dt: f64,
    },
    /// The true state of an opponent that was not set up.
    #[error("robot {robot} is not one of the tracked opponents")]
    UnknownTarget {
        /// The invalid robot index.
        robot: usize,
    },
}

/// An opponent to track.
#[derive(Debug, Clone)]
pub struct TargetSetup {
    /// Index of the robot.
    pub robot: usize,
    /// Motion limits of the opponent.
    pub limits: MotionLimits,
    /// Known start pose; `None` if unknown (uniform over the free space).
    pub start: Option<Pose2>,
    /// Its own random stream (noise of the sensor and of the filter).
    pub rng: ChaCha8Rng,
}

/// The true state of an opponent, read by the simulated sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetTruth {
    /// Index of the robot.
    pub robot: usize,
    /// Its true pose.
    pub pose: Pose2,
}

/// State of tracking one opponent.
#[derive(Debug, Clone)]
pub struct Track {
    robot: usize,
    noise: ChaCha8Rng,
    filter: ParticleFilter,
    sighting: Sighting,
    belief: Belief,
    active: bool,
}

impl Track {
    /// Index of the robot.
    pub fn robot(&self) -> usize {
        self.robot
    }

    /// Returns `true` if it took part in the last update (not yet caught or escaped).
    pub fn is_active(&self) -> bool {
        self.active
    }

    /// The sighting of the last update.
    pub fn sighting(&self) -> &Sighting {
        &self.sighting
    }

    /// The belief after the last update.
    pub fn belief(&self) -> &Belief {
        &self.belief
    }

    /// The hypotheses after the last update; their weights sum to 1.
    pub fn particles(&self) -> impl ExactSizeIterator<Item = Particle> + '_ {
        self.filter.particles()
    }

    /// The filter itself.
    pub fn filter(&self) -> &ParticleFilter {
        &self.filter
    }
}

/// Perception of one team: simulates its shared line-of-sight sensor and keeps one belief per
/// opponent.
#[derive(Debug, Clone)]
pub struct Perception {
    params: PerceptionParams,
    space: Arc<Space>,
    watch: Watch,
    tracks: Vec<Track>,
}

impl Perception {
    /// Sets up the beliefs.
    ///
    /// # Errors
    /// [`PerceptionError`] if a parameter or a limit is out of its range.
    pub fn new(
        params: &PerceptionParams,
        space: Arc<Space>,
        targets: Vec<TargetSetup>,
    ) -> Result<Self, PerceptionError> {
        check(params)?;
        let mut tracks = Vec::with_capacity(targets.len());
        for target in targets {
            check_limits(target.robot, &target.limits)?;
            // The sensor's noise and the filter's must not be the same numbers.
            let mut noise = target.rng.clone();
            noise.set_stream(target.rng.get_stream().wrapping_add(1));
            let filter = ParticleFilter::new(
                &params.filter,
                target.limits,
                target.start,
                &space,
                target.rng,
            );
            tracks.push(Track {
                robot: target.robot,
                noise,
                belief: filter.belief(),
                filter,
                sighting: Sighting::default(),
                active: true,
            });
        }
        Ok(Self {
            watch: Watch::new(&params.sensor),
            params: params.clone(),
            space,
            tracks,
        })
    }

    /// Sets a changed map. The particles stay; those that are now in an obstacle get weight 0 at
    /// the next update.
    pub fn set_map(&mut self, space: Arc<Space>) {
        self.space = space;
    }

    /// Advances by `dt` (s): senses every opponent in `targets` from the observers' poses and
    /// updates its belief. Beliefs about opponents that are not in `targets` (caught, escaped) stay
    /// unchanged.
    ///
    /// Returns the tracks in the order in which they were set up.
    ///
    /// # Errors
    /// [`PerceptionError`] if `dt` is not positive or a target was not set up; the state is then
    /// unchanged.
    pub fn update(
        &mut self,
        observers: &[Pose2],
        targets: &[TargetTruth],
        dt: f64,
    ) -> Result<&[Track], PerceptionError> {
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(PerceptionError::TimeStep { dt });
        }
        let tracked = |robot: usize| self.tracks.iter().any(|track| track.robot == robot);
        if let Some(target) = targets.iter().find(|target| !tracked(target.robot)) {
            return Err(PerceptionError::UnknownTarget {
                robot: target.robot,
            });
        }
        self.watch.set(self.space.field(), observers);
        for track in &mut self.tracks {
            let truth = targets.iter().find(|target| target.robot == track.robot);
            track.active = truth.is_some();
            let Some(truth) = truth else { continue };
            track.sighting = sense(
                &self.params.sensor,
                &self.space,
                &self.watch,
                truth.pose,
                &mut track.noise,
            );
            track
                .filter
                .update(&self.space, &self.watch, &track.sighting, dt);
            track.belief = track.filter.belief();
        }
        Ok(&self.tracks)
    }

    /// The tracks, in the order in which they were set up.
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// The map of the filters.
    pub fn space(&self) -> &Space {
        &self.space
    }
}

fn check_limits(robot: usize, limits: &MotionLimits) -> Result<(), PerceptionError> {
    for (field, value) in [
        ("v_max", limits.v_max),
        ("v_reverse_max", limits.v_reverse_max),
        ("omega_max", limits.omega_max),
    ] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(PerceptionError::Limits {
                robot,
                field,
                value,
            });
        }
    }
    Ok(())
}
