//! How long messages and steps took, from the monotonic clocks in the stamps.
//!
//! A *step* is the time between taking up the last input and sending (`sent − received` of one
//! stamp, the longest of a process's messages for one tick). A *hop* is the time between the
//! sending of the last input and its being taken up (`received` of the output minus `sent` of the
//! input, both for the same tick). *Sense to act* is the time from a world state's sending until
//! the simulator has taken up the last command for it.

use std::collections::BTreeMap;

use ipc_types::stamp::Stamp;

use super::options::ProcessInfo;
use super::topic_info::Role;
use crate::statistics::{Distributions, LogHistogram, Percentiles};

/// Ticks that are kept while their messages come in; a message that is later is not measured.
const WINDOW: u64 = 16;

/// Name of the latency from a state's sending to the taking up of the last command for it.
pub const SENSE_TO_ACT: &str = "sense to act";

/// Collects latencies from stamps that come ordered by tick and topic.
#[derive(Debug)]
pub(crate) struct Latency {
    /// Kind and reading habits of the processes, by their index.
    processes: BTreeMap<u32, Process>,
    ticks: [Tick; WINDOW as usize],
    measured: Distributions,
}

#[derive(Debug, Default)]
struct Process {
    kind: String,
    reads_beliefs: bool,
    /// Tick of the step that is being collected, and its duration so far [ns].
    step: Option<(u64, u64)>,
    step_name: String,
    /// Name of the hop by the kind that the input came from.
    hop_names: BTreeMap<u32, String>,
}

/// When things of one tick were sent [ns], and by whom; 0 until then.
#[derive(Debug, Clone, Copy, Default)]
struct Tick {
    number: u64,
    state: (u64, u32),
    origin: u64,
    last_belief: (u64, u32),
    last_command: (u64, u32),
}

impl Latency {
    pub(crate) fn new(processes: &[ProcessInfo]) -> Self {
        let processes = processes
            .iter()
            .map(|p| {
                let process = Process {
                    kind: p.kind.clone(),
                    reads_beliefs: p.reads_beliefs,
                    step_name: format!("{} step", p.kind),
                    ..Process::default()
                };
                (p.index, process)
            })
            .collect();
        Self {
            processes,
            ticks: [Tick::default(); WINDOW as usize],
            measured: Distributions::default(),
        }
    }

    /// Takes up the stamp of one message.
    pub(crate) fn message(&mut self, role: Role, stamp: &Stamp) {
        match role {
            Role::State => self.state(stamp),
            Role::Sighting | Role::Belief | Role::Command => self.output(role, stamp),
            Role::Plan
            | Role::Tree
            | Role::Waypoint
            | Role::Event
            | Role::Coverage
            | Role::Scan
            | Role::Verdict
            | Role::Prediction
            | Role::Dominance => {}
            Role::Map
            | Role::Obstacle
            | Role::Status
            | Role::ProcessEvent
            | Role::ProcessLog
            | Role::Other => return,
        }
        self.step(stamp);
    }

    /// All latencies by name.
    pub(crate) fn finish(&mut self) -> BTreeMap<String, Percentiles> {
        let measured = self.distributions().iter();
        measured
            .map(|(name, distribution)| (name.clone(), distribution.percentiles()))
            .collect()
    }

    /// All latencies, steps that have not been followed by another one included.
    pub(crate) fn distributions(&mut self) -> &Distributions {
        let open: Vec<(String, u64)> = self
            .processes
            .values_mut()
            .filter_map(|p| {
                p.step
                    .take()
                    .map(|(_, duration)| (p.step_name.clone(), duration))
            })
            .collect();
        for (name, duration) in open {
            self.measured.record(&name, duration);
        }
        &self.measured
    }

    /// How often each latency lay in which part of its range, by name: `per_decade` parts of equal
    /// width on a logarithmic axis, from the one with the first count to the one with the last.
    pub(crate) fn histograms(&self, per_decade: u32) -> BTreeMap<String, LogHistogram> {
        let measured = self.measured.iter();
        measured
            .map(|(name, distribution)| (name.clone(), distribution.log_histogram(per_decade)))
            .collect()
    }

