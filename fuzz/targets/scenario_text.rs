//! Any text as a scenario whose map is not there: all else is read, overridden and checked, and what
//! is wrong is told. `scenario` lays out the ground as well.
#![no_main]

#[path = "support/text.rs"]
mod support;

use libfuzzer_sys::fuzz_target;
use scenario::Loader;
use scenario::files::Base;

fuzz_target!(|text: &str| {
    let (mut overrides, text) = support::split(text);
    overrides.push("world.map=nowhere.toml".to_owned());
    let problems = Loader::new(kinds::KINDS)
        .load_text("fuzz.toml", &text, &Base::Nothing, &overrides, None)
        .expect_err("a scenario without a map");
    assert!(!problems.is_empty() && !problems.to_string().is_empty());
});
