//! The engines of a sweep: processes, and missions inside the program.

use super::{MISSIONS, sandbox, sweep_json, table, undisturbed};

#[test]
fn without_processes_the_table_is_the_same() {
    let sandbox = sandbox();
    let whole = undisturbed();
    let summary = sweep_json(&sandbox, "inside", &["--in-process"], 0);
    assert_eq!(summary["carried_out"], MISSIONS);
    assert_eq!(table(&sandbox, "inside"), whole);
    // Begun with processes, gone on with inside one.
    sweep_json(&sandbox, "mixed", &["--shard", "1/2"], 0);
    sweep_json(&sandbox, "mixed", &["--in-process"], 0);
    assert_eq!(table(&sandbox, "mixed"), whole);
}
