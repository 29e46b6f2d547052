//! Commands that moved or went, each answered with what to type instead.

use std::ffi::{OsStr, OsString};

/// The first words of a command that is no longer there, and what to type instead.
type Row = (&'static [&'static str], &'static str);

/// One row per command that moved or went.
const MOVED: &[Row] = &[
    (
        &["bench"],
        "in the source tree, `cargo run --release -p benchmarks -- chase|start|ticks|in-process`",
    ),
    (
        &["soak"],
        "in the source tree, `cargo test -p end_to_end growth:: -- --ignored`",
    ),
    (
        &["sweep", "page"],
        "in the source tree, `cargo run --release -p pages -- chase|vmc-lp|patrol DIR…`",
    ),
    (
        &["sweep", "plans"],
        "in the source tree, `cargo run --release -p pages -- plans`",
    ),
];

/// The message for a command line, without the program's name, that begins with a command that moved
/// or went; `None` for any other.
pub(super) fn message(arguments: &[OsString]) -> Option<String> {
    find(MOVED, arguments)
}

fn find(rows: &[Row], arguments: &[OsString]) -> Option<String> {
    let begins_with = |words: &[&str]| {
        let given = arguments.get(..words.len());
        given.is_some_and(|given| given.iter().zip(words).all(|(a, b)| a == OsStr::new(b)))
    };
    let (words, instead) = rows.iter().find(|(words, _)| begins_with(words))?;
    Some(format!(
        "error: `protean {}` is no longer a command; instead, {instead}",
        words.join(" ")
    ))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;
    use crate::cli::Cli;

    #[test]
    fn a_command_that_went_is_answered_with_what_to_type_instead() {
        let rows: &[Row] = &[(&["sweep", "page"], "type this"), (&["bench"], "type that")];
        let answer = |line: &str| {
            let words: Vec<OsString> = line.split_whitespace().map(OsString::from).collect();
            find(rows, &words)
        };
        let message = answer("sweep page DIR --out x.md").unwrap();
        assert!(message.contains("`protean sweep page`") && message.ends_with("type this"));
        assert!(answer("bench --json").unwrap().ends_with("type that"));
        assert_eq!(answer("sweep pages.toml"), None);
        assert_eq!(answer("sweep"), None);
        assert_eq!(answer("run bench"), None);
        assert_eq!(answer(""), None);
    }

    #[test]
    fn no_row_hides_a_command_that_is_there() {
        let cli = Cli::command();
        for (words, _) in MOVED {
            // A word that is no command may still be an argument: `sweep page` names an experiment.
            let found = words
                .iter()
                .try_fold(&cli, |command, word| command.find_subcommand(word));
            assert!(found.is_none(), "{words:?}");
        }
    }
}
