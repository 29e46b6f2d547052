//! Commands of the Python package: the program hands them to an interpreter, or says what to install. The commands
//! themselves: `python/tests/test_lab_*.py`.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;

use crate::support::Sandbox;

/// The commands, and the arguments that the interpreter gets.
const COMMANDS: [(&[&str], &str); 3] = [
    (
        &["reproduce", "--quick", "--help", "a b"],
        "reproduce --quick --help a b",
    ),
    (&["sweep", "figures", "results"], "figures results"),
    (
        &["new", "a.toml", "--from", "a.map", "--street", "6"],
        "maps --cell 1 --street 6 -- a.map",
    ),
];

/// Calls a command with this script as `python3`; without one there is none.
#[track_caller]
fn called(words: &[&str], python: Option<&str>) -> crate::support::call::Outcome {
    let sandbox = Sandbox::new();
    let folder = sandbox.path().join("bin");
    fs::create_dir(&folder).unwrap();
    if let Some(script) = python {
        let file = sandbox.file("bin/python3", format!("#!/bin/sh\n{script}\n"));
        fs::set_permissions(file, fs::Permissions::from_mode(0o755)).unwrap();
    }
    let path = format!("PATH={}", folder.display());
    let words = words.iter().copied();
    sandbox
        .protean(words)
        .through("/usr/bin/env", &[&path])
        .run()
}

#[test]
fn without_the_package_its_commands_say_what_to_install() {
    for (words, _) in COMMANDS {
        let install = "pip install 'protean-robotics[lab]'";
        called(words, None).refused(1, &["python3", "No such file", install]);
        called(words, Some("exit 1")).refused(1, &["python3", "lacks the package", install]);
    }
}

#[test]
fn the_package_gets_all_arguments_and_its_exit_code_is_that_of_the_command() {
    // The first call asks for the package.
    let script = "[ \"$2\" = -c ] && exit 0\necho \"$@\" >&2\nexit 3";
    for (words, expected) in COMMANDS {
        let outcome = called(words, Some(script));
        assert_eq!(outcome.code, Some(3), "{outcome}");
        let expected = format!("-P -m protean_robotics.lab {expected}\n");
        assert_eq!(outcome.stderr, expected, "{outcome}");
    }
}
