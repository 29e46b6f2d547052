//! Metadata of a release: the files repeat facts of `Cargo.toml`, and this test writes them.

use std::path::{Path, PathBuf};
use std::{env, fs};

use serde_json::json;

/// Command that rewrites the files.
const COMMAND: &str = "PROTEAN_DOCS=write cargo test -p end_to_end metadata::";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap()
}

/// Facts of the workspace.
struct Facts {
    package: toml::Table,
}

impl Facts {
    fn read() -> Self {
        let manifest: toml::Table = read("Cargo.toml").parse().unwrap();
        let package = manifest["workspace"]["package"].as_table().unwrap();
        Self {
            package: package.clone(),
        }
    }

    fn get(&self, key: &str) -> &str {
        self.package[key].as_str().unwrap()
    }

    /// The holders of the rights.
    fn authors() -> String {
        let licence = read("LICENSE-MIT");
        let line = licence
            .lines()
            .find(|line| line.starts_with("Copyright"))
            .unwrap();
        line.split_once("2026 ").unwrap().1.to_owned()
    }

    fn licences(&self) -> Vec<&str> {
        self.get("license").split(" OR ").collect()
    }

    fn citation(&self) -> String {
        let licences = self.licences().join("\n  - ");
        format!(
            "# Written by `{COMMAND}` from Cargo.toml.\n\
             cff-version: 1.2.0\n\
             message: If you use this software, please cite it.\n\
             title: Protean\n\
             type: software\n\
             abstract: {}\n\
             authors:\n  - name: {}\n\
             version: {}\n\
             license:\n  - {licences}\n\
             repository-code: {}\n\
             keywords:\n  - robotics\n  - simulation\n  - multi-robot systems\n  - pursuit-evasion\n  - reproducibility\n",
            self.get("description"),
            Self::authors(),
            self.get("version"),
            self.get("repository"),
        )
    }

    fn codemeta(&self) -> String {
        let licences: Vec<String> = self
            .licences()
            .iter()
            .map(|licence| format!("https://spdx.org/licenses/{licence}"))
            .collect();
        let meta = json!({
            "@context": "https://w3id.org/codemeta/3.0",
            "@type": "SoftwareSourceCode",
            "name": "Protean",
            "description": self.get("description"),
            "version": self.get("version"),
            "license": licences,
            "codeRepository": self.get("repository"),
            "author": [{ "@type": "Organization", "name": Self::authors() }],
            "programmingLanguage": ["Rust", "Python"],
            "operatingSystem": "Linux",
            "softwareRequirements": format!("Rust {} or newer, to build it", self.get("rust-version")),
            "readme": "README.md",
            "releaseNotes": "CHANGELOG.md",
        });
        format!("{}\n", serde_json::to_string_pretty(&meta).unwrap())
    }
}

#[test]
fn files_of_metadata_repeat_the_manifest() {
    let facts = Facts::read();
    for (name, declared) in [
        ("CITATION.cff", facts.citation()),
        ("codemeta.json", facts.codemeta()),
    ] {
        if env::var_os("PROTEAN_DOCS").is_some_and(|word| word == "write") {
            fs::write(root().join(name), &declared).unwrap();
        }
        assert!(
            read(name) == declared,
            "{name} is not what Cargo.toml declares: {COMMAND}"
        );
    }
}

#[test]
fn the_changelog_names_the_version() {
    let facts = Facts::read();
    let version = facts.get("version");
    let changes = read("CHANGELOG.md");
    let first = changes.split("\n## ").nth(1).unwrap();
    let names = |text: &str| first.starts_with(text);
    assert!(
        names(&format!("[{version}] - ")) || names("[Unreleased]") && first.contains(version),
        "{first}"
    );
}
