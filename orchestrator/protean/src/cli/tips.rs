//! Errors of the command line with tips that fit.

use std::error::Error as _;
use std::ffi::OsString;
use std::num::{ParseFloatError, ParseIntError};
use std::path::Path;

use clap::builder::{Arg, Command, StyledStr};
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use config::nearest;
use platform::file_kind::FileKind;

use super::common::Expected;
use super::help::HEADINGS;

/// Options that other programs have, with what serves here.
const OPTIONS: [(&[&str], &str); 7] = [
    (
        &[
            "--gui", "--show", "--view", "--render", "--window", "--viewer",
        ],
        "there is no window: `protean report LOG --open` shows a run in the browser, `run --live --open` while it runs",
    ),
    (
        &["--headless", "--no-gui"],
        "no option is needed: a run has no window",
    ),
    (
        &[
            "--time",
            "--time-limit",
            "--duration",
            "--timeout",
            "--max-time",
        ],
        "`--set rules.time_limit=60` ends a run after 60 simulated seconds",
    ),
    (
        &["--steps", "--ticks", "--dt"],
        "`--set rules.time_limit=60` sets the length of a run (s), `--set run.dt=0.05` that of a tick (s)",
    ),
    (
        &["--seeds", "--runs", "--repeat"],
        "`protean sweep` runs an experiment: many seeds, one table of results",
    ),
    (
        &["--verbose", "-v", "--debug"],
        "`run --log-level debug` shows more",
    ),
    (
        &["--scenario", "--config", "--file"],
        "the file is an argument without an option: `protean run FILE.toml`",
    ),
];

/// Lets the options that take a value take negative numbers: their own parsers refuse them with what they expect.
pub fn with_negative_numbers(program: Command) -> Command {
    let allow = |arg: Arg| {
        let takes_value = !arg.is_positional() && arg.get_action().takes_values();
        arg.allow_negative_numbers(takes_value)
    };
    program
        .mut_args(allow)
        .mut_subcommands(with_negative_numbers)
}

/// Parses the seed of random numbers.
pub fn seed(text: &str) -> Result<u64, Expected> {
    text.parse()
        .map_err(|_| Expected(format!("a whole number from 0 to {}", u64::MAX)))
}

/// Returns an error of the command line with the tips that help; `arguments` is without the program's name.
pub fn improved(mut error: Error, arguments: &[OsString]) -> Error {
    let word = |kind| match error.get(kind) {
        Some(ContextValue::String(word)) => Some(word.clone()),
        _ => None,
    };
    let tip = match error.kind() {
        // One of a command has clap's tip.
        ErrorKind::InvalidSubcommand => {
            let word = word(ContextKind::InvalidSubcommand).unwrap_or_default();
            let is_command = arguments.first().is_some_and(|first| *first == *word);
            if is_command {
                error.remove(ContextKind::SuggestedSubcommand);
            }
            is_command.then(|| command_for(&word)).flatten()
        }
        ErrorKind::UnknownArgument => {
            let option = word(ContextKind::InvalidArg).unwrap_or_default();
            let known = OPTIONS.iter().find(|(names, _)| names.contains(&&*option));
            let tip = known.map(|(_, tip)| (*tip).to_owned());
            if tip.is_some() {
                error.remove(ContextKind::SuggestedArg);
            }
            tip
        }
        ErrorKind::ValueValidation => match error.source() {
            Some(source) if source.is::<ParseFloatError>() => Some("expected a number".to_owned()),
            Some(source) if source.is::<ParseIntError>() => {
                Some("expected a whole number".to_owned())
            }
            _ => return error,
        },
        _ => return error,
    };
    // Else clap's: to pass an unknown option as a value.
    error.remove(ContextKind::Suggested);
    if let Some(tip) = tip {
        let tips = ContextValue::StyledStrs(vec![StyledStr::from(tip)]);
        error.insert(ContextKind::Suggested, tips);
    }
    error
}

/// Returns the tip for a first word that is not a command: the command for a scenario or a file, or one with a similar
/// name.
fn command_for(word: &str) -> Option<String> {
    if scenario::list()
        .iter()
        .any(|built_in| built_in.name == word)
    {
        return Some(FileKind::Scenario.help(Path::new(word)));
    }
    if let Some(kind) = FileKind::from_path(Path::new(word)) {
        return Some(kind.help(Path::new(word)));
    }
    let commands = HEADINGS.iter().flat_map(|(_, names)| names.iter().copied());
    nearest(word, commands).map(|near| format!("did you mean `protean {near}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::program;

    fn message(line: &str) -> String {
        let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
        let all = std::iter::once(OsString::from("protean")).chain(words.clone());
        let error = program().try_get_matches_from(all).unwrap_err();
        improved(error, &words).to_string()
    }

    #[test]
    fn a_wrong_word_gets_the_tip_for_it() {
        for (line, tip) in [
            ("rnu", "did you mean `protean run`?"),
            ("play", "did you mean `protean replay`?"),
            ("chekc x", "did you mean `protean check`?"),
            ("chase", "it is a scenario: `protean run chase` runs it"),
            (
                "run --gui",
                "there is no window: `protean report LOG --open`",
            ),
            ("run chase --time 5", "`--set rules.time_limit=60`"),
            (
                "run --seed -1",
                "expected a whole number from 0 to 18446744073709551615",
            ),
            (
                "run --seed x",
                "expected a whole number from 0 to 18446744073709551615",
            ),
            (
                "run --seed 18446744073709551616",
                "expected a whole number from 0 to 18446744073709551615",
            ),
            (
                "plan generate base --seed -1",
                "expected a whole number from 0 to",
            ),
            ("run --pace fast", "expected a number"),
            ("picture a.mcap --at x", "expected a number"),
            ("sweep a.toml --jobs -1", "-1 is not in 1..=4096"),
            ("cat a.mcap --limit -1", "expected a whole number"),
            ("run --sede 1", "a similar argument exists: '--seed'"),
        ] {
            let message = message(line);
            assert!(message.contains(tip), "{line}: {message}");
            assert!(!message.contains("as a value, use"), "{line}: {message}");
        }
        for line in ["zzz", "plna", "proces"] {
            let message = message(line);
            assert!(
                !message.contains("planner") && !message.contains("process'"),
                "{message}"
            );
        }
    }
}
