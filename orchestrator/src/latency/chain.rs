//! From the state of the world to the commands for it, tick by tick: which processes were waited for,
//! and what took how long.
//!
//! Of every tick the *last* command is followed back to the state: the command of a process that goes
//! by beliefs if there is one, then through perception. The boundaries of the stages are readings of
//! one clock, each stage ends where the next begins, so that the stages of a tick add up to the whole.

use std::collections::BTreeMap;

use ipc_types::stamp::Stamp;

use crate::recorder::{ProcessInfo, Role, since};
use crate::statistics::Distributions;

/// Ticks that are kept while what belongs to them comes in: more than the recorder lags behind.
const WINDOW: u64 = 1024;

/// A piece of the way from state to act.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// The simulator writes scans, map and state.
    Publish,
    /// The state is on its way to perception, which wakes up and takes it.
    ToPerception,
    /// Perception computes and writes its beliefs.
    Perception,
    /// The beliefs (without perception: the state) are on their way to the planner.
    ToPlanner,
    /// The planner computes and writes the command.
    Planner,
    /// In real time: the command lies there until the tick ends.
    Wait,
    /// The command is on its way to the simulator, which wakes up and takes it.
    ToSimulator,
}

impl Stage {
    /// All stages, in order.
    pub const ALL: [Self; 7] = [
        Self::Publish,
        Self::ToPerception,
        Self::Perception,
        Self::ToPlanner,
        Self::Planner,
        Self::Wait,
        Self::ToSimulator,
    ];

    /// What it is called in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Publish => "state is published",
            Self::ToPerception => "way to perception",
            Self::Perception => "perception's step",
            Self::ToPlanner => "way to the planner",
            Self::Planner => "planner's step",
            Self::Wait => "wait for the next tick",
            Self::ToSimulator => "way to the simulator",
        }
    }
}

/// Name of the whole: the sum of all stages.
pub const WHOLE: &str = "sense to act";
/// Name of the part before the wait: until the command has been sent.
pub const REACTION: &str = "sense to command";

/// How one tick went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Passage {
    /// The tick.
    pub tick: u64,
    /// Times of the stages, in the order of [`Stage::ALL`] [ns]; 0 for those that it had not.
    pub stages: [u64; 7],
    /// From the state's beginning to the last command's being taken up [ns].
    pub whole_ns: u64,
    /// From the state's beginning to the last command's being sent [ns].
    pub reaction_ns: u64,
    /// Ticks after the one that it was for at which the command was taken up: 0 if in time.
    pub late_ticks: u64,
}

/// Counts of ticks by how they ended.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Answers {
    /// States of the world.
    pub ticks: u64,
    /// Ticks whose commands were all taken up at their end.
    pub in_time: u64,
    /// Ticks whose last command was taken up at the end of a later one: deadline misses.
    pub late: u64,
    /// Ticks that nobody has answered with a command: planners were still busy with an earlier one.
    pub unanswered: u64,
    /// Answered ticks whose planner did not have the beliefs of the tick.
    pub without_beliefs: u64,
}

#[derive(Debug, Clone, Default)]
struct Tick {
    state: Option<Stamp>,
    belief: Option<Stamp>,
    commands: BTreeMap<u32, Stamp>,
    /// What every process sent first and last.
    outputs: BTreeMap<u32, (Stamp, u64)>,
}

/// Follows the ticks of a log.
#[derive(Debug)]
pub(crate) struct Chain {
    processes: BTreeMap<u32, ProcessInfo>,
    real_time: bool,
    /// Time between two ticks [ns], by the clock on the wall.
    period_ns: u64,
    ticks: BTreeMap<u64, Tick>,
    last_sent: Option<(u64, u64)>,
    answers: Answers,
    /// Times of stages by name, and of the whole.
    pub(crate) stages: Distributions,
    /// Parts of every process's turn, by names such as `pursuer wakes up`.
    pub(crate) turns: Distributions,
    /// |time between two states − period|; in real time only.
    pub(crate) period: Distributions,
    passages: Vec<Passage>,
}

