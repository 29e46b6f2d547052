//! Pages in a real browser: headless Chromium, if this machine has it.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value as Json;

use super::skipped;

/// Programs that are Chromium.
const BROWSERS: [&str; 4] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
];

/// Exit code of `studio.py` where Studio cannot be had.
const CANNOT: i32 = 75;

/// Opens a page and takes these steps (see `python/browse.py`); `None`, and a note on stderr, if
/// this machine has no browser.
pub fn browse(page: &Path, steps: &Json) -> Option<Json> {
    let what = format!("opening {} in a browser", page.display());
    run(&what, "browse.py", steps, |command| command.arg(page))
}

/// Opens a log or a live run in Foxglove Studio with the layout that is shipped, at a time of the
/// log (s), and takes these steps; `None`, and a note, if this machine cannot.
pub fn studio(source: &str, time_s: f64, steps: &Json) -> Option<Json> {
    let what = format!("opening {source} in Foxglove Studio");
    run(&what, "studio.py", steps, |command| {
        command
            .arg(Path::new(env!("CARGO_TARGET_TMPDIR")).join("studio"))
            .arg(layout())
            .arg(source)
            .arg(time_s.to_string())
    })
}

/// The layout for Foxglove.
pub fn layout() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/foxglove-layout.json")
}

fn run(
    what: &str,
    script: &str,
    steps: &Json,
    arguments: impl FnOnce(&mut Command) -> &mut Command,
) -> Option<Json> {
    let works = |program: &&str| {
        let version = Command::new(program).arg("--version").output();
        version.is_ok_and(|output| output.status.success())
    };
    let python = works(&"python3");
    let Some(browser) = BROWSERS.iter().find(|b| works(b)).filter(|_| python) else {
        skipped(what, &format!("needs python3 and one of {BROWSERS:?}"));
        return None;
    };
    let mut command = Command::new("python3");
    command
        .arg(
            Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("python")
                .join(script),
        )
        .arg(browser)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = arguments(&mut command).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(steps.to_string().as_bytes()).unwrap();
    drop(stdin);
    let output = child.wait_with_output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(CANNOT) {
        skipped(what, errors.trim());
        return None;
    }
    assert!(output.status.success(), "{errors}");
    Some(serde_json::from_slice(&output.stdout).unwrap())
}
