//! Any bytes as a file of planning instances.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = plan::file::parse(bytes);
});
