//! Other users of the machine.

use std::io::Write as _;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::changed;
use crate::support::{SOON, Sandbox, until};

/// The id of a user that owns no file.
const OTHER_USER: &str = "65534";

/// Returns `true` if that user can read a file; `None`, and a note on stderr, if the test cannot run as another
/// user.
fn others_can_read(path: &Path) -> Option<bool> {
    let ask = |path: &Path| {
        Command::new("setpriv")
            .args([
                "--reuid",
                OTHER_USER,
                "--regid",
                OTHER_USER,
                "--clear-groups",
            ])
            .args(["head", "-c", "1"])
            .arg(path)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status()
            .is_ok_and(|status| status.success())
    };
    // A world-readable file must be readable, otherwise the check is meaningless.
    if rustix::process::getuid().is_root() && ask(Path::new("/etc/passwd")) {
        return Some(ask(path));
    }
    let note = "\nSKIPPED: looking at a run as another user: needs root and setpriv\n";
    std::io::stderr().write_all(note.as_bytes()).unwrap();
    None
}

fn mode(path: &Path) -> u32 {
    path.symlink_metadata().unwrap().permissions().mode() & 0o777
}

fn below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.path().is_dir() {
            found.extend(below(&entry.path()));
        }
        found.push(entry.path());
    }
    found
}

#[test]
fn another_user_sees_nothing_of_a_run() {
    let sandbox = Sandbox::new();
    // So that what keeps others out is the run's own doing.
    let open = std::fs::Permissions::from_mode(0o755);
    for folder in [sandbox.path(), &sandbox.runtime_dir()] {
        std::fs::set_permissions(folder, open.clone()).unwrap();
    }
    sandbox.file(
        "long.toml",
        changed("time_limit = 1.0", "time_limit = 10000.0"),
    );
    // A umask that forbids nothing.
    let running = sandbox
        .protean([
            "run",
            "long.toml",
            "--out",
            "run.mcap",
            "--real-time",
            "0.01",
        ])
        .through("sh", &["-c", "umask 0 && exec \"$0\" \"$@\""])
        .start();
    let run = sandbox.next_run(&std::collections::BTreeSet::new());
    let log = sandbox.path().join("run.mcap");
    until("the log", SOON, || log.exists().then_some(()));
    sandbox.process("simulator");
    let shared = until("shared memory", SOON, || {
        let found = sandbox.shared_memory();
        let is_page = |path: &PathBuf| !path.is_dir();
        (found.iter().filter(|p| is_page(p)).count() > 3).then_some(found)
    });
    let root = sandbox.runtime_dir().join("protean").join(&run);
    let configuration = until("a configuration", SOON, || {
        let path = root.join("process-1.json");
        path.exists().then_some(path)
    });
    assert_eq!(mode(root.parent().unwrap()), 0o700);
    assert_eq!(mode(&root), 0o700);
    assert_eq!(mode(&configuration), 0o600);
    assert_eq!(mode(&log), 0o600, "it holds the keys of patrols");
    let files = shared.into_iter().chain(below(&root)).chain([log]);
    for path in files {
        let Ok(found) = path.symlink_metadata() else {
            continue;
        };
        let inside = path.starts_with(&root);
        let mode = found.permissions().mode() & 0o777;
        assert!(
            inside || mode.trailing_zeros() >= 6,
            "{}: {mode:o}",
            path.display()
        );
        if found.is_file() {
            match others_can_read(&path) {
                Some(readable) => assert!(!readable, "{}", path.display()),
                None => break,
            }
        }
    }
    running.signal(rustix::process::Signal::INT);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    sandbox.assert_nothing_left();
}

#[test]
fn a_directory_of_another_user_is_refused_by_its_name() {
    let sandbox = Sandbox::new();
    sandbox.file("s.toml", super::GOOD);
    let prepared = sandbox.path().join("prepared");
    std::fs::create_dir(&prepared).unwrap();
    let open = std::fs::Permissions::from_mode(0o777);
    std::fs::set_permissions(&prepared, open).unwrap();
    let name = prepared.display().to_string();
    let outcome = sandbox
        .protean(["run", "s.toml"])
        .runtime_dir(&prepared)
        .run();
    outcome.refused(1, &[&name, "0777", "XDG_RUNTIME_DIR"]);
    assert!(below(&prepared).is_empty());
}
