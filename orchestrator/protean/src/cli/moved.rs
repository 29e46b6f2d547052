//! Command lines of earlier versions: removed commands, with what to type instead, and changed options.

use std::ffi::{OsStr, OsString};
use std::path::Path;

/// First words of a removed command, and what to type instead.
type Row = (&'static [&'static str], &'static str);

/// Removed commands.
const MOVED: &[Row] = &[
    (
        &["instances"],
        "`protean plan generate RECIPE --count N --out FILE`",
    ),
    (&["messages"], "`protean schema messages`"),
    (&["list", "--show"], "`protean new FILE.toml --from NAME`"),
    (
        &["bench"],
        "`cargo run --release -p benchmarks -- chase|start|ticks|in-process` in the source tree",
    ),
    (
        &["soak"],
        "`cargo test -p end_to_end growth:: -- --ignored` in the source tree",
    ),
    (&["sweep", "page"], "`protean reproduce`"),
    (&["sweep", "plans"], "`protean reproduce --paper chase`"),
];

/// Returns the message for a command line (without the program's name) that begins with a removed command, or with a
/// scenario.
pub(super) fn message(arguments: &[OsString]) -> Option<String> {
    find(MOVED, arguments).or_else(|| scenario(arguments.first()?.to_str()?))
}

/// Returns the command line with the present spelling of options whose form has changed: `latency --json FILE`.
pub(super) fn present(arguments: Vec<OsString>) -> Vec<OsString> {
    if arguments.first().is_none_or(|command| command != "latency") {
        return arguments;
    }
    let is_file = |value: &OsString| {
        Path::new(value)
            .extension()
            .is_some_and(|end| end == "json")
    };
    let mut present: Vec<OsString> = Vec::new();
    let split = |argument: OsString| match argument.to_str().and_then(|a| a.strip_prefix("--json="))
    {
        Some("-") => vec!["--json".into()],
        Some(file) => vec!["--out".into(), file.into()],
        None => vec![argument],
    };
    for argument in arguments.into_iter().flat_map(split) {
        let after_json = present.last().is_some_and(|last| last == "--json");
        if after_json && is_file(&argument) {
            present.pop();
            present.extend(["--out".into(), argument]);
        } else if !(after_json && argument == "-") {
            present.push(argument);
        }
    }
    present
}

fn scenario(word: &str) -> Option<String> {
    let is_built_in = scenario::list()
        .iter()
        .any(|built_in| built_in.name == word);
    (is_built_in
        || Path::new(word)
            .extension()
            .is_some_and(|extension| extension == "toml"))
    .then(|| {
        format!("error: `{word}` is a scenario, not a command; run it with `protean run {word}`")
    })
}

fn find(rows: &[Row], arguments: &[OsString]) -> Option<String> {
    let begins_with = |words: &[&str]| {
        let given = arguments.get(..words.len());
        given.is_some_and(|given| given.iter().zip(words).all(|(a, b)| a == OsStr::new(b)))
    };
    let (words, instead) = rows.iter().find(|(words, _)| begins_with(words))?;
    Some(format!(
        "error: `protean {}` was removed; use {instead}",
        words.join(" ")
    ))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;
    use crate::cli::Cli;

    #[test]
    fn a_removed_command_is_answered_with_its_replacement() {
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
    fn an_old_form_of_an_option_becomes_the_present_one() {
        for (old, now) in [
            ("latency --json a.json chase", "latency --out a.json chase"),
            ("latency chase --json -", "latency chase --json"),
            ("latency --json=- chase", "latency --json chase"),
            ("latency --json=a chase", "latency --out a chase"),
            ("latency --json chase", "latency --json chase"),
            ("plan a.json --json b.json", "plan a.json --json b.json"),
        ] {
            let words = old.split(' ').map(OsString::from).collect();
            assert_eq!(present(words).join(OsStr::new(" ")), now);
        }
    }

    #[test]
    fn a_scenario_without_a_command_is_answered_with_run() {
        for word in ["chase", "my/own.toml"] {
            let message = message(&[word.into()]).unwrap();
            assert!(
                message.ends_with(&format!("`protean run {word}`")),
                "{message}"
            );
        }
        assert_eq!(message(&["sweep".into(), "a.toml".into()]), None);
    }

    #[test]
    fn no_row_hides_an_existing_command() {
        let cli = Cli::command();
        for (words, _) in MOVED {
            // A word that is not a command may be an argument: `sweep page` names an experiment.
            let found = words
                .iter()
                .try_fold(&cli, |command, word| command.find_subcommand(word));
            assert!(found.is_none(), "{words:?}");
        }
    }
}
