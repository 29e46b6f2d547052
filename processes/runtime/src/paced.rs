//! Steps of a process with a period or links: it steps in every n-th tick, and messages come to it later or not at all.

use std::rc::Rc;

use ipc_types::bus::{Arrivals, Bus, Inbox};
use ipc_types::stamp::Stamp;

use crate::config::ProcessConfig;
use crate::declaration::{Declaration, Flow, When};
use crate::error::ProcessError;
use crate::kind::{self, Process, ProcessKind};
use crate::link::{Link, Losses};

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

/// Opens a process as [`kind::open`] does, with its period and its links.
///
/// # Errors
/// As [`kind::open`].
pub fn start<K: ProcessKind>(
    config: &ProcessConfig,
    params: &K::Params,
    bus: &Bus,
) -> Result<Box<dyn Process>, ProcessError> {
    let open = || kind::open::<K>(config, params, bus);
    let Some(inbox) = inbox(config, &K::declare(params)) else {
        return Ok(Box::new(open()?));
    };
    let process = Box::new(bus.through(&inbox, open)?);
    Ok(Box::new(PacedProcess::new(process, inbox, config.period)))
}

/// A process with an inbox. It steps in the first tick, and then in every tick that is a multiple of its period (real time:
/// in the first one after that, if it is late); before the first message of a linked input it stands idle.
struct PacedProcess {
    process: Box<dyn Process>,
    inbox: Rc<Inbox>,
    period: u64,
    /// Number of the last step.
    last: Option<u64>,
}

impl PacedProcess {
    fn new(process: Box<dyn Process>, inbox: Rc<Inbox>, period: u64) -> Self {
        Self {
            process,
            inbox,
            period: period.max(1),
            last: None,
        }
    }
}

impl Process for PacedProcess {
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
    use ipc_types::bus::{BusOptions, Publisher, PublisherOptions, Subscriber};
    use ipc_types::messages::robot::Command;
    use ipc_types::stamp::PlainHeader;
    use ipc_types::topics::{Commands, RunSize, Topic as _};
    use proptest::prelude::*;

    use super::*;

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
            let bus = Bus::local(options);
            let sender: Publisher<Commands> = bus.publisher(PublisherOptions::new(1, 1)).unwrap();
            let link = Link {
                topic: Commands::NAME.to_owned(),
                source: 1,
                from: "sender".to_owned(),
                to: "probe".to_owned(),
                delay,
                loss,
            };
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
            let mut paced = PacedProcess::new(Box::new(probe), inbox, period);
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
