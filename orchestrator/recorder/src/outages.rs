//! Failures and outages of processes over a run.

use std::collections::BTreeMap;

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::process::ProcessEvent;
use ipc_types::topics::{ProcessEvents, TopicId};

use super::run_info::ProcessInfo;
use super::summary::{Outage, OutcomePart, ProcessOutcome, Summary, seconds};

/// Collects [`ProcessOutcome`]s.
#[derive(Debug)]
pub(super) struct Outages {
    names: BTreeMap<u32, String>,
    tick_period_ns: u64,
    failed: BTreeMap<u32, ProcessOutcome>,
}

impl Consumer for Outages {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::ProcessEvents]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        if let Some((_, events)) = message.view::<ProcessEvents>() {
            events.for_each(|event| self.add(&event));
        }
    }
}

impl OutcomePart for Outages {
    fn finish(self: Box<Self>, summary: &mut Summary) {
        summary.processes = self.outcomes(summary.ticks);
    }
}

impl Outages {
    pub(super) fn new(processes: &[ProcessInfo], tick_period_ns: u64) -> Self {
        let names = processes.iter().map(|p| (p.index, p.name.clone()));
        Self {
            names: names.collect(),
            tick_period_ns,
            failed: BTreeMap::new(),
        }
    }

    fn add(&mut self, event: &ProcessEvent) {
        let name = || match self.names.get(&event.process) {
            Some(name) => name.clone(),
            None => format!("process {}", event.process),
        };
        let outcome = self
            .failed
            .entry(event.process)
            .or_insert_with(|| ProcessOutcome {
                name: name(),
                restarts: 0,
                ticks_absent: 0,
                given_up: false,
                outages: Vec::new(),
            });
        match event.kind {
            ProcessEvent::LEFT => outcome.outages.push(Outage {
                left_tick: event.tick,
                left_time_s: seconds(event.tick.saturating_mul(self.tick_period_ns)),
                reason: event.reason_text(),
                back_tick: None,
            }),
            ProcessEvent::BACK => {
                outcome.restarts += 1;
                if let Some(outage) = outcome.outages.last_mut() {
                    outage.back_tick = Some(event.tick);
                }
            }
            _ => outcome.given_up = true,
        }
    }

    /// Returns all outcomes; the run ended at tick `end`.
    fn outcomes(self, end: u64) -> Vec<ProcessOutcome> {
        let absent = |outcome: &ProcessOutcome| {
            let mut from = 0;
            let mut absent = 0;
            for outage in &outcome.outages {
                // A failed restart extends the outage of the process.
                let back = outage.back_tick.unwrap_or(end);
                absent += back.saturating_sub(outage.left_tick.max(from));
                from = from.max(back);
            }
            absent
        };
        let outcomes = self.failed.into_values();
        outcomes
            .map(|outcome| ProcessOutcome {
                ticks_absent: absent(&outcome),
                ..outcome
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_without_a_process_are_counted_once() {
        let mut outages = Outages::new(&[], 1_000_000);
        let event = |kind, tick| ProcessEvent {
            kind,
            tick,
            process: 3,
            ..ProcessEvent::default()
        };
        for (kind, tick) in [
            (ProcessEvent::LEFT, 10),
            (ProcessEvent::BACK, 20),
            (ProcessEvent::LEFT, 30),
            (ProcessEvent::LEFT, 35),
            (ProcessEvent::GIVEN_UP, 35),
        ] {
            outages.add(&event(kind, tick));
        }
        let found = outages.outcomes(50);
        let [outcome] = &found[..] else {
            panic!("{found:?}");
        };
        assert_eq!((outcome.restarts, outcome.ticks_absent), (1, 10 + 20));
        assert!(outcome.given_up && outcome.name == "process 3");
        assert_eq!(outcome.outages[0].back_tick, Some(20));
        assert_eq!(outcome.outages[2].left_time_s, 0.035);
    }
}
