//! Latencies of the run, from the stamps of its messages.

use std::collections::BTreeMap;

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::topics::TopicId;
use recorder::chain::Chain;
use statistics::{Distribution, LogHistogram, Percentiles};

use crate::run_model::LoggedRun;

/// Number of bins of a histogram per power of ten.
pub const PER_DECADE: u32 = 8;

/// Latency collector that starts once the processes are known.
#[derive(Debug, Clone)]
pub struct Timing {
    timed: Vec<TopicId>,
    chain: Option<Chain>,
    is_begun: bool,
}

impl Default for Timing {
    fn default() -> Self {
        Self {
            timed: Chain::timed(),
            chain: None,
            is_begun: false,
        }
    }
}

impl Consumer<LoggedRun> for Timing {
    fn topics(&self) -> &[TopicId] {
        &self.timed
    }

    fn message(&mut self, message: &LoggedMessage<'_>, run: &mut LoggedRun) {
        if !self.is_begun {
            self.is_begun = true;
            match &run.facts.run {
                Some(described) => self.chain = Some(Chain::new(&described.processes)),
                None => run.note(
                    "no latency histograms, fields of view and tasks: the log does not describe its run"
                        .to_owned(),
                ),
            }
        }
        if let Some(chain) = &mut self.chain {
            chain.message(message, &mut ());
        }
    }
}

impl Timing {
    /// Returns percentiles (µs) and histograms by name.
    pub(super) fn finish(&mut self) -> BTreeMap<String, (Percentiles, LogHistogram)> {
        let Some(chain) = &mut self.chain else {
            return BTreeMap::new();
        };
        chain.settle();
        let of = |all: &Distribution| (all.percentiles(), all.log_histogram(PER_DECADE));
        let latencies = chain.latencies();
        latencies
            .map(|(name, all)| (name.clone(), of(all)))
            .collect()
    }
}
