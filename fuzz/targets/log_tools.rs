//! Arbitrary bytes as input of commands that write logs; the first byte selects the command. The output is a
//! complete log.
#![no_main]

mod support;

use libfuzzer_sys::fuzz_target;
use log_tools::{ExportOptions, FilterOptions, LogInfo, export, filter, recover};
use mcap_log::Topics;
use tables::Format;

fuzz_target!(|bytes: &[u8]| {
    let Some((how, bytes)) = bytes.split_first() else {
        return;
    };
    let folder = tempfile::tempdir_in("/dev/shm").expect("a directory");
    let out = folder.path().join("out");
    let watch = &mut support::watch();
    support::with_log(bytes, |log| {
        let made = match how % 4 {
            0 => recover(log, &out, false, watch).is_ok(),
            1 => {
                let options = FilterOptions {
                    start_s: Some(f64::from(*how) / 256.0),
                    ..FilterOptions::default()
                };
                filter(log, &out, &options, watch).is_ok()
            }
            _ => {
                let options = ExportOptions {
                    format: Format::Csv,
                    topics: Topics::default(),
                    force: false,
                };
                let _ = export(log, &out, &options, watch);
                false
            }
        };
        if made {
            let info = LogInfo::read(&out, watch).expect("a log");
            assert!(info.condition.is_whole(), "{:?}", info.condition);
        }
    });
});
