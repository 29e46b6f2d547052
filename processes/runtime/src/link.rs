//! Steps and links of a process: it steps in every n-th tick, and messages come to it later or not at all.

use std::rc::Rc;

use ipc_types::bus::{Arrivals, Inbox};
use ipc_types::stamp::Stamp;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::config::ProcessConfig;
use crate::declaration::{Declaration, Flow, When};
use crate::error::ProcessError;
use crate::kind::Process;
use crate::seed;

/// Link of a topic from one process to another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Link {
    /// Name of the topic.
    pub topic: String,
    /// Index of the sender, the source in its stamps.
    pub source: u32,
    /// Name of the sender.
    pub from: String,
    /// Name of the receiver.
    pub to: String,
    /// Number of ticks after that of its stamp at which a message arrives.
    pub delay: u64,
    /// Probability with which a message never arrives, in [0, 1).
    pub loss: f64,
}

impl Link {
    /// Returns the losses on this link in a run with this seed.
    pub fn losses(&self, run_seed: u64) -> Losses {
        let purpose = format!("link {}", self.topic);
        Losses {
            stream: seed::stream(run_seed, &self.to, &self.from, &purpose),
            loss: self.loss,
        }
    }
}

/// Losses on a link. Whether a message is lost depends on its sequence number, not on the order of questions.
#[derive(Debug, Clone, PartialEq)]
pub struct Losses {
    stream: ChaCha8Rng,
    loss: f64,
}

impl Losses {
    /// Returns `true` if the message with this sequence number is lost.
    pub fn is_lost(&self, sequence: u64) -> bool {
        if self.loss <= 0.0 {
            return false;
        }
        let mut stream = self.stream.clone();
        // A number takes two words.
        stream.set_word_pos(u128::from(sequence) * 2);
        stream.random::<f64>() < self.loss
    }
}

/// The links to one process.
#[derive(Debug)]
struct Links {
    links: Vec<(Link, Losses)>,
    awaited: Vec<&'static str>,
}

impl Arrivals for Links {
    fn arrival(&self, topic: &str, stamp: &Stamp) -> Option<u64> {
        let mut links = self.links.iter();
        let of_message =
            |(link, _): &&(Link, Losses)| link.source == stamp.source && link.topic == topic;
        let Some((link, losses)) = links.find(of_message) else {
            return Some(0);
        };
        (!losses.is_lost(stamp.sequence)).then(|| stamp.tick.saturating_add(link.delay))
    }

    fn is_awaited(&self, topic: &str) -> bool {
        self.awaited.contains(&topic)
    }
}

/// Returns the inbox of a process with this declaration; `None` if it steps in every tick and has no links.
pub fn inbox(config: &ProcessConfig, declaration: &Declaration) -> Option<Rc<Inbox>> {
    if config.period <= 1 && config.links.is_empty() {
        return None;
    }
    let with_losses = |link: &Link| (link.clone(), link.losses(config.run.seed));
    let needed = declaration.inputs.iter().filter(|input| {
        let name = input.flow.to_string();
        let mut links = config.links.iter();
        input.is_required && input.when == When::ThisTick && links.any(|link| link.topic == name)
    });
    let links = Links {
        awaited: needed
            .filter_map(|input| match input.flow {
                Flow::Topic(topic) => Some(topic.name()),
                Flow::Requests(_) | Flow::Answers(_) => None,
            })
            .collect(),
        links: config.links.iter().map(with_losses).collect(),
    };
    Some(Inbox::new(Box::new(links), config.run.tick_period_ns))
}

/// A process with an inbox. It steps in the first tick, and then in every tick that is a multiple of its period (real time:
/// in the first one after that, if it is late); before the first message of a linked input it stands idle.
pub(crate) struct Paced {
    process: Box<dyn Process>,
    inbox: Rc<Inbox>,
    period: u64,
    /// Number of the last step.
    last: Option<u64>,
}

impl Paced {
    pub(crate) fn new(process: Box<dyn Process>, inbox: Rc<Inbox>, period: u64) -> Self {
        Self {
            process,
            inbox,
            period: period.max(1),
            last: None,
        }
    }
}

impl Process for Paced {
    fn connect(&mut self) -> Result<(), ProcessError> {
        self.process.connect()
    }

    fn prepare(&mut self) -> Result<(), ProcessError> {
        self.process.prepare()
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        let is_ready = self.inbox.begin(tick)?;
        let step = Some(tick / self.period);
        if self.last == step {
            return Ok(());
        }
        self.last = step;
        if is_ready {
            self.process.step(tick)?;
        }
        Ok(())
    }

    fn rejected(&self) -> u64 {
        self.process.rejected()
    }
}

