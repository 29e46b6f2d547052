//! Errors of beliefs, as a table.

use ipc_types::consumer::LoggedMessage;
use ipc_types::messages::perception::BeliefHeader;
use ipc_types::messages::world::RobotState;
use ipc_types::topics::{Belief, TopicId, WorldState};
use mcap_log::known;
use mcap_log::reader::Item;
use mcap_log::{MessageHeader, Origin};
use recorder::RunInfo;
use std::collections::BTreeMap;
use tables::{Cell, Column, Type};

use crate::measurement::Measurement;

/// Standard deviation below which a belief is a point, as after an exact sighting (m).
const POINT_M: f64 = 1e-3;

/// The beliefs of a log beside the true states at their ticks.
#[derive(Debug, Default)]
pub(crate) struct BeliefRows {
    origin: Origin,
    names: Vec<String>,
    channels: BTreeMap<u16, TopicId>,
    /// Tick and robots of the last state.
    truth: (u64, Vec<RobotState>),
    messages: u64,
}

impl Measurement for BeliefRows {
    fn columns(&self) -> Vec<Column> {
        let number = Type::F64;
        [
            ("log_time_ns", Type::UInt),
            ("robot", Type::Text),
            ("seen", Type::Bool),
            ("enclosed", number),
            ("error_m", number),
            ("deviation_m", number),
            ("normalised_error", number),
            ("effective_particles", number),
        ]
        .map(|(name, kind)| Column::new(name, kind))
        .into()
    }

    fn take(&mut self, item: &Item<'_>) -> Vec<Vec<Cell>> {
        match item {
            Item::Attachment(header, _) if header.name == Origin::RUN => {
                self.origin.add(item);
                if let Some(run) = RunInfo::from_log(&self.origin) {
                    self.names = run.robots.iter().map(|robot| robot.name.clone()).collect();
                }
            }
            Item::Channel(channel) => {
                let topic = known::topic_of(channel);
                (self.channels).extend(topic.map(|topic| (channel.id, topic)));
            }
            Item::Message(header, data) => return self.message(header, data).into_iter().collect(),
            _ => {}
        }
        Vec::new()
    }

    fn messages(&self) -> u64 {
        self.messages
    }
}

impl BeliefRows {
    fn message(&mut self, header: &MessageHeader, data: &[u8]) -> Option<Vec<Cell>> {
        let topic = *self.channels.get(&header.channel_id)?;
        let message = LoggedMessage::new(topic, header.log_time, data)?;
        if let Some((header, robots)) = message.view::<WorldState>() {
            self.truth = (header.stamp.tick, robots.collect());
            return None;
        }
        let (belief, particles) = message.view::<Belief>()?;
        self.messages += 1;
        let (tick, robots) = &self.truth;
        let mut robots = robots.iter();
        let robot = robots.find(|robot| robot.robot == belief.robot && robot.status == 0)?;
        if *tick != belief.stamp.tick {
            return None;
        }
        let off = [robot.x - belief.mean_x, robot.y - belief.mean_y];
        let deviation_m = (belief.covariance_xx + belief.covariance_yy).sqrt();
        let normalised = normalised(&belief, off).filter(|_| deviation_m >= POINT_M);
        let enclosed = normalised.map(|error| {
            let nearer = particles.filter(|particle| {
                let at = [particle.x, particle.y].map(f64::from);
                let off = [at[0] - belief.mean_x, at[1] - belief.mean_y];
                self::normalised(&belief, off).is_some_and(|of_particle| of_particle < error)
            });
            nearer.map(|particle| f64::from(particle.weight)).sum()
        });
        let name = self.names.get(belief.robot as usize);
        let number = |value: Option<f64>| value.map_or(Cell::Empty, Cell::F64);
        Some(vec![
            Cell::UInt(header.log_time),
            name.map_or(Cell::Empty, |name| Cell::Text(name.clone())),
            Cell::Bool(belief.seen == 1),
            number(enclosed),
            Cell::F64((off[0] * off[0] + off[1] * off[1]).sqrt()),
            Cell::F64(deviation_m),
            number(normalised),
            Cell::F64(belief.effective_sample_size),
        ])
    }
}

/// The square of a distance from the mean (m) by the covariance of the belief; `None` if that is singular.
fn normalised(belief: &BeliefHeader, [x, y]: [f64; 2]) -> Option<f64> {
    let [xx, xy, yy] = [
        belief.covariance_xx,
        belief.covariance_xy,
        belief.covariance_yy,
    ];
    let determinant = xx * yy - xy * xy;
    let squared = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant;
    (determinant > 0.0).then_some(squared)
}
