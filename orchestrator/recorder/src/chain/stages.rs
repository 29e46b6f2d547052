//! The stages of a tick.
//!
//! The *last* command of every tick is traced back to the state: the command of a process that reads beliefs
//! if there is one, then through perception. Each stage ends where the next one begins, by one clock, so that
//! the stages add up to sense-to-act.

use ipc_types::stamp::Stamp;
use statistics::Distributions;

use super::{Chain, Output, Tick, since};

/// A stage of sense-to-act.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// The simulator writes scans, map and state.
    Publish,
    /// Transport of the state to perception, wake-up included.
    ToPerception,
    /// Perception computes and writes its beliefs.
    Perception,
    /// Transport of the beliefs (without perception: of the state) to the planner.
    ToPlanner,
    /// The planner computes and writes the command.
    Planner,
    /// In real time: the command waits until the tick ends.
    Wait,
    /// Transport of the command to the simulator, wake-up included.
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

    /// Returns the name in reports.
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

/// Name of the sum of all stages.
pub const WHOLE: &str = "sense to act";
/// Name of the time until the command has been sent.
pub const REACTION: &str = "sense to command";

/// Stages of one tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Passage {
    /// The tick.
    pub tick: u64,
    /// Times of the stages, in the order of [`Stage::ALL`] (ns); 0 for absent stages.
    pub stages: [u64; 7],
    /// Time from the beginning of the state until the simulator received the last command (ns).
    pub whole_ns: u64,
    /// Time from the beginning of the state until the last command was sent (ns).
    pub reaction_ns: u64,
    /// Delay of the last command (ticks); 0 if in time.
    pub late_ticks: u64,
}

/// Counts of ticks by outcome.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Answers {
    /// Number of world states.
    pub ticks: u64,
    /// Ticks whose commands were all received in time.
    pub in_time: u64,
    /// Ticks whose last command was received in a later tick: deadline misses.
    pub late: u64,
    /// Ticks without a command: planners were still busy with an earlier tick.
    pub unanswered: u64,
    /// Answered ticks whose planner had not received the beliefs of the tick.
    pub without_beliefs: u64,
}

/// Name of the jitter of ticks.
pub const TICK_JITTER: &str = "tick off its time";

/// Maximum number of kept passages.
const MAX_PASSAGES: usize = 200_000;

/// Details of a log beside hops and steps.
#[derive(Debug, Clone, Default)]
pub struct Detail {
    /// Wall-clock time between two ticks (ns); `None` in lock-step.
    period_ns: Option<u64>,
    last_state: Option<Stamp>,
    /// Outcomes of ticks.
    pub answers: Answers,
    /// Parts of the turn of every process, by names such as `pursuer wakes up`.
    pub turns: Distributions,
    /// |time between two states − period|; in real time only.
    pub period: Distributions,
    /// Every tick that could be traced.
    pub passages: Vec<Passage>,
}

impl Detail {
    pub fn new(period_ns: Option<u64>) -> Self {
        Self {
            period_ns,
            ..Self::default()
        }
    }

    /// Records the deviation of the time between two states from the period.
    pub(super) fn ticked(&mut self, state: &Stamp) {
        if let Some(before) = self.last_state.replace(*state)
            && let Some(period_ns) = self.period_ns
            && before.tick.checked_add(1) == Some(state.tick)
            && let Some(between) = since(before.origin_ns, state.origin_ns)
        {
            let off = between.abs_diff(period_ns);
            self.period.record(TICK_JITTER, off);
        }
    }

    /// Records the parts of a turn: wake-up, input, computing, output.
    fn turn(&mut self, kind: &str, input: Option<&Stamp>, first: &Stamp, last_sent_ns: u64) {
        let woken = input.map_or(0, |input| input.sent_ns);
        for (part, from, to) in [
            ("wakes up", woken, first.begun_ns),
            ("takes its input", first.begun_ns, first.received_ns),
            ("computes", first.received_ns, first.computed_ns),
            ("writes", first.computed_ns, last_sent_ns),
        ] {
            if let Some(took) = since(from, to) {
                self.turns.record(&format!("{kind} {part}"), took);
            }
        }
    }
}