    fn state(&mut self, stamp: &Stamp) {
        if let Some(before) = stamp.tick.checked_sub(1).and_then(|tick| self.tick(tick))
            && before.last_command.0 > 0
        {
            self.hop(before.last_command, stamp);
            // The state that the commands answered caused this one, if they came before it began: in
            // real time the world goes on without those that are late.
            let taken = stamp.received_ns >= before.last_command.0;
            if taken && let Some(duration) = since(before.origin, stamp.received_ns) {
                self.measured.record(SENSE_TO_ACT, duration);
            }
        }
        self.ticks[(stamp.tick % WINDOW) as usize] = Tick {
            number: stamp.tick,
            state: (stamp.sent_ns, stamp.source),
            // The simulator cannot know the time of sending before it sends.
            origin: if stamp.origin_ns > 0 {
                stamp.origin_ns
            } else {
                stamp.sent_ns
            },
            ..Tick::default()
        };
    }

    fn output(&mut self, role: Role, stamp: &Stamp) {
        let Some(tick) = self.tick(stamp.tick) else {
            return;
        };
        let (step, reads_beliefs) = match self.processes.get(&stamp.source) {
            Some(process) => (process.step, process.reads_beliefs),
            None => return,
        };
        // One hop per process and tick, however many messages it sends.
        if step.is_none_or(|(tick, _)| tick != stamp.tick) {
            let waits_for_beliefs =
                role == Role::Command && reads_beliefs && tick.last_belief.0 > 0;
            self.hop(
                if waits_for_beliefs {
                    tick.last_belief
                } else {
                    tick.state
                },
                stamp,
            );
        }
        let tick = &mut self.ticks[(stamp.tick % WINDOW) as usize];
        match role {
            Role::Belief => tick.last_belief = tick.last_belief.max((stamp.sent_ns, stamp.source)),
            Role::Command => {
                tick.last_command = tick.last_command.max((stamp.sent_ns, stamp.source));
            }
            _ => {}
        }
    }

    fn tick(&self, tick: u64) -> Option<Tick> {
        let kept = self.ticks[(tick % WINDOW) as usize];
        (kept.number == tick && kept.state.0 > 0).then_some(kept)
    }

    /// A message was taken up that had been sent by another process at a time.
    fn hop(&mut self, (sent_ns, from): (u64, u32), taken: &Stamp) {
        let Some(duration) = since(sent_ns, taken.received_ns) else {
            return;
        };
        let known = |p: &Process| p.hop_names.contains_key(&from);
        if !self.processes.get(&taken.source).is_some_and(known) {
            self.name_hop(from, taken.source);
        }
        let process = self.processes.get(&taken.source);
        if let Some(name) = process.and_then(|p| p.hop_names.get(&from)) {
            self.measured.record(name, duration);
        }
    }

    /// Names the way of messages between two processes.
    fn name_hop(&mut self, from: u32, to: u32) {
        let kind = self.processes.get(&from).map(|p| p.kind.as_str());
        let kind = kind.unwrap_or("unknown").to_owned();
        if let Some(process) = self.processes.get_mut(&to) {
            let name = format!("{kind} to {}", process.kind);
            process.hop_names.insert(from, name);
        }
    }

    fn step(&mut self, stamp: &Stamp) {
        let Some(duration) = since(stamp.received_ns, stamp.sent_ns) else {
            return;
        };
        let Some(process) = self.processes.get_mut(&stamp.source) else {
            return;
        };
        match &mut process.step {
            Some((tick, longest)) if *tick == stamp.tick => *longest = duration.max(*longest),
            other => {
                if let Some((_, finished)) = other.replace((stamp.tick, duration)) {
                    self.measured.record(&process.step_name, finished);
                }
            }
        }
    }
}

