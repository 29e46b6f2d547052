//! Test of reading a log with the Python packages of MCAP and ROS: lossless and viewer topics.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::made_up::run;
use super::{options, record};

/// Returns the interpreter with the readers, or the reason why it is missing.
fn python() -> Result<PathBuf, String> {
    let script =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../ipc_types/tests/python/prepare.py");
    // Beside `deps`, the directory of the test: `CARGO_TARGET_TMPDIR` of integration tests.
    let test = std::env::current_exe().map_err(|e| e.to_string())?;
    let target = test
        .ancestors()
        .nth(3)
        .ok_or("the test is not in a target directory")?;
    let output = Command::new("python3")
        .arg(script)
        .arg(target.join("tmp"))
        .output()
        .map_err(|e| format!("python3: {e}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).trim().to_owned());
    }
    Ok(PathBuf::from(
        String::from_utf8_lossy(&output.stdout).trim(),
    ))
}

#[test]
fn python_decodes_every_message_of_the_log() {
    let python = match python() {
        Ok(python) => python,
        Err(reason) => {
            // Written to stderr directly, because the test harness captures output.
            let note = format!("\nSKIPPED: python_decodes_every_message_of_the_log: {reason}\n");
            std::io::stderr().write_all(note.as_bytes()).unwrap();
            return;
        }
    };
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let summary = record(&path, &options(), &run(12, 1_000), usize::MAX);
    let output = Command::new(python)
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/tests/python/read_log.py"))
        .arg(&path)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8(output.stdout).unwrap();
    for (topic, count) in &summary.topics {
        let line = format!("{topic} cdr {}", count.messages);
        assert!(
            text.lines().any(|l| l == line),
            "{line} missing in:\n{text}"
        );
    }
    for line in [
        "unsorted 0",
        "particles 40 780.0",
        "frames police_1 police_2 baddie_1",
        "log baddie_1 caught by police_1",
        "markers body heading name body heading name body heading name",
    ] {
        assert!(
            text.lines().any(|l| l == line),
            "{line} missing in:\n{text}"
        );
    }
}
