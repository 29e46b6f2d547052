//! The rules of the tree and what breaks them.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

use super::graph::{Arrows, cycles};
use super::manifests::{Package, packages};
use super::sources::{self, Sources, Use};

/// The rules of a source tree.
#[derive(Debug, Clone, Copy)]
pub struct Rules {
    /// Crates by floor, bottom up: a crate depends on crates of lower floors only. `folder/*` are the crates of a
    /// folder that no rule names.
    pub floors: &'static [&'static [&'static str]],
    /// Crates that few others may depend on, with these.
    pub only: &'static [(&'static [&'static str], &'static [&'static str])],
    /// Most lines of a file.
    pub max_file_lines: usize,
    /// Most lines of a crate: of `src/`, comments and blank lines included, without what is compiled for
    /// tests only.
    pub max_crate_lines: usize,
    /// Faults that are not reported: each the file and the beginning of the message. One that is not
    /// there is a fault.
    pub known: &'static [(&'static str, &'static str)],
}

/// A place that breaks a rule.
#[derive(Debug, PartialEq, Eq)]
pub struct Fault {
    /// Relative to the root of the workspace.
    pub file: PathBuf,
    /// From 1.
    pub line: usize,
    /// The offending text and the rule that forbids it.
    pub message: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file.display(), self.line, self.message)
    }
}

/// All faults of the workspace at `root`.
pub fn check(root: &Path, rules: &Rules) -> Vec<Fault> {
    let packages = packages(root);
    let mut faults = floors(&packages, rules);
    faults.extend(only(&packages, rules));
    faults.extend(long_files(root, Path::new(""), rules));
    for package in &packages {
        faults.extend(in_package(root, package, rules));
    }
    excuse(faults, rules.known)
}

/// The faults without the known ones, and with those of them that are no longer there.
fn excuse(mut faults: Vec<Fault>, known: &[(&str, &str)]) -> Vec<Fault> {
    for (file, message) in known {
        let before = faults.len();
        faults.retain(|fault| fault.file != Path::new(file) || !fault.message.starts_with(message));
        if faults.len() == before {
            faults.push(Fault {
                file: PathBuf::from("tests/structure.rs"),
                line: 1,
                message: format!("take the known fault off the list: {file}: {message}"),
            });
        }
    }
    faults
}

/// The crates that entries of a list stand for: by their names, or by `folder/*` those of a folder that none of the
/// `named` ones is.
fn expand<'a>(entries: &[&'a str], packages: &'a [Package], named: &[&str]) -> Vec<&'a str> {
    let mut crates = Vec::new();
    for entry in entries {
        let Some(folder) = entry.strip_suffix("/*") else {
            crates.push(*entry);
            continue;
        };
        let within = packages
            .iter()
            .filter(|package| package.folder.parent() == Some(Path::new(folder)));
        let names = within.map(|package| package.name.as_str());
        crates.extend(names.filter(|name| !named.contains(name)));
    }
    crates
}

fn floors(packages: &[Package], rules: &Rules) -> Vec<Fault> {
    let named = rules.floors.concat();
    let floor_of: BTreeMap<&str, usize> = rules
        .floors
        .iter()
        .map(|entries| expand(entries, packages, &named))
        .enumerate()
        .flat_map(|(i, crates)| crates.into_iter().map(move |name| (name, i + 1)))
        .collect();
    let mut faults = Vec::new();
    for name in floor_of.keys() {
        if !packages.iter().any(|package| package.name == **name) {
            faults.push(Fault {
                file: PathBuf::from("tests/structure.rs"),
                line: 1,
                message: format!("the list of floors names `{name}`, which is no crate"),
            });
        }
    }
    for package in packages {
        let Some(own) = floor_of.get(package.name.as_str()) else {
            faults.push(Fault {
                file: package.manifest(),
                line: 1,
                message: format!(
                    "`{}` is not on the list of floors in tests/structure.rs",
                    package.name
                ),
            });
            continue;
        };
        for dependency in &package.dependencies {
            let Some(below) = floor_of.get(dependency.name.as_str()) else {
                continue;
            };
            if below >= own {
                faults.push(Fault {
                    file: package.manifest(),
                    line: dependency.line,
                    message: format!(
                        "`{}` on floor {own} depends on `{}` on floor {below}; dependencies go \
                         to lower floors only (tests/structure.rs)",
                        package.name, dependency.name
                    ),
                });
            }
        }
    }
    faults
}

