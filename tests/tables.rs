//! Tables in the packages that read them.

use serde_json::Value as Json;

use crate::support::{Sandbox, python};

/// Missions with an evader that may escape early: some columns begin empty.
const SWEEP: &str = r#"
scenario = "builtin:chase"
seeds = { first = 1, count = 2 }

[parameters.speed]
title = "speed"
set = "teams.police.limits.v_max"

[grid]
speed = [1, 1.5]
"#;

#[test]
fn pandas_polars_and_duckdb_read_every_table() {
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.path().join("tables")).unwrap();
    // A belief has hundreds of particles, and every table is written three times.
    for (name, limit) in [
        ("chase", "rules.time_limit=0.5"),
        ("chase_referee", "rules.time_limit=0.5"),
        ("patrol_square", "rules.time_limit=4"),
        ("coverage_polygons", "rules.time_limit=4"),
        ("popup", "rules.time_limit=4"),
    ] {
        let (log, out) = (format!("{name}.mcap"), format!("tables/{name}"));
        let run = sandbox.protean(["run", name, "--in-process", "--out", &log]);
        run.set(limit).json();
        let export = |format| {
            let words = ["export", &log, "--out", &out, "--force", "--format", format];
            sandbox.protean(words).json()
        };
        export("parquet");
        for (topic, table) in export("csv")["tables"].as_object().unwrap() {
            if !topic.contains('/') {
                // No topic: its rows are measured.
                continue;
            }
            let printed = sandbox.protean(["cat", &log, topic]).run();
            let file = table["file"].as_str().unwrap().replace(".csv", ".jsonl");
            sandbox.file(&file, &printed.stdout);
        }
    }
    sandbox.file("sweep.toml", SWEEP);
    let sweep = sandbox.protean(["sweep", "sweep.toml", "--out", "tables/sweep"]);
    assert_eq!(
        sweep.set("rules.time_limit=2").json()["missing"],
        serde_json::json!([])
    );
    let read: Option<Json> = python::call_with(python::PACKAGES, "read_tables.py", sandbox.path());
    let Some(read) = read else { return };
    assert_eq!(read["wrong"], serde_json::json!([]));
    let counts = &read["counts"];
    assert!(
        counts["csv"].as_u64() > Some(40) && counts["jsonl"].as_u64() > Some(35),
        "{read}"
    );
}