impl Chain {
    /// Traces a tick that has a state and is not the last.
    pub(super) fn measure_stages(&mut self, number: u64, tick: &Tick, state: &Stamp) {
        if let Some(detail) = &mut self.detail {
            detail.answers.ticks += 1;
            for output in &tick.outputs {
                if let (Some(process), Some(first)) =
                    (self.processes.get(&output.source), &output.first)
                {
                    let input = tick.input(process, output.source);
                    detail.turn(&process.kind, input.as_ref(), first, output.last_sent_ns);
                }
            }
        }
        let Some((planner, belief)) = self.critical(tick) else {
            if let Some(detail) = &mut self.detail {
                detail.answers.unanswered += 1;
            }
            return;
        };
        let lacks_belief =
            belief.is_none() && tick.belief.is_some() && self.reads_beliefs(planner.source);
        let act = self.taken(&planner);
        if let Some(detail) = &mut self.detail {
            detail.answers.without_beliefs += u64::from(lacks_belief);
            match act {
                Some((at, _)) if at == number + 1 => detail.answers.in_time += 1,
                Some(_) => detail.answers.late += 1,
                // The run ended earlier.
                None => {}
            }
        }
        let real_time = self.detail.as_ref().is_some_and(|d| d.period_ns.is_some());
        let Some((at, act)) = act else { return };
        let Some(stages) = stages(state, belief.as_ref(), &planner, &act, real_time) else {
            return;
        };
        let whole_ns = act.received_ns - state.origin_ns;
        self.stages.record(WHOLE, whole_ns);
        let Some(detail) = &mut self.detail else {
            return;
        };
        let passage = Passage {
            tick: number,
            stages,
            whole_ns,
            reaction_ns: planner.sent_ns - state.origin_ns,
            late_ticks: at.saturating_sub(number + 1),
        };
        for (stage, ns) in Stage::ALL.into_iter().zip(stages) {
            let had = match stage {
                Stage::ToPerception | Stage::Perception => belief.is_some(),
                Stage::Wait => real_time,
                _ => true,
            };
            if had {
                self.stages.record(stage.name(), ns);
            }
        }
        self.stages.record(REACTION, passage.reaction_ns);
        if detail.passages.len() < MAX_PASSAGES {
            detail.passages.push(passage);
        }
    }

    fn reads_beliefs(&self, source: u32) -> bool {
        self.processes.get(&source).is_some_and(|p| p.reads_beliefs)
    }

    /// Returns the last command of a tick (of processes that read beliefs, if there are any) and the beliefs
    /// that were available for it.
    fn critical(&self, tick: &Tick) -> Option<(Stamp, Option<Stamp>)> {
        let last = |by_beliefs: bool| {
            tick.outputs
                .iter()
                .filter_map(|output: &Output| output.command)
                .filter(|c| !by_beliefs || self.reads_beliefs(c.source))
                .max_by_key(|c| (c.sent_ns, c.source))
        };
        let planner = last(true).or_else(|| last(false))?;
        let belief = tick
            .belief
            .filter(|b| self.reads_beliefs(planner.source) && b.sent_ns <= planner.received_ns);
        Some((planner, belief))
    }

    /// Returns tick and stamp of the state before which the simulator received a command.
    fn taken(&self, command: &Stamp) -> Option<(u64, Stamp)> {
        self.ticks
            .range(command.tick + 1..)
            .filter_map(|(at, tick)| Some((*at, tick.state?)))
            .find(|(_, state)| state.received_ns >= command.sent_ns)
    }
}

/// Returns the stages between ascending clock readings; `None` if they are not ascending or one is missing.
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
    // In lock-step the simulator sleeps until the last command arrives: the whole time is transport.
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
