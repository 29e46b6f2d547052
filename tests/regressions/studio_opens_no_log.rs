//! Foxglove Studio opened no log in which a chunk had no messages.

use crate::support::Sandbox;

#[test]
fn every_chunk_has_messages_because_studio_opens_no_log_without() {
    let sandbox = Sandbox::new();
    // Nothing stands there from the beginning, so that nothing is drawn before the first tick.
    sandbox
        .protean(["run", "patrol_octagon", "--out", "run.mcap"])
        .set("rules.time_limit=2")
        .json();
    sandbox
        .protean(["recover", "run.mcap", "--out", "again.mcap"])
        .json();
    for log in ["run.mcap", "again.mcap"] {
        let bytes = std::fs::read(sandbox.path().join(log)).unwrap();
        let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
        assert!(!summary.chunk_indexes.is_empty());
        for chunk in &summary.chunk_indexes {
            assert!(!chunk.message_index_offsets.is_empty(), "{log}: {chunk:?}");
        }
    }
}
