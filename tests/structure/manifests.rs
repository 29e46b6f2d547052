//! The packages of a workspace and their dependencies, from its manifests.

use std::path::{Path, PathBuf};

use toml::de::{DeTable, DeValue};

/// One member of the workspace.
#[derive(Debug)]
pub struct Package {
    /// The name of its library, or its own without one: what sources and other manifests call it.
    pub name: String,
    /// Its folder, relative to the root of the workspace.
    pub folder: PathBuf,
    /// Dependencies of its library and programs, without those of tests.
    pub dependencies: Vec<Dependency>,
}

impl Package {
    /// Its manifest, relative to the root of the workspace.
    pub fn manifest(&self) -> PathBuf {
        self.folder.join("Cargo.toml")
    }
}

/// A line of a manifest.
#[derive(Debug)]
pub struct Dependency {
    /// The package depended on.
    pub name: String,
    /// Its line, from 1.
    pub line: usize,
}

/// The members of the workspace at `root`, in the order of their folders' names.
///
/// # Panics
/// If a manifest cannot be read or has unknown contents.
pub fn packages(root: &Path) -> Vec<Package> {
    let manifest = std::fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let manifest: toml::Table = manifest.parse().unwrap();
    let mut folders: Vec<PathBuf> = manifest["workspace"]["members"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|member| expand(root, member.as_str().unwrap()))
        .collect();
    folders.sort();
    folders.dedup();
    folders
        .into_iter()
        .map(|folder| {
            let text = std::fs::read_to_string(root.join(&folder).join("Cargo.toml")).unwrap();
            parse(folder, &text)
        })
        .collect()
}

/// The folders that an entry of `members` names: itself, or all packages of a folder by `folder/*`.
fn expand(root: &Path, member: &str) -> Vec<PathBuf> {
    let Some(parent) = member.strip_suffix("/*") else {
        return vec![PathBuf::from(member)];
    };
    std::fs::read_dir(root.join(parent))
        .unwrap()
        .map(|entry| Path::new(parent).join(entry.unwrap().file_name()))
        .filter(|folder| root.join(folder).join("Cargo.toml").is_file())
        .collect()
}

fn parse(folder: PathBuf, text: &str) -> Package {
    let manifest = DeTable::parse(text).unwrap();
    let table = manifest.get_ref();
    let name_of = |section: &str| {
        table
            .get(section)?
            .get_ref()
            .as_table()?
            .get("name")?
            .get_ref()
            .as_str()
    };
    let name = name_of("lib").or_else(|| name_of("package"));
    let mut package = Package {
        name: name.unwrap().to_owned(),
        folder,
        dependencies: Vec::new(),
    };
    for section in ["dependencies", "build-dependencies"] {
        let dependencies = table
            .get(section)
            .and_then(|section| section.get_ref().as_table());
        for (key, value) in dependencies.into_iter().flatten() {
            package.dependencies.push(Dependency {
                name: package_of(value.get_ref())
                    .unwrap_or(key.get_ref().as_ref())
                    .to_owned(),
                line: 1 + text[..key.span().start].matches('\n').count(),
            });
        }
    }
    package
}

/// The package of a dependency that is renamed.
fn package_of<'a>(dependency: &'a DeValue<'_>) -> Option<&'a str> {
    dependency.as_table()?.get("package")?.get_ref().as_str()
}
