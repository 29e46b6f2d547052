//! Latencies of ticks, from the state of the world to the commands: transport times, computing times, and the
//! critical path.
//!
//! A *step* is the time from receiving the last input to sending (`sent − received` of one stamp; the maximum
//! over the messages of a process for one tick). A *hop* is the time from sending the last input to receiving
//! it (`received` of the output minus `sent` of the input, both for the same tick). *Sense-to-act* is the
//! time from the beginning of a state until the simulator has received the last command for it; `stages`
//! divides it.

mod stages;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::stamp::Stamp;
use ipc_types::topics::TopicId;

use self::stages::Detail;
pub use self::stages::{Answers, Passage, REACTION, Stage, TICK_JITTER, WHOLE};
use statistics::{Distribution, Distributions, Percentiles};

use super::run_info::ProcessInfo;

/// Number of ticks whose stamps are kept; more than the lag of the recorder.
const WINDOW: u64 = 512;

/// Measures the ticks of a run from the stamps of its messages, which arrive approximately in order.
#[derive(Debug, Clone)]
pub struct Chain {
    /// Topics whose messages answer the input of their tick.
    timed: Vec<TopicId>,
    /// Processes by index.
    processes: BTreeMap<u32, Process>,
    ticks: BTreeMap<u64, Tick>,
    /// Empty buffers for reuse.
    spare: Vec<Vec<Output>>,
    /// Hops and steps by name.
    pub hops: Distributions,
    /// Times of stages by name, if details are requested, and the sum.
    pub stages: Distributions,
    /// Details of the command `latency`.
    pub detail: Option<Detail>,
}

/// A process and the names of its measurements.
#[derive(Debug, Clone)]
struct Process {
    kind: String,
    reads_beliefs: bool,
    step: String,
    /// Names of hops, by the process that sent the input.
    hops: BTreeMap<u32, String>,
}

/// Stamps of the messages of one tick.
#[derive(Debug, Clone, Default)]
struct Tick {
    state: Option<Stamp>,
    /// The last belief.
    belief: Option<Stamp>,
    outputs: Vec<Output>,
}

/// Stamps of the messages of one process for a tick.
#[derive(Debug, Clone)]
struct Output {
    source: u32,
    /// Maximum time from the input to one of its messages (ns); `None` if clock readings are missing.
    step_ns: Option<u64>,
    /// First state, sighting, belief or command.
    first: Option<Stamp>,
    /// Send time of the last of these (ns).
    last_sent_ns: u64,
    /// Last command.
    command: Option<Stamp>,
}

impl Consumer for Chain {
    fn topics(&self) -> &[TopicId] {
        &self.timed
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        self.take(message.topic, &message.stamp);
    }
}

impl Chain {
    /// Returns the topics whose messages answer the input of their tick.
    pub fn timed() -> Vec<TopicId> {
        TopicId::all().filter(|topic| topic.facts().timed).collect()
    }

    /// Creates the measurement of a run with these processes.
    pub fn new(processes: &[ProcessInfo]) -> Self {
        let processes = processes.iter().map(|p| {
            let process = Process {
                kind: p.kind.clone(),
                reads_beliefs: !p.upstream.is_empty(),
                step: format!("{} step", p.kind),
                hops: BTreeMap::new(),
            };
            (p.index, process)
        });
        Self {
            timed: Self::timed(),
            processes: processes.collect(),
            ticks: BTreeMap::new(),
            spare: Vec::new(),
            hops: Distributions::default(),
            stages: Distributions::default(),
            detail: None,
        }
    }

    /// Adds details: turns, stages and answers. `period_ns` is the wall-clock time between two ticks in real
    /// time (ns), `None` in lock-step.
    #[must_use]
    pub fn with_detail(mut self, period_ns: Option<u64>) -> Self {
        self.detail = Some(Detail::new(period_ns));
        self
    }

    /// Adds the stamp of a message of a timed topic.
    fn take(&mut self, topic: TopicId, stamp: &Stamp) {
        // Runs in one thread have no clock readings.
        if stamp.sent_ns == 0 || !self.processes.contains_key(&stamp.source) {
            return;
        }
        let newest = self.ticks.last_key_value().map_or(0, |(tick, _)| *tick);
        if stamp.tick.saturating_add(WINDOW) <= newest {
            return;
        }
        let spare = &mut self.spare;
        let tick = self.ticks.entry(stamp.tick).or_insert_with(|| Tick {
            outputs: spare.pop().unwrap_or_default(),
            ..Tick::default()
        });
        tick.take(topic, stamp);
        if topic == TopicId::WorldState
            && let Some(detail) = &mut self.detail
        {
            detail.ticked(stamp);
        }
        while self.ticks.len() as u64 > WINDOW {
            self.settle_first();
        }
    }

