//! Any text as a scenario that came in a log: it is resolved or refused; of what is resolved, one in
//! [`WRITTEN`] is written out, which must resolve to the same. Lines that begin with `--set ` are
//! overrides.
#![no_main]

#[path = "support/sampled.rs"]
mod sampled;
#[path = "support/text.rs"]
mod support;

use libfuzzer_sys::fuzz_target;
use scenario::Loader;
use scenario::files::Base;

/// Maps of more cells only make it slow; so do the built-in ones at their own resolution.
const SMALL: [(&str, &str); 2] = [
    ("vector", "world.map.vector.max_cells=400"),
    ("builtin:", "world.resolution=1.0"),
];
const WRITTEN: u64 = 8;

fuzz_target!(|text: &str| {
    let (mut overrides, text) = support::split(text);
    let small = SMALL.iter().find(|(map, _)| text.contains(map));
    overrides.extend(small.map(|(_, limit)| (*limit).to_owned()));
    let loader = Loader::new(kinds::KINDS);
    let load = |text: &str, overrides: &[String]| {
        loader.load_text("fuzz.toml", text, &Base::Nothing, overrides, None)
    };
    match load(&text, &overrides) {
        Err(problems) => assert!(!problems.to_string().is_empty()),
        Ok(scenario) if sampled::is_chosen(text.as_bytes(), WRITTEN) => {
            let written = scenario.to_toml();
            let again = load(&written, &[]).expect("what was written out loads");
            assert_eq!(again.to_toml(), written);
        }
        Ok(_) => {}
    }
});
