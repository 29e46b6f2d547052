//! Subscribers that are there and sleep.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use ipc_types::bus::{Bus, Subscriber};
use ipc_types::topics::Scan;

use super::transport::raw_service;
use super::{END, MODE, READY, SinkConfig};
use crate::bench::shared::{SharedWords, sleep_while};
use crate::bench::{BenchError, raw};

/// Subscribes, and sleeps until the end.
pub fn crowd(config: &Path) -> ExitCode {
    match SinkConfig::load(config).and_then(|config| crowd_with(&config)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn crowd_with(config: &SinkConfig) -> Result<(), BenchError> {
    let stop = Arc::new(AtomicBool::new(false));
    kit::guard::watch_parent(Arc::clone(&stop))
        .map_err(BenchError::system("cannot start the parent guard"))?;
    let space = config.space()?;
    let bus = Bus::join(&space, config.bus_options(), "bench-crowd")?;
    let ours: Subscriber<Scan> = bus.subscriber()?;
    ours.update_connections()?;
    let node = raw::node(&space)?;
    let _raw = raw_service(&node, config)?
        .subscriber_builder()
        .create()
        .map_err(BenchError::raw("subscribe"))?;
    let page = SharedWords::open(&config.prefix)?;
    page.word(READY).fetch_add(1, Ordering::SeqCst);
    loop {
        let mode = page.word(MODE).load(Ordering::SeqCst);
        if mode == END || stop.load(Ordering::Relaxed) {
            return Ok(());
        }
        // The mode changes between blocks, not within them: nobody here takes time from those
        // who are measured.
        sleep_while(page.word(MODE), mode, Duration::from_secs(1));
    }
}
