//! Latencies of the run, from the stamps of its messages.

use std::collections::BTreeMap;
use std::path::Path;

use ipc_types::stamp::Stamp;

use crate::mission::plan::Plan;
use crate::mission::recording;
use crate::recorder::{Latency, Role};
use crate::scenario::Loader;
use crate::scenario::files::Base;
use crate::statistics::{LogHistogram, Percentiles};

/// Parts of a histogram per power of ten.
pub(super) const PER_DECADE: u32 = 8;

/// Collects latencies once the processes are known.
#[derive(Debug, Default)]
pub(super) struct Timing(Option<Latency>);

impl Timing {
    /// Takes the run's processes from its scenario; fails, with the reason, if this version does
    /// not understand it.
    pub(super) fn processes_of(&mut self, scenario: &str) -> Result<(), String> {
        let loaded =
            Loader::default().load_text("scenario.toml", scenario, &Base::Nothing, &[], None);
        let scenario = loaded.map_err(|problems| problems.to_string())?;
        let plan = Plan::new(&scenario, Path::new(""), "", "").map_err(|e| e.to_string())?;
        self.0 = Some(Latency::new(&recording::processes(&plan)));
        Ok(())
    }

    pub(super) fn message(&mut self, topic: &str, stamp: &Stamp) {
        if let Some(latency) = &mut self.0 {
            latency.message(Role::of(topic), stamp);
        }
    }

    /// Percentiles [µs] and histograms by name.
    pub(super) fn finish(&mut self) -> BTreeMap<String, (Percentiles, LogHistogram)> {
        let Some(latency) = &mut self.0 else {
            return BTreeMap::new();
        };
        let percentiles = latency.finish();
        let mut histograms = latency.histograms(PER_DECADE);
        percentiles
            .into_iter()
            .filter_map(|(name, p)| {
                let histogram = histograms.remove(&name)?;
                Some((name, (p, histogram)))
            })
            .collect()
    }
}
