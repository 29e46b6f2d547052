//! Paths that leave the scenario's folder, and paths to things that are not files.

use std::os::unix::fs::symlink;

use super::changed;
use crate::support::Sandbox;

const YAML: &str = "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// Calls every command that reads a scenario's files; each must refuse it with these words.
#[track_caller]
fn refused(sandbox: &Sandbox, more: &[&str], words: &[&str]) {
    for command in [&["check"][..], &["run"], &["run", "--in-process"]] {
        let words_of_call = command.iter().chain(&["in/s.toml"]).chain(more).copied();
        let outcome = sandbox.protean(words_of_call).within_seconds("60").run();
        outcome.refused(2, words);
    }
    assert!(sandbox.runs().is_empty(), "nothing is started");
}

#[test]
fn a_map_outside_is_not_read_by_any_command() {
    let sandbox = Sandbox::new();
    let hello = include_str!("../../scenarios/maps/hello.toml");
    let outside = sandbox.file("outside.toml", hello);
    sandbox.file("in/s.toml", "");
    symlink("../outside.toml", sandbox.path().join("in/link.toml")).unwrap();
    symlink("..", sandbox.path().join("in/up")).unwrap();
    let absolute = outside.display().to_string();
    for path in [
        "../outside.toml",
        "a/../../outside.toml",
        "link.toml",
        "up/outside.toml",
        &absolute,
        "/proc/self/environ",
        "/dev/zero",
    ] {
        sandbox.file("in/s.toml", changed("builtin:hello", path));
        refused(&sandbox, &[], &["path leads out of the scenario's folder"]);
    }
    // A tilde is a letter like any other.
    sandbox.file("in/s.toml", changed("builtin:hello", "~/outside.toml"));
    refused(&sandbox, &[], &["in/~/outside.toml: cannot be read"]);
    sandbox.file("in/s.toml", changed("builtin:hello", "../outside.toml"));
    let allowed = ["check", "in/s.toml", "--allow-outside"];
    let outcome = sandbox.protean(allowed).run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
}

#[test]
fn what_is_no_file_is_neither_waited_for_nor_read_without_end() {
    let sandbox = Sandbox::new();
    sandbox.file("in/map.yaml", YAML);
    let fifo = |name: &str| {
        let path = sandbox.path().join(name);
        rustix::fs::mknodat(
            rustix::fs::CWD,
            path,
            rustix::fs::FileType::Fifo,
            0o600.into(),
            0,
        )
        .unwrap();
    };
    fifo("in/map.pgm");
    fifo("in/map.toml");
    fifo("in/other.yaml");
    symlink("/dev/zero", sandbox.path().join("in/zero.toml")).unwrap();
    for (path, words) in [
        ("map.yaml", "image of map.yaml: in/map.pgm is not a file"),
        ("map.toml", "in/map.toml is not a file"),
        ("other.yaml", "in/other.yaml is not a file"),
        ("zero.toml", "in/zero.toml is not a file"),
    ] {
        sandbox.file("in/s.toml", changed("builtin:hello", path));
        refused(&sandbox, &["--allow-outside"], &[words]);
    }
    for command in ["info", "recover", "export", "report", "verify", "picture"] {
        for log in ["in/map.pgm", "/dev/zero"] {
            let call = [command, log, "--out", "out"];
            let arguments = &call[..if matches!(command, "info" | "verify") {
                2
            } else {
                4
            }];
            let outcome = sandbox
                .protean(arguments.iter().copied())
                .within_seconds("60")
                .run();
            outcome.refused(2, &["regular file"]);
        }
    }
}

#[test]
fn the_image_that_was_looked_at_is_the_image_that_is_read() {
    let sandbox = Sandbox::new();
    // `a/map.yaml` is a link; the image beside it is sound, that beside its target leads out.
    sandbox.file("in/b/map.yaml", YAML);
    let mut image = b"P5 80 60 255\n".to_vec();
    image.extend([255; 80 * 60]);
    sandbox.file("in/a/map.pgm", &image);
    symlink("../b/map.yaml", sandbox.path().join("in/a/map.yaml")).unwrap();
    symlink("/dev/zero", sandbox.path().join("in/b/map.pgm")).unwrap();
    sandbox.file("in/s.toml", changed("builtin:hello", "a/map.yaml"));
    let outcome = sandbox
        .protean(["check", "in/s.toml"])
        .within_seconds("60")
        .run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
    sandbox.file("in/s.toml", changed("builtin:hello", "b/map.yaml"));
    let words = [
        "image of b/map.yaml",
        "path leads out of the scenario's folder",
    ];
    refused(&sandbox, &[], &words);
}
