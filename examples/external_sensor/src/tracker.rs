//! Positions from bearings: weighted least squares with a memory of about a second.

use std::collections::BTreeMap;

use ipc_types::bus::{Bus, Publisher, PublisherOptions, Subscriber};
use ipc_types::stamp::PlainHeader;
use runtime::declaration::{Declaration, Flow, Input, Output, When};
use runtime::inputs::{StateInput, reply_stamp};
use runtime::{Process, ProcessConfig, ProcessError, ProcessKind};

use crate::messages::{Bearings, Track, Tracks};

/// Weight of the past in each tick.
const MEMORY: f64 = 0.8;
/// Distance that the weights of bearings assume (m).
const DISTANCE: f64 = 3.0;

/// Information about the position of a robot: a symmetric matrix and a vector.
#[derive(Default)]
struct Information {
    matrix: [f64; 3],
    vector: [f64; 2],
}

impl Information {
    fn forget(&mut self) {
        self.matrix
            .iter_mut()
            .chain(&mut self.vector)
            .for_each(|x| *x *= MEMORY);
    }

    /// Adds the line through a place with this direction.
    fn add(&mut self, place: [f64; 2], angle: f64, sigma: f64) {
        let (sin, cos) = libm::sincos(angle);
        let normal = [-sin, cos];
        let weight = 1.0 / (sigma * DISTANCE).powi(2);
        let offset = normal[0] * place[0] + normal[1] * place[1];
        self.matrix[0] += weight * normal[0] * normal[0];
        self.matrix[1] += weight * normal[0] * normal[1];
        self.matrix[2] += weight * normal[1] * normal[1];
        self.vector[0] += weight * normal[0] * offset;
        self.vector[1] += weight * normal[1] * offset;
    }

    /// Returns the position and its standard deviation (m); `None` while all lines are parallel.
    fn position(&self) -> Option<([f64; 2], f64)> {
        let [a, b, c] = self.matrix;
        let determinant = a * c - b * b;
        if determinant <= 1e-6 * (a + c) * (a + c) {
            return None;
        }
        let [u, v] = self.vector;
        let position = [(c * u - b * v) / determinant, (a * v - b * u) / determinant];
        Some((position, ((a + c) / determinant).sqrt()))
    }
}

/// The tracker of all opponents.
pub struct BearingTracker {
    config: ProcessConfig,
    state: StateInput,
    bearings: Subscriber<Bearings>,
    tracks: Publisher<Tracks>,
    known: BTreeMap<u32, Information>,
    rejected: u64,
}

impl ProcessKind for BearingTracker {
    const NAME: &'static str = "bearing_tracker";
    const SUMMARY: &'static str = "finds the positions of robots from bearings";

    type Params = ();

    fn declare((): &()) -> Declaration {
        let bearings = Input::new(Flow::for_topic::<Bearings>(), When::ThisTick);
        Declaration::default()
            .reads(Input::STATE)
            .reads(bearings)
            .writes(Output::new::<Tracks>(0).at(When::ThisTick).sole())
    }

    fn open(config: &ProcessConfig, (): &(), bus: &Bus) -> Result<Self, ProcessError> {
        let robots = config.run.robots.len();
        Ok(Self {
            state: StateInput::open(bus, robots)?,
            bearings: bus.subscriber()?,
            tracks: bus.publisher(PublisherOptions::new(config.index, robots))?,
            known: BTreeMap::new(),
            rejected: 0,
            config: config.clone(),
        })
    }
}

impl Process for BearingTracker {
    fn connect(&mut self) -> Result<(), ProcessError> {
        self.state.connect()?;
        self.bearings.update_connections()?;
        Ok(self.tracks.update_connections()?)
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        self.state.take_turn(tick, self.config.run.clock)?;
        self.known.values_mut().for_each(Information::forget);
        while let Some(message) = self.bearings.receive()? {
            let header = message.header();
            for bearing in message.elements() {
                let numbers = [header.x, header.y, header.sigma, bearing.angle];
                if !numbers.iter().all(|x| x.is_finite()) || header.sigma <= 0.0 {
                    self.rejected += 1;
                    continue;
                }
                let known = self.known.entry(bearing.robot).or_default();
                known.add([header.x, header.y], bearing.angle, header.sigma);
            }
        }
        let track = |(&robot, known): (&u32, &Information)| {
            let ([x, y], sigma) = known.position()?;
            Some(Track {
                x,
                y,
                sigma,
                robot,
                reserved: 0,
            })
        };
        let tracks: Vec<Track> = self.known.iter().filter_map(track).collect();
        let stamp = reply_stamp(&self.state.header, self.state.received_ns);
        self.tracks.send(PlainHeader { stamp }, &tracks)?;
        Ok(())
    }

    fn rejected(&self) -> u64 {
        self.state.rejected + self.rejected
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bearings_that_cross_give_a_position_and_one_gives_none() {
        let mut known = Information::default();
        known.add([0.0, 0.0], core::f64::consts::FRAC_PI_4, 0.1);
        assert!(known.position().is_none());
        known.add([4.0, 0.0], 3.0 * core::f64::consts::FRAC_PI_4, 0.1);
        let ([x, y], sigma) = known.position().unwrap();
        assert!((x - 2.0).abs() < 1e-9 && (y - 2.0).abs() < 1e-9, "{x} {y}");
        assert!(sigma > 0.0);
    }
}