/// Passages that are kept one by one.
const MOST_PASSAGES: usize = 200_000;
/// Name of the jitter of ticks.
pub const TICK_JITTER: &str = "tick off its time";

impl Chain {
    /// Of a run with these processes; `period_ns`: wall-clock time between two ticks in real time,
    /// `None` in lock-step.
    pub(crate) fn new(processes: &[ProcessInfo], period_ns: Option<u64>) -> Self {
        Self {
            processes: processes.iter().map(|p| (p.index, p.clone())).collect(),
            real_time: period_ns.is_some(),
            period_ns: period_ns.unwrap_or(0),
            ticks: BTreeMap::new(),
            last_sent: None,
            answers: Answers::default(),
            stages: Distributions::default(),
            turns: Distributions::default(),
            period: Distributions::default(),
            passages: Vec::new(),
        }
    }

    /// Takes up the stamp of one message.
    pub(crate) fn message(&mut self, role: Role, stamp: &Stamp) {
        let outputs = matches!(
            role,
            Role::State | Role::Sighting | Role::Belief | Role::Command
        );
        if !outputs || stamp.sent_ns == 0 || !self.processes.contains_key(&stamp.source) {
            return;
        }
        let oldest = self.ticks.keys().next_back().copied().unwrap_or(0);
        if stamp.tick.saturating_add(WINDOW) < oldest {
            return;
        }
        let tick = self.ticks.entry(stamp.tick).or_default();
        let output = tick.outputs.entry(stamp.source).or_insert((*stamp, 0));
        output.1 = output.1.max(stamp.sent_ns);
        match role {
            Role::State => tick.state = Some(*stamp),
            Role::Belief if tick.belief.is_none_or(|b| b.sent_ns < stamp.sent_ns) => {
                tick.belief = Some(*stamp);
            }
            Role::Command => {
                let last = tick.commands.entry(stamp.source).or_insert(*stamp);
                if last.sent_ns < stamp.sent_ns {
                    *last = *stamp;
                }
            }
            _ => {}
        }
        if role == Role::State {
            self.ticked(stamp);
            while self.ticks.len() as u64 > WINDOW {
                self.settle_first();
            }
        }
    }

    /// All ticks that have not been settled yet; then how they ended, and every one of them.
    pub(crate) fn finish(&mut self) -> (Answers, &[Passage]) {
        while self.ticks.len() > 1 {
            self.settle_first();
        }
        (self.answers, &self.passages)
    }

    /// How far the time between two states is from the period.
    fn ticked(&mut self, stamp: &Stamp) {
        let before = self.last_sent.replace((stamp.tick, stamp.origin_ns));
        if let Some((tick, origin)) = before
            && self.real_time
            && stamp.tick == tick + 1
            && let Some(between) = since(origin, stamp.origin_ns)
        {
            self.period
                .record(TICK_JITTER, between.abs_diff(self.period_ns));
        }
    }

    fn settle_first(&mut self) {
        let Some((number, tick)) = self.ticks.pop_first() else {
            return;
        };
        let Some(state) = tick.state else { return };
        self.answers.ticks += 1;
        self.turns(&tick, &state);
        let Some((planner, belief)) = self.critical(&tick) else {
            self.answers.unanswered += 1;
            return;
        };
        if belief.is_none() && tick.belief.is_some() && self.reads_beliefs(planner.source) {
            self.answers.without_beliefs += 1;
        }
        let Some((at, act)) = self.taken(&planner) else {
            // The run ended before.
            return;
        };
        let late_ticks = at.saturating_sub(number + 1);
        if late_ticks == 0 {
            self.answers.in_time += 1;
        } else {
            self.answers.late += 1;
        }
        let Some(stages) = stages(&state, belief.as_ref(), &planner, &act, self.real_time) else {
            return;
        };
        let passage = Passage {
            tick: number,
            stages,
            whole_ns: act.received_ns - state.origin_ns,
            reaction_ns: planner.sent_ns - state.origin_ns,
            late_ticks,
        };
        for (stage, ns) in Stage::ALL.into_iter().zip(stages) {
            let had = match stage {
                Stage::ToPerception | Stage::Perception => belief.is_some(),
                Stage::Wait => self.real_time,
                _ => true,
            };
            if had {
                self.stages.record(stage.name(), ns);
            }
        }
        self.stages.record(WHOLE, passage.whole_ns);
        self.stages.record(REACTION, passage.reaction_ns);
        if self.passages.len() < MOST_PASSAGES {
            self.passages.push(passage);
        }
    }

