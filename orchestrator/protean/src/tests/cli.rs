//! The reference of the command line, written from its definition.

use std::fmt::Write as _;

use clap::{Arg, ArgAction, Command};

use crate::cli::{HEADINGS, program};

/// Returns the sections of `docs/reference/cli.md`, one for each command.
pub(super) fn commands() -> String {
    let mut program = program();
    // Adds `help` and the usages.
    program.build();
    let mut text = String::from("\n| | |\n|---|---|\n");
    for (heading, names) in HEADINGS {
        let links = names.iter().map(|name| match *name {
            "help" => "`help`".to_owned(),
            name => format!("[`{name}`](#protean-{name})"),
        });
        let links: Vec<String> = links.collect();
        writeln!(text, "| {heading} | {} |", links.join(", ")).unwrap();
    }
    for (_, names) in HEADINGS {
        for name in names.iter().filter(|name| **name != "help") {
            section(program.find_subcommand_mut(name).unwrap(), &mut text);
        }
    }
    text
}

/// Writes the section of a command, then those of its subcommands.
fn section(command: &mut Command, text: &mut String) {
    let usage = command.render_usage().to_string();
    let usage = usage.trim_start_matches("Usage: ").replace('\n', "\n  ");
    let name = command.get_bin_name().unwrap();
    writeln!(text, "\n## {name}\n").unwrap();
    writeln!(text, "{}.", command.get_about().unwrap()).unwrap();
    writeln!(text, "\n```text\n{}\n```", usage.trim_end()).unwrap();
    let described = |arg: &&Arg| !arg.is_hide_set() && arg.get_id() != "help";
    let arguments: Vec<&Arg> = command.get_arguments().filter(described).collect();
    if !arguments.is_empty() {
        text.push_str("\n| argument | meaning |\n|---|---|\n");
        for arg in arguments {
            let (form, meaning) = (form(arg), meaning(arg));
            writeln!(text, "| `{form}` | {} |", meaning.replace('|', "\\|")).unwrap();
        }
    }
    if let Some(more) = command.get_after_long_help() {
        writeln!(text, "\n```text\n{}\n```", more.to_string().trim_end()).unwrap();
    }
    for subcommand in command.get_subcommands_mut() {
        if subcommand.get_name() != "help" {
            section(subcommand, text);
        }
    }
}

/// Returns an argument as it is typed: `--out, -o <FILE>`.
fn form(arg: &Arg) -> String {
    let names = arg.get_value_names().unwrap_or_default();
    let value = names
        .first()
        .map_or(String::new(), |name| format!("<{name}>"));
    let optional = arg
        .get_num_args()
        .is_some_and(|count| count.min_values() == 0);
    let value = match (arg.get_action(), optional) {
        (ArgAction::Set | ArgAction::Append, false) => value,
        (ArgAction::Set | ArgAction::Append, true) => value.replace('<', "[").replace('>', "]"),
        _ => String::new(),
    };
    let mut form = match (arg.get_long(), arg.get_short()) {
        (Some(long), Some(short)) => format!("--{long}, -{short}"),
        (Some(long), None) => format!("--{long}"),
        _ => return value,
    };
    if !value.is_empty() {
        form += &format!(" {value}");
    }
    form
}

/// Returns the help of an argument with its values and its default.
fn meaning(arg: &Arg) -> String {
    let mut text = arg.get_help().map(ToString::to_string).unwrap_or_default();
    let values = arg.get_possible_values();
    let values: Vec<_> = values.iter().filter(|value| !value.is_hide_set()).collect();
    if arg.get_action().takes_values() && !values.is_empty() {
        let described = |value: &clap::builder::PossibleValue| match value.get_help() {
            Some(help) => format!("`{}` ({help})", value.get_name()),
            None => format!("`{}`", value.get_name()),
        };
        let values: Vec<String> = values.into_iter().map(described).collect();
        text += &format!(": {}", values.join(", "));
    }
    let defaults = arg.get_default_values();
    if arg.get_action().takes_values()
        && let Some(default) = defaults.first()
    {
        text += &format!(" [default: `{}`]", default.display());
    }
    text
}

/// Returns the command lines that name an output file, each with the file's place free: words before it and after it.
fn outputs(command: &Command, words: &[String], found: &mut Vec<(Vec<String>, Vec<String>)>) {
    let is_output = |arg: &&Arg| {
        let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
        ["Write ", "Draw the world"]
            .iter()
            .any(|begin| help.starts_with(begin))
            && matches!(arg.get_value_names(), Some([name]) if ["FILE", "DIR"].contains(&name.as_str()))
    };
    let required = command
        .get_positionals()
        .filter(|arg| arg.is_required_set());
    let options = command.get_opts();
    let options = options.filter(|arg| arg.is_required_set() && !is_output(arg));
    let options = options.filter_map(Arg::get_long);
    let required: Vec<String> = required
        .map(|arg| {
            let values = arg.get_possible_values();
            values
                .first()
                .map_or_else(|| "x".to_owned(), |value| value.get_name().to_owned())
        })
        .chain(options.map(|long| format!("--{long}=1")))
        .collect();
    for long in command
        .get_arguments()
        .filter(is_output)
        .filter_map(Arg::get_long)
    {
        found.push(([words, &[format!("--{long}")]].concat(), required.clone()));
    }
    for below in command.get_subcommands() {
        outputs(
            below,
            &[words, &[below.get_name().to_owned()]].concat(),
            found,
        );
    }
}

#[test]
fn an_output_under_the_name_of_another_format_is_refused_by_every_command() {
    let mut found = Vec::new();
    outputs(&program(), &["protean".to_owned()], &mut found);
    assert!(found.len() >= 14, "{found:?}");
    for (before, after) in found {
        for (file, fits) in [
            ("a/x.docx", false),
            ("a/x.gif", false),
            ("a/x", true),
            ("v-0.5", true),
        ] {
            let line = [before.clone(), vec![file.to_owned()], after.clone()].concat();
            match program().try_get_matches_from(&line) {
                Ok(_) => assert!(fits, "{line:?}"),
                Err(error) => {
                    let error = error.to_string();
                    assert!(
                        !fits && error.contains(file) && error.contains("for example a/x"),
                        "{line:?}: {error}"
                    );
                }
            }
        }
    }
}