#[cfg(test)]
mod tests {
    use ipc_types::bus::{Bus, BusOptions, Publisher, PublisherOptions, Subscriber};
    use ipc_types::messages::robot::Command;
    use ipc_types::stamp::PlainHeader;
    use ipc_types::topics::{Commands, RunSize, Topic as _};
    use proptest::prelude::*;

    use super::*;

    fn link(from: &str, to: &str, delay: u64, loss: f64) -> Link {
        Link {
            topic: Commands::NAME.to_owned(),
            source: 1,
            from: from.to_owned(),
            to: to.to_owned(),
            delay,
            loss,
        }
    }

    #[test]
    fn losses_follow_from_seed_names_and_number_alone() {
        let link = link("a", "b", 0, 0.3);
        let losses = link.losses(7);
        let forwards: Vec<bool> = (0..4000).map(|n| losses.is_lost(n)).collect();
        let backwards: Vec<bool> = (0..4000).rev().map(|n| losses.is_lost(n)).collect();
        assert!(forwards.iter().eq(backwards.iter().rev()));
        let lost = forwards.iter().filter(|lost| **lost).count();
        assert!((1100..1300).contains(&lost), "{lost}");
        for other in [
            link.losses(8),
            Link {
                from: "c".into(),
                ..link.clone()
            }
            .losses(7),
            Link {
                to: "c".into(),
                ..link.clone()
            }
            .losses(7),
            Link {
                topic: "c".into(),
                ..link.clone()
            }
            .losses(7),
        ] {
            assert!((0..4000).any(|n| other.is_lost(n) != forwards[n as usize]));
        }
    }

    /// Sends its tick, and notes the ticks of the messages that it sees.
    struct Probe {
        output: Publisher<Commands>,
        input: Subscriber<Commands>,
        seen: Rc<std::cell::RefCell<Vec<(u64, u64)>>>,
    }

    impl Process for Probe {
        fn connect(&mut self) -> Result<(), ProcessError> {
            Ok(())
        }

        fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
            while let Some(message) = self.input.receive()? {
                if message.header().stamp.source == 1 {
                    self.seen
                        .borrow_mut()
                        .push((tick, message.header().stamp.tick));
                }
            }
            self.output
                .send(PlainHeader::default(), &[Command::default()])?;
            Ok(())
        }
    }

    proptest! {
        #[test]
        fn a_message_comes_once_in_the_first_step_after_its_delay_or_never(
            delay in 0_u64..7,
            period in 1_u64..9,
            loss in prop_oneof![Just(0.0), 0.0..0.9],
            seed in any::<u64>(),
        ) {
            let options = BusOptions {
                size: RunSize { robots: 1, processes: 3, events: 0 },
                recorder_ticks: 64,
                overflow: false,
            };
            let bus = Bus::local(options, None);
            let sender: Publisher<Commands> = bus.publisher(PublisherOptions::new(1, 1)).unwrap();
            let link = link("sender", "probe", delay, loss);
            let links = Links {
                links: vec![(link.clone(), link.losses(seed))],
                awaited: vec![Commands::NAME],
            };
            let inbox = Inbox::new(Box::new(links), 1000);
            let seen = Rc::default();
            let probe = bus.through(&inbox, || Probe {
                output: bus.publisher(PublisherOptions::new(2, 1)).unwrap(),
                input: bus.subscriber().unwrap(),
                seen: Rc::clone(&seen),
            });
            let outputs: Subscriber<Commands> = bus.subscriber().unwrap();
            let mut paced = Paced::new(Box::new(probe), inbox, period);
            let mut sent = Vec::new();
            for tick in 0..60 {
                let mut header = PlainHeader::default();
                header.stamp.tick = tick;
                sender.send(header, &[Command::default()]).unwrap();
                paced.step(tick).unwrap();
                while let Some(message) = outputs.receive().unwrap() {
                    let stamp = message.header().stamp;
                    if stamp.source == 2 {
                        sent.push((stamp.tick, stamp.time_ns));
                    }
                }
            }
            let losses = link.losses(seed);
            let due = |tick: u64| (tick + delay).next_multiple_of(period);
            let mut expected: Vec<(u64, u64)> = (0..60)
                .filter(|&tick| !losses.is_lost(tick) && due(tick) < 60)
                .map(|tick| (due(tick), tick))
                .collect();
            expected.sort_unstable();
            prop_assert_eq!(&*seen.borrow(), &expected);
            // It steps, and dates its outputs, from the first message on.
            let first = expected.first().map_or(60, |first| first.0);
            let steps = (first..60).filter(|tick| tick % period == 0);
            prop_assert_eq!(sent, steps.map(|tick| (tick, 1000 * tick)).collect::<Vec<_>>());
        }
    }
}
