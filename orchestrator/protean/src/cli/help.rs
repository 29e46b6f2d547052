//! The help of the program: its commands under headings.

use clap::Command;

/// The commands by heading, in the order of the help.
pub const HEADINGS: [(&str, &[&str]); 6] = [
    ("Missions", &["run", "test", "check", "new", "list"]),
    (
        "Logs",
        &[
            "report", "picture", "info", "cat", "export", "recover", "replay", "import", "verify",
            "diff", "branch", "decided",
        ],
    ),
    ("Experiments", &["sweep", "reproduce"]),
    ("Planning", &["plan"]),
    ("Health", &["latency", "clean"]),
    ("Other", &["schema", "completions", "help"]),
];

/// Returns the program with its help: commands under headings, the options of `run` hidden.
pub fn with_headings(program: Command) -> Command {
    let heading = program.get_styles().get_header();
    let name = program.get_styles().get_literal();
    let mut template = "{about-with-newline}\n{usage-heading} {usage}\n".to_owned();
    for (title, commands) in HEADINGS {
        template += &format!("\n{heading}{title}:{heading:#}\n");
        for command in commands {
            let about = program
                .find_subcommand(command)
                .and_then(Command::get_about);
            let about = about.map_or_else(|| HELP.to_owned(), ToString::to_string);
            template += &format!("  {name}{command:11}{name:#}  {about}\n");
        }
    }
    template += &format!(
        "\n{heading}Options:{heading:#}\n{{options}}\n\n\
         Without a command, `protean` runs `run chase` with the options of `run`.\n"
    );
    program
        .mut_args(|option| option.hide(true))
        .override_usage("protean [COMMAND] [OPTIONS]")
        .help_template(template)
}

/// Returns the program with help texts that the terminal wraps: each paragraph is one line.
pub fn for_terminal(program: Command) -> Command {
    let text = program.get_after_long_help().map(ToString::to_string);
    let program = match text {
        Some(text) => program.after_long_help(with_long_lines(&text)),
        None => program,
    };
    program.max_term_width(120).mut_subcommands(for_terminal)
}

/// Joins the lines of paragraphs; indented lines stay.
fn with_long_lines(text: &str) -> String {
    let mut joined = String::with_capacity(text.len());
    let mut in_paragraph = false;
    for line in text.lines() {
        let is_text = !line.is_empty() && !line.starts_with(' ');
        if !joined.is_empty() {
            joined.push(if in_paragraph && is_text { ' ' } else { '\n' });
        }
        joined += line;
        in_paragraph = is_text;
    }
    joined
}

/// The description of `help`, which clap adds later.
const HELP: &str = "Print the help of a command";

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::cli::program;

    #[test]
    fn every_visible_command_has_one_heading() {
        let mut program = program();
        program.build();
        let visible: BTreeSet<&str> = program
            .get_subcommands()
            .filter(|command| !command.is_hide_set())
            .map(Command::get_name)
            .collect();
        let mut listed = BTreeSet::new();
        for (heading, commands) in HEADINGS {
            for command in commands {
                assert!(listed.insert(*command), "{command}: twice, under {heading}");
            }
        }
        assert_eq!(listed, visible);
        assert!(visible.len() <= 25, "too many commands to choose from");
    }

    #[test]
    fn the_help_shows_commands_and_no_options_of_run() {
        let help = program().render_long_help().to_string();
        for line in [
            "\nMissions:\n  run          Run a scenario",
            "\nHealth:\n  latency ",
            "  -h, --help",
        ] {
            assert!(help.contains(line), "{line}: {help}");
        }
        assert!(
            !help.contains("--pace") && !help.contains("--seed"),
            "{help}"
        );
        let commands = help.lines().filter(|line| line.starts_with("  "));
        assert!(commands.map(str::len).all(|n| n <= 80), "{help}");
    }

    #[test]
    fn paragraphs_become_lines_and_examples_stay() {
        let text = "One\ntwo.\n\nThree:\n  a  b\n  c\n\nFour\nfive.";
        let joined = "One two.\n\nThree:\n  a  b\n  c\n\nFour five.";
        assert_eq!(with_long_lines(text), joined);
    }

    #[test]
    fn options_of_run_need_no_command() {
        let words = ["protean", "--seed", "3", "--in-process"];
        let matches = program().try_get_matches_from(words).unwrap();
        assert_eq!(matches.get_one::<u64>("seed"), Some(&3));
        assert_eq!(matches.subcommand_name(), None);
    }
}
