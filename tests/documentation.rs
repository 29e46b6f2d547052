//! Links of the documentation: every relative link leads to a file, and to a heading of it. Values that a process is told.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Files and folders with documentation for users, from the root of the repository.
const DOCUMENTS: &[&str] = &[
    "README.md",
    "CHANGELOG.md",
    "CODE_OF_CONDUCT.md",
    "CONTRIBUTING.md",
    "benchmarks",
    "docs",
    "examples",
    "experiments/published",
];

#[test]
fn every_link_leads_to_a_file_and_heading() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut pages = Vec::new();
    for path in DOCUMENTS {
        collect(&root.join(path), &mut pages);
    }
    assert!(pages.len() > DOCUMENTS.len(), "{pages:?}");
    let faults: Vec<String> = pages.iter().flat_map(|page| dead_links(page)).collect();
    assert!(faults.is_empty(), "dead links:\n{}", faults.join("\n"));
}

/// Names of the fields of a configuration, from its refusal of an unknown one.
fn fields<T: serde::de::DeserializeOwned>() -> Vec<String> {
    let refused = serde_json::from_str::<T>(r#"{"?": 0}"#).err().unwrap();
    let names = refused.to_string();
    let names: Vec<String> = names
        .split('`')
        .skip(3)
        .step_by(2)
        .map(str::to_owned)
        .collect();
    assert!(names.len() > 5, "{refused}");
    names
}

#[test]
fn the_page_lists_every_value_that_a_process_is_told() {
    let page = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/explanation/runs.md"));
    let told = page.split("## What a process is told").nth(1).unwrap();
    let rows: Vec<&str> = told
        .lines()
        .filter_map(|line| line.strip_prefix("| ")?.split('|').next())
        .collect();
    let mut names = fields::<runtime::config::RunConfig>();
    names.extend(fields::<runtime::config::RobotInfo>());
    let absent: Vec<&String> = names
        .iter()
        .filter(|name| !rows.iter().any(|row| row.contains(&format!("`{name}`"))))
        .collect();
    assert!(
        absent.is_empty(),
        "docs/explanation/runs.md lacks {absent:?}"
    );
}

#[test]
fn dead_links_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let other = "# One `word`, two\n\n```sh\n# no heading\n```\n";
    std::fs::write(folder.path().join("other.md"), other).unwrap();
    let page = folder.path().join("page.md");
    let text = "# Page\n[a](other.md) [b](other.md#one-word-two) [c](#page) [d](https://e.org/f.md)\n\
                `[e](none.md)`\n```\n[f](none.md)\n```\n";
    std::fs::write(&page, text).unwrap();
    assert_eq!(dead_links(&page), Vec::<String>::new());

    std::fs::write(&page, "[a](none.md)\n[b](other.md#no-heading) [c](#page)\n").unwrap();
    let dead = dead_links(&page).join("\n");
    for (line, link) in [(1, "none.md"), (2, "other.md#no-heading"), (2, "#page")] {
        assert!(dead.contains(&format!("page.md:{line}: {link}")), "{dead}");
    }
}

/// The Markdown files at a path, without build products.
fn collect(path: &Path, pages: &mut Vec<PathBuf>) {
    if path.is_dir() {
        for entry in std::fs::read_dir(path).unwrap() {
            let entry = entry.unwrap().path();
            if !entry.ends_with("target") {
                collect(&entry, pages);
            }
        }
    } else if path.extension().is_some_and(|e| e == "md") {
        pages.push(path.to_owned());
    }
}

/// The relative links of a page that lead nowhere, as `FILE:LINE: LINK`.
fn dead_links(page: &Path) -> Vec<String> {
    let text = read(page);
    let folder = page.parent().unwrap();
    let mut dead = Vec::new();
    for (number, line) in prose(&text) {
        for link in links(line) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() {
                page.to_owned()
            } else {
                folder.join(file)
            };
            let leads = target.exists()
                && (heading.is_empty() || anchors(&read(&target)).contains(heading));
            if !link.contains("://") && !leads {
                dead.push(format!("{}:{number}: {link}", page.display()));
            }
        }
    }
    dead
}

/// The lines outside of code blocks, with their numbers.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut in_code = false;
    (1..).zip(text.lines()).filter(move |(_, line)| {
        let fence = line.trim_start().starts_with("```");
        in_code ^= fence;
        !in_code && !fence
    })
}

/// The targets of the links in a line, without those in code.
fn links(line: &str) -> impl Iterator<Item = &str> {
    let targets = line.match_indices("](").filter_map(|(at, _)| {
        let code = line[..at].matches('`').count() % 2 == 1;
        let rest = &line[at + 2..];
        let end = rest.find(')')?;
        (!code).then_some(&rest[..end])
    });
    targets.filter(|target| !target.contains(' '))
}

/// The anchors that viewers of Markdown give to the headings of a page.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = prose(text).filter_map(|(_, line)| line.strip_prefix('#'));
    let anchor = |heading: &str| {
        let words = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = words.chars().filter_map(|c| match c {
            ' ' => Some('-'),
            '-' | '_' => Some(c),
            c => c.is_alphanumeric().then_some(c),
        });
        kept.collect()
    };
    headings.map(anchor).collect()
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}