    /// Measures the remaining ticks. The last tick has no answer, only hops and steps.
    pub fn settle(&mut self) {
        while !self.ticks.is_empty() {
            self.settle_first();
        }
    }

    /// Returns hops, steps and sense-to-act by name; complete after [`Chain::settle`].
    pub fn latencies(&self) -> impl Iterator<Item = (&String, &Distribution)> {
        let whole = self.stages.iter().filter(|(name, _)| *name == WHOLE);
        self.hops.iter().chain(whole)
    }

    /// Returns the percentiles of [`Chain::latencies`] (µs) at the end of the run.
    pub(crate) fn percentiles(&mut self) -> BTreeMap<String, Percentiles> {
        self.settle();
        self.latencies()
            .map(|(name, distribution)| (name.clone(), distribution.percentiles()))
            .collect()
    }

    fn settle_first(&mut self) {
        let Some((number, mut tick)) = self.ticks.pop_first() else {
            return;
        };
        self.measure_hops(number, &tick);
        if let Some(state) = tick.state
            && !self.ticks.is_empty()
        {
            self.measure_stages(number, &tick, &state);
        }
        tick.outputs.clear();
        self.spare.push(tick.outputs);
    }

    fn measure_hops(&mut self, number: u64, tick: &Tick) {
        for output in &tick.outputs {
            let Some(process) = self.processes.get(&output.source) else {
                continue;
            };
            if let Some(step_ns) = output.step_ns {
                self.hops.record(&process.step, step_ns);
            }
            if let Some(first) = output.first
                && let Some(input) = tick.input(process, output.source)
            {
                self.hop(&input, &first);
            }
        }
        let next = number.checked_add(1).and_then(|next| self.ticks.get(&next));
        if let Some(next) = next.and_then(|tick| tick.state) {
            let commands = tick.outputs.iter().filter_map(|output| output.command);
            let taken = commands.filter(|command| command.sent_ns <= next.received_ns);
            if let Some(last) = taken.max_by_key(|command| (command.sent_ns, command.source)) {
                self.hop(&last, &next);
            }
        }
    }

    /// Measures the hop of a message that another message answers.
    fn hop(&mut self, sent: &Stamp, answer: &Stamp) {
        let Some(duration) = since(sent.sent_ns, answer.received_ns) else {
            return;
        };
        let known = self.processes.get(&answer.source);
        let known = known.and_then(|to| to.hops.get(&sent.source));
        if let Some(name) = known {
            self.hops.record(name, duration);
            return;
        }
        let kind = |index: u32| self.processes.get(&index).map(|p| p.kind.clone());
        let (Some(from), Some(to)) = (kind(sent.source), kind(answer.source)) else {
            return;
        };
        let name = format!("{from} to {to}");
        self.hops.record(&name, duration);
        if let Some(to) = self.processes.get_mut(&answer.source) {
            to.hops.insert(sent.source, name);
        }
    }
}

impl Tick {
    fn take(&mut self, topic: TopicId, stamp: &Stamp) {
        let known = self
            .outputs
            .iter()
            .position(|output| output.source == stamp.source);
        let at = known.unwrap_or_else(|| {
            self.outputs.push(Output {
                source: stamp.source,
                step_ns: None,
                first: None,
                last_sent_ns: 0,
                command: None,
            });
            self.outputs.len() - 1
        });
        let Some(output) = self.outputs.get_mut(at) else {
            return;
        };
        output.step_ns = output.step_ns.max(since(stamp.received_ns, stamp.sent_ns));
        let later = |than: Option<Stamp>| than.is_none_or(|than| than.sent_ns < stamp.sent_ns);
        match topic {
            TopicId::WorldState => self.state = Some(*stamp),
            TopicId::Belief if later(self.belief) => self.belief = Some(*stamp),
            TopicId::Commands if later(output.command) => output.command = Some(*stamp),
            TopicId::Sightings | TopicId::Belief | TopicId::Commands => {}
            // Other processes have steps only.
            _ => return,
        }
        let earlier = |than: Stamp| stamp.sent_ns < than.sent_ns;
        if output.first.is_none_or(earlier) {
            output.first = Some(*stamp);
        }
        output.last_sent_ns = output.last_sent_ns.max(stamp.sent_ns);
    }

    /// Returns the input of a process in this tick; `None` for the simulator, which sends the state.
    fn input(&self, process: &Process, source: u32) -> Option<Stamp> {
        let state = self.state.filter(|state| state.source != source)?;
        let belief = self.belief.filter(|_| process.reads_beliefs);
        Some(belief.unwrap_or(state))
    }
}

/// Returns the nanoseconds between two clock readings; `None` if one is missing or they are in reverse order
/// (the process did not wait for this input).
fn since(earlier: u64, later: u64) -> Option<u64> {
    if earlier == 0 {
        None
    } else {
        later.checked_sub(earlier)
    }
}
