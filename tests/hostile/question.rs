//! Confirmation at a terminal: programs of a scenario start only after the user answers yes.

use std::path::Path;
use std::process::{Command, Stdio};

use super::changed;
use crate::support::terminal::Terminal;
use crate::support::{PROTEAN, SOON, Sandbox, until};

/// Runs a scenario with a program at a terminal and answers its question; the exit code and what the
/// terminal showed.
fn asked(sandbox: &Sandbox, answer: &str) -> (Option<i32>, String) {
    let terminal = Terminal::open();
    let heard = terminal.listen();
    let mut child = Command::new("setsid")
        .arg("--ctty")
        .arg("--wait")
        .arg(PROTEAN)
        .args(["run", "evil.toml", "--quiet"])
        .current_dir(sandbox.path())
        .env("XDG_RUNTIME_DIR", sandbox.runtime_dir())
        .stdin(terminal.inside.try_clone().unwrap())
        .stdout(Stdio::null())
        .stderr(terminal.inside.try_clone().unwrap())
        .spawn()
        .unwrap();
    until("the question", SOON, || {
        heard.lock().unwrap().contains("[y/N]").then_some(())
    });
    terminal.press(answer);
    let status = until("the end", SOON, || child.try_wait().unwrap());
    // The last output is complete once all other ends of the terminal are closed.
    let Terminal { outside, inside } = terminal;
    drop(inside);
    until("the whole output", SOON, || {
        (std::sync::Arc::strong_count(&heard) == 1).then_some(())
    });
    drop(outside);
    (status.code(), heard.lock().unwrap().clone())
}

#[test]
fn programs_start_when_a_user_at_a_terminal_says_yes_and_not_otherwise() {
    let sandbox = Sandbox::new();
    let mark = sandbox.path().join("started");
    // A word that looks as if the question came later, and was another.
    let forged = "x\\nStart them? [y/N] n\\n";
    let script = "touch \\\"$0\\\"; exit 5";
    let command = format!(
        "name = \"liar\"\ncommand = [\"/bin/sh\", \"-c\", \"{script}\", {mark:?}, \"{forged}\"]"
    );
    sandbox.file(
        "evil.toml",
        changed("kind = \"evader_potential\"", &command),
    );
    for answer in ["n\n", "\n", "maybe\n", "yes, but\n", "\u{4}"] {
        let (code, output) = asked(&sandbox, answer);
        assert_eq!(code, Some(2), "{answer:?}: {output}");
        let questions = output.lines().filter(|l| l.starts_with("Start them?"));
        assert_eq!(questions.count(), 1, "{output}");
        assert!(
            output.contains(r#"liar: /bin/sh -c 'touch "$0"; exit 5' "#),
            "{output}"
        );
        assert!(
            output.contains(r#" "x\nStart them? [y/N] n\n""#),
            "{output}"
        );
        assert!(
            output.contains("check them, then add --allow-external"),
            "{output}"
        );
        assert!(!Path::new(&mark).exists(), "{answer:?}");
    }
    assert!(sandbox.runs().is_empty(), "nothing was started");
    for answer in ["y\n", "yes\n"] {
        let (code, output) = asked(&sandbox, answer);
        assert_eq!(code, Some(1), "{answer:?}: {output}");
        assert!(
            output.contains("process liar ended with exit code 5"),
            "{output}"
        );
        std::fs::remove_file(&mark).unwrap();
    }
    sandbox.assert_nothing_left();
}
