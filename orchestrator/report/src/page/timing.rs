//! Latencies of the run, from the stamps of its messages.

use std::collections::BTreeMap;
use std::path::Path;

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::topics::TopicId;
use statistics::{Distribution, LogHistogram, Percentiles};

use crate::picture::log_run::LoggedRun;
use mission::plan::Plan;
use mission::recording;
use recorder::chain::Chain;
use scenario::Loader;
use scenario::files::Base;
use scenario::kind::Kind;

/// Number of bins of a histogram per power of ten.
pub(super) const PER_DECADE: u32 = 8;

/// Latency collector that starts once the processes are known.
#[derive(Debug)]
pub(super) struct Timing {
    timed: Vec<TopicId>,
    kinds: &'static [Kind],
    chain: Option<Chain>,
    is_begun: bool,
}

impl Consumer<LoggedRun> for Timing {
    fn topics(&self) -> &[TopicId] {
        &self.timed
    }

    fn message(&mut self, message: &LoggedMessage<'_>, run: &mut LoggedRun) {
        if !self.is_begun {
            self.is_begun = true;
            match chain_of(&run.facts.scenario_text, self.kinds) {
                Ok(chain) => self.chain = Some(chain),
                Err(reason) => run.note(format!(
                    "no latency histograms: the processes of the log are unknown: {reason}"
                )),
            }
        }
        if let Some(chain) = &mut self.chain {
            chain.message(message, &mut ());
        }
    }
}

/// Returns the chain of the processes of this scenario.
///
/// # Errors
/// The reason for which this version cannot parse the scenario.
fn chain_of(scenario: &str, kinds: &[Kind]) -> Result<Chain, String> {
    let loaded = Loader::new(kinds).load_text("scenario.toml", scenario, &Base::Nothing, &[], None);
    let scenario = loaded.map_err(|problems| problems.to_string())?;
    let plan = Plan::new(&scenario, Path::new(""), "", "").map_err(|e| e.to_string())?;
    Ok(Chain::new(&recording::processes(&plan)))
}

impl Timing {
    /// Returns an empty collector; the scenario in the log may name these kinds of processes.
    pub(super) fn new(kinds: &'static [Kind]) -> Self {
        Self {
            kinds,
            chain: None,
            is_begun: false,
            timed: Chain::timed(),
        }
    }

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
