//! The reference of files, written from their declarations.

mod example;
mod sections;
mod table;
mod types;
mod words;

use mission::plan::Plan;
use std::path::Path;
use std::{env, fs};

use kinds::KINDS;

use crate::cli::Dataflow;
use sections::Reference;

/// Command that rewrites the files.
const COMMAND: &str = "PROTEAN_DOCS=write cargo test -p protean reference";

/// Compares a file of `docs/reference` with what the declarations give, or writes it.
fn compare(name: &str, title: &str, text: &str, tables: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference");
    let path = path.join(name);
    let declared = format!(
        "# {title}\n\n{text} This file is written from the declarations in the code by \
         `{COMMAND}`.\n{tables}"
    );
    if env::var_os("PROTEAN_DOCS").is_some_and(|word| word == "write") {
        fs::write(&path, &declared).unwrap();
    }
    let found = fs::read_to_string(&path).unwrap();
    let file = path.display();
    assert!(
        found == declared,
        "{file} is not what the code declares: {COMMAND}"
    );
}

#[test]
fn the_reference_of_parameters_is_what_the_code_declares() {
    let text = "The keys of `params` in a `[[processes]]` table of a scenario, by `kind`; \
                [scenarios](../how-to/scenarios.md) says how they are used. A group of keys that several \
                kinds have is described once, below the kinds.";
    let mut reference = Reference::default();
    for kind in KINDS {
        let (first, rest) = kind.summary.split_at(1);
        let summary = format!("{}{rest}.", first.to_uppercase());
        reference.add(&format!("`{}`", kind.name), &summary, |generator| {
            kind.schema(generator)
        });
    }
    let tables = reference.markdown();
    compare(
        "parameters.md",
        "Parameters of the processes",
        text,
        &tables,
    );
}

#[test]
fn the_reference_of_experiments_is_what_the_code_declares() {
    let text = "The keys of an experiment file; [experiments](experiment.md) says how they are used. \
                A key without a default (–) may be absent.";
    let tables = Reference::of(&sweep::schema::sections());
    compare(
        "experiment-keys.md",
        "Keys of experiment files",
        text,
        &tables,
    );
}

#[test]
fn the_reference_of_result_columns_is_what_the_code_declares() {
    let text = "The columns of the tables of a sweep after `case`, the parameters and `seed`, by which the tables join; \
                [experiments](experiment.md#results) and [plans](plans.md#experiments) describe the files. \
                A missing value is an empty field of the CSV file and null in Parquet.";
    let tables = sweep::schema::result_columns();
    compare("result-columns.md", "Columns of results", text, &tables);
}

#[test]
fn the_reference_of_scenarios_is_what_the_code_declares() {
    let text = "The keys of a scenario file; [scenarios](../how-to/scenarios.md) says how they are used. \
                A key without a default (–) may be absent.";
    let tables = Reference::of(&scenario::schema::sections());
    compare("scenario.md", "Keys of scenario files", text, &tables);
}

#[test]
fn the_reference_of_commands_is_the_definition_of_the_command_line() {
    let text = "Results go to stdout, progress and diagnostics to stderr. With `--json`, stdout is one JSON object \
                (`plan`: one object per line). [Output and exit codes](output.md) describes the exit codes and the \
                summary of a run. Without a command, `protean` runs `run chase` with the options of `run`.";
    compare("cli.md", "Command line", text, &super::cli::commands());
}

#[test]
fn the_picture_of_the_dataflow_follows_from_the_declarations() {
    const BEGIN: &str = "<!-- dataflow: ";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/architecture.md");
    let page = fs::read_to_string(&path).unwrap();
    let (_, rest) = page.split_once(BEGIN).unwrap();
    let (scenario, rest) = rest.split_once(" -->\n```mermaid\n").unwrap();
    let (drawn, _) = rest.split_once("```\n").unwrap();
    let loaded = kinds::load(scenario, &[], None).unwrap();
    let plan = Plan::new(&loaded, "warn").unwrap();
    let flowchart = Dataflow::new(&plan).mermaid();
    if env::var_os("PROTEAN_DOCS").is_some_and(|word| word == "write") {
        fs::write(&path, page.replace(drawn, &flowchart)).unwrap();
        return;
    }
    assert_eq!(drawn, flowchart, "{COMMAND} draws it anew");
}
