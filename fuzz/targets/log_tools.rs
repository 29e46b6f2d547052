//! Arbitrary bytes as input of commands that write logs; the first byte selects the command. The output is a
//! complete log.
#![no_main]

mod support;

use libfuzzer_sys::fuzz_target;
use log_tools::{ExportOptions, LogInfo, export, recover};
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
        if how % 2 == 0 {
            if recover(log, &out, false, watch).is_ok() {
                let info = LogInfo::read(&out, watch).expect("a log");
                assert!(info.condition.is_whole(), "{:?}", info.condition);
            }
        } else {
            let options = ExportOptions {
                format: Format::Csv,
                topics: Topics::default(),
                force: false,
            };
            let _ = export(log, &out, &options, watch);
        }
    });
});
