//! Any bytes as a log, read to its end: what `info`, `recover`, `filter`, `export` and `replay` do
//! first.
#![no_main]

mod support;

use libfuzzer_sys::fuzz_target;
use log_tools::LogInfo;

fuzz_target!(|bytes: &[u8]| {
    support::with_log(bytes, |path| {
        if let Ok(info) = LogInfo::read(path, &mut support::watch()) {
            assert!(info.condition.file_bytes == bytes.len() as u64);
            assert!(!log_tools::info_text(&info).is_empty());
        }
    });
});