/// Nanoseconds between two readings of the clock; `None` if one is missing or they are swapped
/// (the input was not what the process waited for).
pub(crate) fn since(earlier: u64, later: u64) -> Option<u64> {
    if earlier == 0 {
        None
    } else {
        later.checked_sub(earlier)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIMULATOR: u32 = 1;
    const PERCEPTION: u32 = 2;
    const PURSUER: u32 = 3;
    const EVADER: u32 = 4;

    fn processes() -> Vec<ProcessInfo> {
        [
            (SIMULATOR, "simulator", false),
            (PERCEPTION, "perception", false),
            (PURSUER, "pursuer", true),
            (EVADER, "evader_potential", false),
        ]
        .map(|(index, kind, reads_beliefs)| ProcessInfo {
            index,
            name: format!("{kind}_{index}"),
            kind: kind.to_owned(),
            reads_beliefs,
        })
        .to_vec()
    }

    fn stamp(tick: u64, source: u32, received_ns: u64, sent_ns: u64) -> Stamp {
        Stamp {
            tick,
            source,
            received_ns,
            sent_ns,
            ..Stamp::default()
        }
    }

    fn state(tick: u64, received_ns: u64, sent_ns: u64) -> Stamp {
        Stamp {
            origin_ns: sent_ns,
            ..stamp(tick, SIMULATOR, received_ns, sent_ns)
        }
    }

    fn only(measured: &BTreeMap<String, Percentiles>, name: &str) -> (u64, f64) {
        let p = measured
            .get(name)
            .unwrap_or_else(|| panic!("{name} missing in {measured:?}"));
        (p.count, p.max)
    }

    #[test]
    fn a_tick_with_beliefs_is_measured_hop_by_hop() {
        let mut latency = Latency::new(&processes());
        let base = 1_000_000;
        latency.message(Role::State, &state(5, base - 700, base));
        latency.message(
            Role::Sighting,
            &stamp(5, PERCEPTION, base + 1_000, base + 4_000),
        );
        latency.message(
            Role::Belief,
            &stamp(5, PERCEPTION, base + 1_000, base + 5_000),
        );
        latency.message(
            Role::Belief,
            &stamp(5, PERCEPTION, base + 1_000, base + 6_000),
        );
        latency.message(
            Role::Command,
            &stamp(5, PURSUER, base + 8_000, base + 9_000),
        );
        latency.message(Role::Command, &stamp(5, EVADER, base + 500, base + 800));
        latency.message(Role::State, &state(6, base + 12_000, base + 12_500));
        let measured = latency.finish();
        assert_eq!(only(&measured, "simulator to perception"), (1, 1.0));
        assert_eq!(only(&measured, "perception step"), (1, 5.0));
        assert_eq!(only(&measured, "perception to pursuer"), (1, 2.0));
        assert_eq!(only(&measured, "pursuer step"), (1, 1.0));
        assert_eq!(only(&measured, "simulator to evader_potential"), (1, 0.5));
        assert_eq!(only(&measured, "evader_potential step"), (1, 0.3));
        assert_eq!(only(&measured, "pursuer to simulator"), (1, 3.0));
        assert_eq!(only(&measured, SENSE_TO_ACT), (1, 12.0));
        assert_eq!(only(&measured, "simulator step"), (2, 0.7));
    }

    #[test]
    fn without_beliefs_pursuers_answer_the_state() {
        let mut latency = Latency::new(&processes());
        latency.message(Role::State, &state(0, 0, 1_000));
        latency.message(Role::Command, &stamp(0, PURSUER, 3_000, 4_000));
        let measured = latency.finish();
        assert_eq!(only(&measured, "simulator to pursuer"), (1, 2.0));
        assert!(!measured.contains_key(SENSE_TO_ACT) && !measured.contains_key("simulator step"));
    }

    #[test]
    fn clocks_that_are_missing_or_swapped_measure_nothing() {
        let mut latency = Latency::new(&processes());
        latency.message(Role::State, &state(3, 0, 5_000));
        latency.message(Role::Command, &stamp(3, EVADER, 4_000, 0));
        latency.message(Role::Command, &stamp(9, EVADER, 4_000, 5_000));
        latency.message(Role::Command, &stamp(3, 77, 6_000, 7_000));
        let measured = latency.finish();
        assert_eq!(
            measured.keys().collect::<Vec<_>>(),
            ["evader_potential step"]
        );
    }

    #[test]
    fn late_messages_of_a_tick_that_is_still_kept_count() {
        let mut latency = Latency::new(&processes());
        for tick in 0..WINDOW {
            latency.message(Role::State, &state(tick, 0, 1_000 * (tick + 1)));
        }
        latency.message(Role::Command, &stamp(2, EVADER, 3_500, 3_600));
        latency.message(Role::State, &state(WINDOW, 0, 1_000_000));
        latency.message(Role::Command, &stamp(0, EVADER, 1_500, 1_600));
        let measured = latency.finish();
        assert_eq!(only(&measured, "simulator to evader_potential"), (1, 0.5));
    }
}
