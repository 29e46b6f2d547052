//! The reference of parameters, written from their declarations.

use std::path::Path;
use std::{env, fs};

use crate::KINDS;

/// How the file is written anew.
const COMMAND: &str = "PROTEAN_DOCS=write cargo test -p kinds reference";

/// `docs/reference/parameters.md` as the declarations give it.
fn reference() -> String {
    let mut text = format!(
        "# Parameters of the processes\n\nThe keys of `params` in a `[[processes]]` table of a \
         scenario, by `kind`; [scenario.md](../scenario.md) says how they are used. This file is \
         written from the declarations in the code by `{COMMAND}`.\n"
    );
    for kind in KINDS {
        let (name, table) = (kind.name, kind.parameter_table());
        let (first, rest) = kind.summary.split_at(1);
        let first = first.to_uppercase();
        text.push_str(&format!("\n## `{name}`\n\n{first}{rest}.\n\n{table}"));
    }
    text
}

#[test]
fn the_reference_of_parameters_is_what_the_code_declares() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/parameters.md");
    if env::var_os("PROTEAN_DOCS").is_some_and(|word| word == "write") {
        fs::write(&path, reference()).unwrap();
    }
    let found = fs::read_to_string(&path).unwrap();
    let file = path.display();
    assert!(
        found == reference(),
        "{file} is not what the code declares: {COMMAND}"
    );
}
