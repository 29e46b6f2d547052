//! Any text as a scenario that came in a log: it is resolved or refused, and what is resolved
//! resolves to itself once written out. Lines that begin with `--set ` are overrides.
#![no_main]

use libfuzzer_sys::fuzz_target;
use orchestrator::scenario::{Loader, files::Base};

/// Maps of more cells only make it slow.
const MAX_CELLS: usize = 40_000;

fuzz_target!(|text: &str| {
    let (overrides, lines): (Vec<&str>, Vec<&str>) =
        text.lines().partition(|line| line.starts_with("--set "));
    let overrides: Vec<String> = overrides.iter().map(|line| line[6..].to_owned()).collect();
    let mut text = lines.join("\n");
    if text.contains("bounds") {
        text = text.replace("max_cells", "ignored");
        text = text.replace("bounds", &format!("max_cells = {MAX_CELLS}\nbounds"));
    }
    let loader = Loader::default();
    let load = |text: &str, overrides: &[String]| {
        loader.load_text("fuzz.toml", text, &Base::Nothing, overrides, None)
    };
    match load(&text, &overrides) {
        Err(problems) => assert!(!problems.to_string().is_empty()),
        Ok(scenario) => {
            let written = scenario.to_toml();
            let again = load(&written, &[]).expect("what was written out loads");
            assert_eq!(again.to_toml(), written);
        }
    }
});