fn only(packages: &[Package], rules: &Rules) -> Vec<Fault> {
    let mut named = rules.floors.concat();
    named.extend(rules.only.iter().flat_map(|(crates, _)| *crates));
    let mut faults = Vec::new();
    for package in packages {
        for dependency in &package.dependencies {
            for (crates, users) in rules.only {
                let name = package.name.as_str();
                let crates = expand(crates, packages, &named);
                let reserved = crates.contains(&dependency.name.as_str());
                if reserved && !users.contains(&name) {
                    faults.push(Fault {
                        file: package.manifest(),
                        line: dependency.line,
                        message: format!(
                            "`{name}` depends on `{}`; only {} may",
                            dependency.name,
                            users.join(", ")
                        ),
                    });
                }
            }
        }
    }
    faults
}

/// Files of a folder and those below that have too many lines.
fn long_files(root: &Path, folder: &Path, rules: &Rules) -> Vec<Fault> {
    let mut entries: Vec<_> = std::fs::read_dir(root.join(folder))
        .unwrap()
        .map(Result::unwrap)
        .collect();
    entries.sort_by_key(std::fs::DirEntry::file_name);
    let mut faults = Vec::new();
    for entry in entries {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let path = folder.join(&*name);
        if entry.file_type().unwrap().is_dir() {
            if name != "target" && !name.starts_with('.') {
                faults.extend(long_files(root, &path, rules));
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let lines = std::fs::read_to_string(entry.path())
                .unwrap()
                .lines()
                .count();
            if lines > rules.max_file_lines {
                faults.push(Fault {
                    file: path,
                    line: rules.max_file_lines + 1,
                    message: format!(
                        "the file has {lines} lines; at most {} are allowed",
                        rules.max_file_lines
                    ),
                });
            }
        }
    }
    faults
}

/// Faults within a crate: its size, errors that are texts, and cycles between its modules.
fn in_package(root: &Path, package: &Package, rules: &Rules) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut lines = 0;
    for file in ["src/lib.rs", "src/main.rs"] {
        let path = root.join(&package.folder).join(file);
        if !path.is_file() {
            continue;
        }
        match sources::read(&path) {
            Ok(sources) => {
                lines += sources.lines;
                faults.extend(text_errors(root, &sources));
                faults.extend(module_cycles(root, &sources));
            }
            Err(message) => faults.push(Fault {
                file: package.folder.join(file),
                line: 1,
                message,
            }),
        }
    }
    if lines > rules.max_crate_lines {
        faults.push(Fault {
            file: package.manifest(),
            line: 1,
            message: format!(
                "`{}` has {lines} lines without tests; at most {} are allowed",
                package.name, rules.max_crate_lines
            ),
        });
    }
    faults
}

fn text_errors(root: &Path, sources: &Sources) -> impl Iterator<Item = Fault> {
    sources.text_errors.iter().map(move |(file, line)| Fault {
        file: file.strip_prefix(root).unwrap_or(file).to_owned(),
        line: *line,
        message: "the error of this `Result` is a `String`; errors are types (`thiserror`)".into(),
    })
}

/// Cycles between the modules of each module. What stands in a module itself has no place in their order: it may use
/// any of them, and they may use it.
fn module_cycles(root: &Path, sources: &Sources) -> Vec<Fault> {
    let mut graphs: BTreeMap<&[String], Arrows<&Use>> = BTreeMap::new();
    for used in &sources.uses {
        let both = used.from.iter().zip(&used.to);
        let shared = both.take_while(|(from, to)| from == to).count();
        if let (Some(from), Some(to)) = (used.from.get(shared), used.to.get(shared)) {
            let arrows = graphs.entry(&used.from[..shared]).or_default();
            let from = arrows.entry(from.clone()).or_default();
            from.entry(to.clone()).or_insert(used);
        }
    }
    let faults = graphs.values().map(|arrows| cycles_of(root, arrows));
    faults.flatten().collect()
}

fn cycles_of(root: &Path, arrows: &Arrows<&Use>) -> Vec<Fault> {
    cycles(arrows)
        .into_iter()
        .map(|cycle| {
            let places: Vec<&Use> = cycle
                .iter()
                .zip(cycle.iter().cycle().skip(1))
                .map(|(from, to)| arrows[from][to])
                .collect();
            let relative = |used: &Use| {
                let file = used.file.strip_prefix(root).unwrap_or(&used.file);
                file.to_owned()
            };
            let others: Vec<String> = places[1..]
                .iter()
                .map(|used| format!("{}:{}", relative(used).display(), used.line))
                .collect();
            Fault {
                file: relative(places[0]),
                line: places[0].line,
                message: format!(
                    "modules use each other in a cycle: {} → {} (the other uses: {}); modules of \
                     a crate must have an order",
                    cycle.join(" → "),
                    cycle[0],
                    others.join(", ")
                ),
            }
        })
        .collect()
}
