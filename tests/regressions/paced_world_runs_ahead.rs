//! With `--pace`, the world ran up to 254 ticks ahead of its clock, and its log was forty times as long.

use std::time::{Duration, Instant};

use crate::support::Sandbox;

#[test]
fn a_paced_world_is_held_back_and_its_log_is_no_longer_than_another() {
    let sandbox = Sandbox::new();
    let run = |log: &str, pace: &[&str]| {
        let begun = Instant::now();
        let words = ["run", "chase", "--quiet", "--out", log];
        let call = sandbox.protean(words.into_iter().chain(pace.iter().copied()));
        call.set("rules.time_limit=3").json();
        let length = std::fs::metadata(sandbox.path().join(log)).unwrap().len();
        (begun.elapsed(), length)
    };
    let (_, free) = run("free.mcap", &[]);
    let (lasted, paced) = run("paced.mcap", &["--pace", "1"]);
    // All but the few ticks that the recorder may lag behind.
    assert!(lasted > Duration::from_secs(2), "{lasted:?}");
    assert!(paced < free + free / 4, "{paced} bytes instead of {free}");
    sandbox.assert_nothing_left();
}
