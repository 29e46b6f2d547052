//! Missions that fail, and disks that are full.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value as Json;

use super::{sandbox, sweep, sweep_json, table};
use crate::support::{PROTEAN, Sandbox};

/// An experiment one of whose cases starts a program that ends at once.
const FAILING: &str = r#"
name = "small"
scenario = "builtin:hello"
seeds = { first = 1, count = 2 }
[[cases]]
name = "good"
set.rules.time_limit = 1.0
[[cases]]
name = "bad"
set.rules.time_limit = 1.0
set.processes.evader_potential = { name = "liar", command = ["false"], robots = ["robot"] }
"#;

#[test]
fn failures_are_listed_with_the_command_that_repeats_them() {
    let sandbox = Sandbox::new();
    sandbox.file("small.toml", FAILING);
    let words = ["--allow-external", "--keep-logs", "failed"];
    let outcome = sweep(&sandbox, "out", &words);
    assert_eq!(outcome.code, Some(3), "{outcome}");
    for word in [
        "2 missions failed",
        "case bad, seed 1: process liar ended with exit code 1",
        "protean run hello --set rules.time_limit=1.0 --set 'processes.evader_potential={ name = \"liar\", command = [\"false\"], robots = [\"robot\"] }' --seed 1 --allow-external",
    ] {
        assert!(
            outcome.stdout.contains(word),
            "{word} is missing in\n{outcome}"
        );
    }
    let csv = table(&sandbox, "out");
    assert!(csv.contains("\nbad,1,failed,,,,,,"), "{csv}");
    assert!(csv.contains("\ngood,2,time_limit,1,0,0,1,1.0,"), "{csv}");
    let logs: Vec<PathBuf> = sandbox
        .files()
        .into_iter()
        .filter(|f| f.extension().is_some_and(|e| e == "mcap"))
        .collect();
    assert!(
        logs.iter().all(|log| log.to_string_lossy().contains("bad")),
        "{logs:?}"
    );
    // A failure is a result too, unless another try is asked for.
    let more = ["--allow-external"];
    assert_eq!(sweep_json(&sandbox, "out", &more, 3)["carried_out"], 0);
    let more = ["--allow-external", "--retry-failed"];
    assert_eq!(sweep_json(&sandbox, "out", &more, 3)["carried_out"], 2);
    assert_eq!(table(&sandbox, "out"), csv);
    sandbox.assert_nothing_left();
}

#[test]
fn a_mission_that_takes_too_long_is_given_up() {
    let sandbox = Sandbox::new();
    let text = "scenario = \"builtin:chase\"\nseeds = { first = 1, count = 1 }\n[run]\ntimeout_s = 1.0\n\
                [[cases]]\nname = \"endless\"\nset.run.dt = 0.0001\nset.rules.time_limit = 1e4\n";
    sandbox.file("small.toml", text);
    let summary = sweep_json(&sandbox, "out", &[], 3);
    let error = summary["failures"][0]["error"].as_str().unwrap();
    assert!(
        error.contains("did not end within 1 s of real time"),
        "{error}"
    );
    sandbox.assert_nothing_left();
}

#[test]
fn logs_are_kept_when_asked_for() {
    let sandbox = sandbox();
    sweep_json(&sandbox, "out", &["--keep-logs", "all", "--seeds", "1"], 0);
    let logs = sandbox.path().join("out/logs");
    let count = |folder: &Path| std::fs::read_dir(folder).map_or(0, Iterator::count);
    assert_eq!(count(&logs), 4);
    assert!(logs.join("3-shy-limit=3-seed=1.mcap").exists());
    sweep_json(&sandbox, "none", &["--seeds", "1"], 0);
    assert_eq!(count(&sandbox.path().join("none/logs")), 0);
    assert_eq!(table(&sandbox, "none"), table(&sandbox, "out"));
}

#[test]
fn a_full_disk_ends_the_sweep_and_keeps_what_is_done() {
    // A disk of a few pages, in a namespace where mounting is allowed.
    let sandbox = sandbox();
    let script = format!(
        "mkdir -p disk && mount -t tmpfs -o size=24k none disk && {PROTEAN} sweep small.toml \
         --in-process --seeds 1..40 --out disk/out --jobs 1 --quiet; code=$?; wc -l < disk/out/journal.jsonl; \
         mount -o remount,size=16m disk; {PROTEAN} sweep small.toml --in-process --seeds 1..3 \
         --out disk/out --quiet --json; exit $code",
    );
    let outcome = Command::new("unshare")
        .args(["--map-root-user", "--mount", "sh", "-c", &script])
        .current_dir(sandbox.path())
        .env("XDG_RUNTIME_DIR", sandbox.runtime_dir())
        .output();
    let outcome = match outcome {
        Ok(outcome) => outcome,
        Err(error) => {
            eprintln!("skipped: unshare: {error}");
            return;
        }
    };
    let (stdout, stderr) = (
        String::from_utf8_lossy(&outcome.stdout),
        String::from_utf8_lossy(&outcome.stderr),
    );
    if stderr.contains("unshare") || stderr.contains("mount:") {
        eprintln!("skipped: no namespace to mount in: {stderr}");
        return;
    }
    assert_eq!(outcome.status.code(), Some(1), "{stdout}\n{stderr}");
    for word in [
        "journal.jsonl: cannot be written: No space left",
        "free disk space and repeat the command",
    ] {
        assert!(stderr.contains(word), "{word} is missing in\n{stderr}");
    }
    let mut lines = stdout.lines();
    let kept: usize = lines.next().unwrap().trim().parse().unwrap();
    assert!(kept > 0, "{stdout}\n{stderr}");
    let again: Json = serde_json::from_str(lines.next().unwrap()).unwrap();
    assert_eq!(
        again["missions"].as_u64().unwrap(),
        kept as u64 + again["carried_out"].as_u64().unwrap()
    );
}