    fn reads_beliefs(&self, source: u32) -> bool {
        self.processes.get(&source).is_some_and(|p| p.reads_beliefs)
    }

    /// The last command of a tick (of those that go by beliefs, if there are any) and the beliefs
    /// that it could have known.
    fn critical(&self, tick: &Tick) -> Option<(Stamp, Option<Stamp>)> {
        let last = |by_beliefs: bool| {
            tick.commands
                .values()
                .filter(|c| !by_beliefs || self.reads_beliefs(c.source))
                .max_by_key(|c| (c.sent_ns, c.source))
                .copied()
        };
        let planner = last(true).or_else(|| last(false))?;
        let belief = tick
            .belief
            .filter(|b| self.reads_beliefs(planner.source) && b.sent_ns <= planner.received_ns);
        Some((planner, belief))
    }

    /// The state before which the simulator took a command up.
    fn taken(&self, command: &Stamp) -> Option<(u64, Stamp)> {
        self.ticks
            .range(command.tick + 1..)
            .filter_map(|(at, tick)| Some((*at, tick.state?)))
            .find(|(_, state)| state.received_ns >= command.sent_ns)
    }

    /// The parts of every process's turn: awake, input taken, computed, written.
    fn turns(&mut self, tick: &Tick, state: &Stamp) {
        for (source, (first, last_sent)) in &tick.outputs {
            let Some(process) = self.processes.get(source) else {
                continue;
            };
            let input = if *source == state.source {
                None
            } else if process.reads_beliefs {
                tick.belief.or(Some(*state))
            } else {
                Some(*state)
            };
            let name = |part: &str| format!("{} {part}", process.kind);
            if let Some(woken) = input.and_then(|input| since(input.sent_ns, first.begun_ns)) {
                self.turns.record(&name("wakes up"), woken);
            }
            for (part, from, to) in [
                ("takes its input", first.begun_ns, first.received_ns),
                ("computes", first.received_ns, first.computed_ns),
                ("writes", first.computed_ns, *last_sent),
            ] {
                if let Some(took) = since(from, to) {
                    self.turns.record(&name(part), took);
                }
            }
        }
    }
}

/// Stages between readings of the clock that follow each other; `None` if they do not, or one is
/// missing.
fn stages(
    state: &Stamp,
    belief: Option<&Stamp>,
    planner: &Stamp,
    act: &Stamp,
    real_time: bool,
) -> Option<[u64; 7]> {
    let (perceived, believed) = match belief {
        Some(belief) => (belief.received_ns, belief.sent_ns),
        None => (state.sent_ns, state.sent_ns),
    };
    // In lock-step the simulator sleeps until the last command is there: all of it is the way.
    let woken = if real_time {
        act.begun_ns
            .clamp(planner.sent_ns, act.received_ns.max(planner.sent_ns))
    } else {
        planner.sent_ns
    };
    let times = [
        state.origin_ns,
        state.sent_ns,
        perceived,
        believed,
        planner.received_ns,
        planner.sent_ns,
        woken,
        act.received_ns,
    ];
    if times[0] == 0 || !times.is_sorted() {
        return None;
    }
    let mut stages = [0; 7];
    for (stage, pair) in stages.iter_mut().zip(times.windows(2)) {
        *stage = pair[1] - pair[0];
    }
    Some(stages)
}

#[cfg(test)]
mod tests;
