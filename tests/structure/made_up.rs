//! The checks on small made-up workspaces: each rule, kept and broken.

use std::path::Path;

use super::checks::{Rules, check};

/// Three floors; `wire` alone may use `mcap`.
const RULES: Rules = Rules {
    floors: &[&["wire"], &["process", "other"], &["program"]],
    only: &[(&["mcap"], &["wire"])],
    max_file_lines: 12,
    max_crate_lines: 20,
    known: &[],
};

/// A workspace of four crates that keeps all rules, with these files added or replaced.
fn workspace(files: &[(&str, &str)]) -> tempfile::TempDir {
    let tree = tempfile::tempdir().unwrap();
    let write = |path: &str, text: &str| {
        let path = tree.path().join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    write(
        "Cargo.toml",
        "[workspace]\nmembers = [\"wire\", \"processes/*\", \"program\"]\n",
    );
    let manifest = |name: &str, rest: &str| format!("[package]\nname = \"{name}\"\n{rest}");
    write(
        "wire/Cargo.toml",
        &manifest("wire", "[dependencies]\nmcap = \"1\"\n"),
    );
    write(
        "processes/process/Cargo.toml",
        &manifest("process", "[dependencies]\nwire.workspace = true\n"),
    );
    write(
        "processes/other/Cargo.toml",
        &manifest(
            "other",
            "[dependencies]\n\n[dev-dependencies]\nprocess.workspace = true\nmcap = \"1\"\n",
        ),
    );
    write(
        "program/Cargo.toml",
        &manifest("program", "[dependencies]\nother.workspace = true\n"),
    );
    write(
        "wire/src/lib.rs",
        "mod a;\nmod b;\n#[cfg(test)]\nmod tests;\n",
    );
    write("wire/src/a.rs", "use crate::b::B;\npub struct A(B);\n");
    write(
        "wire/src/b.rs",
        "mod inner;\npub struct B;\n#[cfg(test)]\nmod tests {\n    use crate::a::A;\n}\n",
    );
    write(
        "wire/src/b/inner.rs",
        "use super::B;\nuse super::super::b::B as Same;\n",
    );
    write("wire/src/tests.rs", "use crate::a::A;\n");
    write("program/src/main.rs", "fn main() {}\n");
    for (path, text) in files {
        write(path, text);
    }
    tree
}

/// Faults that the checks find in a workspace of these files.
fn faults(files: &[(&str, &str)]) -> Vec<String> {
    let tree = workspace(files);
    let faults = check(tree.path(), &RULES);
    faults.iter().map(ToString::to_string).collect()
}

/// Asserts that there is one fault, and that it begins and goes on like this.
#[track_caller]
fn one_fault(files: &[(&str, &str)], place: &str, words: &[&str]) {
    let faults = faults(files);
    assert_eq!(faults.len(), 1, "{faults:#?}");
    assert!(faults[0].starts_with(place), "{faults:#?}");
    for words in words {
        assert!(faults[0].contains(words), "{words}: {faults:#?}");
    }
}

#[test]
fn a_tree_that_keeps_the_rules_has_no_faults() {
    assert_eq!(faults(&[]), [""; 0]);
}

#[test]
fn a_dependency_on_a_higher_floor_is_a_fault() {
    one_fault(
        &[(
            "wire/Cargo.toml",
            "[package]\nname = \"wire\"\n\n[dependencies]\nprogram.workspace = true\n",
        )],
        "wire/Cargo.toml:5: ",
        &["`wire` on floor 1 depends on `program` on floor 3"],
    );
}

#[test]
fn a_dependency_on_the_same_floor_is_a_fault_under_any_name() {
    one_fault(
        &[(
            "processes/process/Cargo.toml",
            "[package]\nname = \"process\"\n[build-dependencies]\nx = { package = \"other\", path = \"..\" }\n",
        )],
        "processes/process/Cargo.toml:4: ",
        &["`process` on floor 2 depends on `other` on floor 2"],
    );
}

#[test]
fn a_crate_without_a_floor_is_a_fault() {
    one_fault(
        &[("processes/new/Cargo.toml", "[package]\nname = \"new\"\n")],
        "processes/new/Cargo.toml:1: ",
        &["`new` is not on the list of floors"],
    );
}

#[test]
fn the_crates_of_a_folder_follow_its_rules_unless_they_have_their_own() {
    let rules = Rules {
        floors: &[&["wire"], &["processes/*"], &["other"], &["program"]],
        only: &[(&["processes/*"], &["other"])],
        ..RULES
    };
    let of_other = |text| ("processes/other/Cargo.toml", text);
    let uses = "[package]\nname = \"other\"\n[dependencies]\nprocess.workspace = true\n";
    let faults = |files: &[(&str, &str)]| check(workspace(files).path(), &rules);
    assert_eq!(faults(&[of_other(uses)]), []);
    let program = "[package]\nname = \"program\"\n[dependencies]\nprocess.workspace = true\n";
    let found = faults(&[("program/Cargo.toml", program)]);
    assert!(found.len() == 1 && found[0].message.contains("only other may"));
    let process = "[package]\nname = \"process\"\n[dependencies]\nother.workspace = true\n";
    let found = faults(&[("processes/process/Cargo.toml", process)]);
    assert!(found.len() == 1 && found[0].message.contains("`other` on floor 3"));
}

#[test]
fn a_floor_without_its_crate_is_a_fault() {
    let tree = workspace(&[]);
    std::fs::remove_dir_all(tree.path().join("processes/process")).unwrap();
    let faults = check(tree.path(), &RULES);
    assert_eq!(faults.len(), 1, "{faults:?}");
    assert!(faults[0].message.contains("names `process`"), "{faults:?}");
}

#[test]
fn a_reserved_dependency_is_a_fault() {
    one_fault(
        &[(
            "program/Cargo.toml",
            "[package]\nname = \"program\"\n[dependencies]\nmcap = \"1\"\n",
        )],
        "program/Cargo.toml:4: ",
        &["`program` depends on `mcap`; only wire may"],
    );
}

#[test]
fn a_file_may_have_so_many_lines_and_no_more() {
    let path = "wire/tests/all.rs";
    assert_eq!(faults(&[(path, &"\n".repeat(12))]), [""; 0]);
    let text = "\n".repeat(13);
    one_fault(&[(path, &text)], "wire/tests/all.rs:13: ", &["13 lines"]);
    // What is built, and what is hidden, is not the tree's.
    let built = [("target/x.rs", text.as_str()), (".hidden/x.rs", &text)];
    assert_eq!(faults(&built), [""; 0]);
}

#[test]
fn a_crate_may_have_so_many_lines_without_tests() {
    let code = "// code\n".repeat(8);
    let files = |text: String| {
        [
            ("program/src/main.rs", text),
            ("program/src/a.rs", code.clone()),
        ]
    };
    let count = |text: String| {
        let files = files(text);
        let files: Vec<(&str, &str)> = files.iter().map(|(p, t)| (*p, t.as_str())).collect();
        faults(&files)
    };
    let tests = "#[cfg(test)]\nmod tests {\n    fn x() {}\n}\n";
    assert_eq!(count(format!("mod a;\n{}", "\n".repeat(11))), [""; 0]);
    let full = count(format!("mod a;\n{}{tests}", "\n".repeat(7)));
    assert_eq!(full, [""; 0], "lines of tests do not count");

    let more = "// code\n".repeat(12);
    one_fault(
        &[
            (
                "program/src/main.rs",
                &format!("mod a;\n{}", "\n".repeat(11)),
            ),
            ("program/src/a.rs", &more),
        ],
        "program/Cargo.toml:1: ",
        &["`program` has 24 lines without tests"],
    );
}

#[test]
fn modules_that_use_each_other_are_a_fault() {
    let places = |text: &str| [("wire/src/b/inner.rs", text.to_owned())];
    for text in [
        "use crate::a::A;\n",
        "use crate::{b::B, a::{self, A as Other}};\n",
        "fn f(_: super::super::a::A) {}\n",
        "mod deep {\n    use super::super::super::a::A;\n}\n",
        "fn f() { assert!(crate::a::yes()); }\n",
    ] {
        let places = places(text);
        let files: Vec<(&str, &str)> = places.iter().map(|(p, t)| (*p, t.as_str())).collect();
        one_fault(
            &files,
            "wire/src/a.rs:1: ",
            &["a → b → a", "wire/src/b/inner.rs:"],
        );
    }
}

#[test]
fn a_name_that_the_root_passes_on_counts_for_its_module() {
    let root = "mod a;\nmod b;\npub use a::{A as Passed};\npub struct Own;\n";
    let uses = |text| [("wire/src/lib.rs", root), ("wire/src/b/inner.rs", text)];
    one_fault(
        &uses("use crate::Passed;\n"),
        "wire/src/a.rs:1: ",
        &["a → b → a"],
    );
    assert_eq!(faults(&uses("use crate::Own;\n")), [""; 0]);
}

#[test]
fn modules_of_a_module_have_an_order_too() {
    let b = |text| ("wire/src/b.rs", text);
    let inner = |text| ("wire/src/b/inner.rs", text);
    let outer = |text| ("wire/src/b/outer.rs", text);
    let modules = "mod inner;\nmod outer;\npub use inner::I;\npub struct B;\n";
    let uses_outer = "use super::outer::O;\npub struct I(O);\n";
    for circle in ["use super::I;\n", "fn f(_: super::inner::I) {}\n"] {
        one_fault(
            &[b(modules), inner(uses_outer), outer(circle)],
            "wire/src/b/inner.rs:1: ",
            &["inner → outer → inner", "wire/src/b/outer.rs:1"],
        );
    }
    // What stands in the module itself, and what it passes on, is of no order.
    let own = [b(modules), inner(uses_outer), outer("use super::B;\n")];
    assert_eq!(faults(&own), [""; 0]);
}

#[test]
fn an_error_that_is_a_text_is_a_fault_outside_tests() {
    let inner = |text| [("wire/src/b/inner.rs", text)];
    for text in [
        "\nfn f() -> Result<(), String> {}\n",
        "\nfn f() -> core::result::Result<Vec<(u8, u8)>, std::string::String,> {}\n",
        "\nfn f(g: impl Fn() -> Result<fn(u8, u8) -> u8, String>) {}\n",
    ] {
        one_fault(
            &inner(text),
            "wire/src/b/inner.rs:2: ",
            &["errors are types"],
        );
    }
    for text in [
        "fn f() -> Result<String, Error> {}\n",
        "fn f() -> Result<Result<u8, Error>, Strings> {}\n",
        "fn f() -> io::Result<String> {}\n",
        "fn f(r: Result<u8, Error>, text: String) {}\n",
        "#[cfg(test)]\nfn f() -> Result<(), String> {}\n",
    ] {
        assert_eq!(faults(&inner(text)), [""; 0], "{text}");
    }
}

#[test]
fn text_and_comments_are_not_uses() {
    let text = "// use crate::a::A;\n/// [`crate::a::A`]\nconst T: &str = \"crate::a::A\";\n";
    assert_eq!(faults(&[("wire/src/b/inner.rs", text)]), [""; 0]);
}

#[test]
fn a_file_that_is_missing_or_not_rust_is_a_fault() {
    let faults = faults(&[("program/src/main.rs", "mod gone;\n")]);
    assert!(faults[0].contains("gone/mod.rs"), "{faults:?}");
    let tree = workspace(&[("program/src/main.rs", "fn main( {}\n")]);
    let faults = check(tree.path(), &RULES);
    assert_eq!(faults[0].file, Path::new("program/src/main.rs"));
}

#[test]
fn a_known_fault_is_passed_over_as_long_as_it_is_there() {
    let rules = Rules {
        known: &[("wire/tests/all.rs", "the file has 13 lines")],
        ..RULES
    };
    let long = "\n".repeat(13);
    let tree = workspace(&[("wire/tests/all.rs", &long)]);
    assert_eq!(check(tree.path(), &rules), []);
    let mended = check(workspace(&[]).path(), &rules);
    assert_eq!(mended.len(), 1, "{mended:?}");
    assert!(
        mended[0].message.contains("take the known fault off"),
        "{mended:?}"
    );
}
