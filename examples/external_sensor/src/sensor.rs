//! A sensor on every pursuer that measures the directions of its opponents, not their distances.

use ipc_types::bus::{Bus, Publisher, PublisherOptions};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use runtime::config::Role;
use runtime::declaration::{Declaration, Input, Output, When};
use runtime::inputs::{StateInput, reply_stamp};
use runtime::{Process, ProcessConfig, ProcessError, ProcessKind};

use crate::messages::{Bearing, BearingHeader, Bearings};

/// Standard deviation of a bearing (rad).
const SIGMA: f64 = 0.05;

/// The sensors of all pursuers.
pub struct BearingSensor {
    config: ProcessConfig,
    state: StateInput,
    bearings: Publisher<Bearings>,
    noise: ChaCha8Rng,
}

impl ProcessKind for BearingSensor {
    const NAME: &'static str = "bearing_sensor";
    const SUMMARY: &'static str = "measures the bearings of the opponents of all pursuers";

    type Params = ();

    fn declare((): &()) -> Declaration {
        Declaration::default()
            .reads(Input::STATE)
            .writes(Output::new::<Bearings>(0).at(When::ThisTick))
    }

    fn open(config: &ProcessConfig, (): &(), bus: &Bus) -> Result<Self, ProcessError> {
        let robots = config.run.robots.len();
        Ok(Self {
            state: StateInput::open(bus, robots)?,
            bearings: bus.publisher(PublisherOptions::new(config.index, robots))?,
            noise: runtime::seed::stream(config.run.seed, &config.name, "", "noise"),
            config: config.clone(),
        })
    }
}

impl Process for BearingSensor {
    fn connect(&mut self) -> Result<(), ProcessError> {
        self.state.connect()?;
        Ok(self.bearings.update_connections()?)
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        self.state.take_turn(tick, self.config.run.clock)?;
        let stamp = reply_stamp(&self.state.header, self.state.received_ns);
        for (own, (info, at)) in self
            .config
            .run
            .robots
            .iter()
            .zip(&self.state.robots)
            .enumerate()
        {
            let is_active = |robot: &&u32| self.state.robots[**robot as usize].status == 0;
            if info.role != Role::Pursuer || at.status != 0 {
                continue;
            }
            let mut bearings = Vec::new();
            for &robot in info.opponents.iter().filter(is_active) {
                let seen = &self.state.robots[robot as usize];
                // The sum of twelve uniform numbers is nearly normal, and has the same bits everywhere.
                let normal: f64 = (0..12).map(|_| self.noise.random::<f64>()).sum::<f64>() - 6.0;
                bearings.push(Bearing {
                    angle: libm::atan2(seen.y - at.y, seen.x - at.x) + SIGMA * normal,
                    robot,
                    reserved: 0,
                });
            }
            let header = BearingHeader {
                stamp,
                x: at.x,
                y: at.y,
                sigma: SIGMA,
                robot: own as u32,
                reserved: 0,
            };
            self.bearings.send(header, &bearings)?;
        }
        Ok(())
    }
}
