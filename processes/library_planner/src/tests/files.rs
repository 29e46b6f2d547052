//! The header, and files that are no planners.

use std::path::Path;

use super::{build, folder, header};
use crate::Library;

#[test]
fn the_header_of_the_example_is_the_declared_one() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/cpp_planner/protean_planner.h");
    if std::env::var_os("PROTEAN_DOCS").is_some_and(|word| word == "write") {
        std::fs::write(&path, header::planner()).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap();
    let command = "PROTEAN_DOCS=write cargo test -p library_planner header";
    assert!(
        found == header::planner(),
        "{} is not what the code declares: {command}",
        path.display()
    );
}

#[test]
fn files_that_are_no_planners_are_named_with_the_expectation() {
    let folder = folder();
    let refused = |name: &str, words: &[&str]| {
        let path = folder.path().join(name);
        let error = Library::load(&path).unwrap_err().to_string();
        for word in [&[path.to_str().unwrap()], words].concat() {
            assert!(error.contains(word), "{word}: {error}");
        }
    };
    refused(
        "absent.so",
        &["No such file", "expected the shared library of a planner"],
    );
    refused("", &["expected the shared library"]);
    std::fs::write(folder.path().join("text.so"), "not a library").unwrap();
    refused(
        "text.so",
        &["expected the shared library of a planner", "-shared"],
    );
    let table = |fields: &str| {
        format!(
            "#include \"protean_planner.h\"\nstatic void *create(const protean_start *s) {{ (void)s; return 0; }}\n\
             static void steer(void *p, const protean_tick *t, protean_steering *s) {{ (void)p; (void)t; (void)s; }}\n\
             static void destroy(void *p) {{ (void)p; }}\n\
             const protean_planner *protean_planner_table(void) {{\n\
             static const protean_planner table = {{{fields}}};\nreturn &table;\n}}\n"
        )
    };
    let sources = [
        (
            "other.c",
            "int other(void) { return 1; }\n".to_owned(),
            "no function protean_planner_table",
        ),
        (
            "version.c",
            table(".version = 3, .create = create, .steer = steer, .destroy = destroy"),
            "interface version 3: expected version 2",
        ),
        (
            "partial.c",
            table(".version = 2, .create = create, .steer = steer, .destroy = 0 ? destroy : 0"),
            "functions: expected create, destroy, and either steer or step",
        ),
        (
            "inputs.c",
            table(
                ".version = 2, .inputs = 8, .create = create, .steer = steer, .destroy = destroy",
            ),
            "unknown inputs",
        ),
        (
            "null.c",
            table(".version = 2, .create = create, .steer = steer, .destroy = destroy")
                .replace("return &table", "return table.version == 2 ? 0 : &table"),
            "expected the address of a table",
        ),
    ];
    for (name, source, word) in sources {
        if build(folder.path(), name, &source).is_none() {
            return;
        }
        refused(&format!("{name}.so"), &[word]);
    }
}
