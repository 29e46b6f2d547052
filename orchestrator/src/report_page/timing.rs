//! Latencies of the run, from the stamps of its messages.

use std::collections::BTreeMap;
use std::path::Path;

use ipc_types::consumer::{Consumer as _, LoggedMessage};
use statistics::{Distribution, LogHistogram, Percentiles};

use crate::mission::plan::Plan;
use crate::mission::recording;
use crate::recorder::chain::Chain;
use crate::scenario::Loader;
use crate::scenario::files::Base;

/// Parts of a histogram per power of ten.
pub(super) const PER_DECADE: u32 = 8;

/// Collects latencies once the processes are known.
#[derive(Debug, Default)]
pub(super) struct Timing(Option<Chain>);

impl Timing {
    /// Takes the run's processes from its scenario; fails, with the reason, if this version does
    /// not understand it.
    pub(super) fn processes_of(&mut self, scenario: &str) -> Result<(), String> {
        let loaded =
            Loader::default().load_text("scenario.toml", scenario, &Base::Nothing, &[], None);
        let scenario = loaded.map_err(|problems| problems.to_string())?;
        let plan = Plan::new(&scenario, Path::new(""), "", "").map_err(|e| e.to_string())?;
        self.0 = Some(Chain::new(&recording::processes(&plan)));
        Ok(())
    }

    pub(super) fn message(&mut self, message: &LoggedMessage<'_>) {
        if let Some(chain) = &mut self.0
            && message.topic.facts().timed
        {
            chain.message(message, &mut ());
        }
    }

    /// Percentiles [µs] and histograms by name.
    pub(super) fn finish(&mut self) -> BTreeMap<String, (Percentiles, LogHistogram)> {
        let Some(chain) = &mut self.0 else {
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
