//! Reader of test files, and of scenarios with `[expect]`.

use std::path::{Path, PathBuf};

use config::{Code, Diagnostic, Diagnostics, FieldPath, Node, Value};
use platform::shell;
use scenario::expect::ExpectSpec;
use scenario::files::read_text;
use scenario::spec::{Mode, RunSpec};
use scenario::{Draft, Loader, MapCache, Template};
use serde::Deserialize;
use serde::de::IgnoredAny;
use sweep::{LoadOptions, Reader, Seeds, read_overrides};

use crate::expectation::{ExpectReader, Expectation};

/// Maximum size of a test file (bytes); a scenario may contain its map.
const MAX_FILE: u64 = 64 << 20;

/// Maximum number of missions of a test.
const MAX_MISSIONS: u64 = 1_000_000;

/// A test: missions of a scenario, and what is expected of them.
pub struct MissionTest {
    /// Name: that of its file without extension, and its own if the file has several.
    pub name: String,
    /// Its file.
    pub file: PathBuf,
    /// Its line in the file.
    pub line: usize,
    /// Its index among `[[test]]`; `None` if the file is one test.
    pub(crate) block: Option<usize>,
    /// The scenario, as `protean run` takes it.
    target: String,
    /// Overrides, as `--set` takes them.
    overrides: Vec<String>,
    /// `true` if it starts external programs.
    pub external: bool,
    pub(crate) template: Template,
    pub(crate) seeds: Vec<u64>,
    pub(crate) outcome_only: bool,
    pub(crate) expectations: Vec<Expectation>,
}

impl MissionTest {
    /// Returns the command that runs one of its missions again, with a log.
    pub fn command(&self, seed: u64) -> String {
        let mut words = vec!["protean", "run", self.target.as_str()];
        for set in &self.overrides {
            words.extend(["--set", set.as_str()]);
        }
        let seed = seed.to_string();
        words.extend(["--seed", seed.as_str()]);
        words.extend(self.external.then_some("--allow-external"));
        shell::line(words)
    }
}

/// The keys of a test.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TestSpec {
    #[serde(default)]
    name: Option<String>,
    scenario: String,
    #[serde(default)]
    seed: Option<u64>,
    #[serde(default)]
    seeds: Option<IgnoredAny>,
    #[serde(default, rename = "set")]
    _set: Option<IgnoredAny>,
    #[serde(rename = "expect")]
    _expect: IgnoredAny,
}

/// Loads the tests of files and folders; without any, those of `tests/*.toml`. Those whose names do not contain
/// `filter` are left out.
///
/// # Errors
/// All problems, each with file, line, key, value and expectation.
pub fn load(
    paths: &[PathBuf],
    filter: &str,
    options: &LoadOptions,
) -> Result<Vec<MissionTest>, Diagnostics> {
    let mut suite = Suite {
        options,
        filter,
        maps: MapCache::default(),
        tests: Vec::new(),
    };
    let mut problems = Diagnostics::default();
    let default = [PathBuf::from("tests")];
    for path in if paths.is_empty() { &default } else { paths } {
        if let Err(found) = suite.add(path) {
            found
                .iter()
                .for_each(|problem| problems.push(problem.clone()));
        }
    }
    if suite.tests.is_empty() && problems.is_empty() {
        let message = if filter.is_empty() {
            "there are no tests".to_owned()
        } else {
            format!("no test has {filter:?} in its name")
        };
        let expected = "files with `scenario` or `[[test]]`, or scenarios with `[expect]`";
        problems.push(Diagnostic::new(Code::File, message).expected(expected));
    }
    problems.into_result(suite.tests)
}

/// Tests of all files so far.
struct Suite<'a> {
    options: &'a LoadOptions,
    filter: &'a str,
    maps: MapCache,
    tests: Vec<MissionTest>,
}

/// A test during reading.
struct Part {
    name: String,
    block: Option<usize>,
    /// Path of the table of the test.
    path: FieldPath,
    target: String,
    draft: Draft<'static>,
    overrides: Vec<String>,
    /// Its seeds, if it has its own.
    seeds: Option<Seeds>,
    seed: u64,
}

impl Suite<'_> {
    /// Adds the tests of a file, or of the files of a folder.
    fn add(&mut self, path: &Path) -> Result<(), Diagnostics> {
        let refuse = |message: String| {
            let expected = "a test file, a scenario with `[expect]`, or a folder with these";
            let problem = Diagnostic::new(Code::File, message).value(path.display());
            Diagnostics::from(problem.expected(expected))
        };
        // Reading tells why nothing is there.
        if !matches!(path.metadata(), Ok(found) if found.is_dir()) {
            let text = read_text(path, MAX_FILE).map_err(|refused| refuse(refused.message))?;
            if self.file(path, &text)? {
                return Ok(());
            }
            return Err(refuse(format!("{} expects nothing", path.display())));
        }
        let entries = std::fs::read_dir(path).and_then(Iterator::collect::<Result<Vec<_>, _>>);
        let entries =
            entries.map_err(|error| refuse(format!("cannot list the folder: {error}")))?;
        let mut files: Vec<PathBuf> = entries.into_iter().map(|entry| entry.path()).collect();
        files.retain(|file| file.extension().is_some_and(|ending| ending == "toml"));
        files.sort();
        for file in files {
            let text = read_text(&file, MAX_FILE).map_err(|refused| refuse(refused.message))?;
            self.file(&file, &text)?;
        }
        Ok(())
    }

    /// Adds the tests of a file; returns `false` if it has none.
    fn file(&mut self, path: &Path, text: &str) -> Result<bool, Diagnostics> {
        let mut reader = Reader::new(&path.display().to_string(), text)?;
        let stem = path.with_extension("").display().to_string();
        let stem = stem.trim_start_matches("./");
        let has = |key: &str| reader.root.get(key).is_some();
        if has("test") {
            if let Some(other) = ["scenario", "expect"].into_iter().find(|key| has(key)) {
                let expected = "this key in each [[test]]";
                reader.refuse(
                    &FieldPath::key(other),
                    Code::Requirement,
                    "a key beside [[test]]",
                    expected,
                );
            }
            for (index, (at, node)) in reader.blocks("test").into_iter().enumerate() {
                let own = node.get("name").and_then(Node::as_str).map(str::to_owned);
                let own = own.unwrap_or_else(|| (index + 1).to_string());
                self.test(
                    &mut reader,
                    path,
                    (at, &node),
                    format!("{stem}/{own}"),
                    Some(index),
                );
            }
        } else if has("scenario") {
            let root = reader.root.clone();
            self.test(
                &mut reader,
                path,
                (FieldPath::default(), &root),
                stem.to_owned(),
                None,
            );
        } else if has("expect") {
            self.scenario(&mut reader, path, stem.to_owned());
        } else {
            return Ok(false);
        }
        if reader.problems.is_empty() {
            return Ok(true);
        }
        Err(reader.problems.sorted())
    }

    /// Adds a test of a test file.
    fn test(
        &mut self,
        reader: &mut Reader,
        file: &Path,
        (path, node): (FieldPath, &Node),
        name: String,
        block: Option<usize>,
    ) {
        let Some(spec) = reader.read::<TestSpec>(node, &path) else {
            return;
        };
        if self.tests.iter().any(|test| test.name == name) {
            let message = format!("two tests `{}`", spec.name.as_deref().unwrap_or(&name));
            reader.refuse(
                &path.then("name"),
                Code::Duplicate,
                &message,
                "different names",
            );
        }
        if !name.contains(self.filter) {
            return;
        }
        let is_file = spec.scenario.contains(['/', '.']);
        let target = if is_file {
            let folder = file.parent().unwrap_or(Path::new(""));
            folder.join(&spec.scenario).display().to_string()
        } else {
            spec.scenario
        };
        let Some(draft) = self.draft(reader, &path.then("scenario"), &target) else {
            return;
        };
        let sets = match node.get("set") {
            Some(set) => read_overrides(reader, &path.then("set"), set),
            None => Vec::new(),
        };
        let mut part = Part {
            seed: seed_of(&draft),
            seeds: node
                .get("seeds")
                .and_then(|node| seeds(reader, &path.then("seeds"), node)),
            name,
            block,
            path: path.clone(),
            target,
            draft,
            overrides: Vec::new(),
        };
        if let Some(seed) = spec.seed {
            part.seed = seed;
            if spec.seeds.is_some() {
                reader.refuse(
                    &path.then("seeds"),
                    Code::Requirement,
                    "`seeds` beside `seed`",
                    "one of them",
                );
            }
        }
        for set in sets {
            part.draft.apply(&set.label, &set.argument);
            part.overrides.push(set.argument);
        }
        self.finish(reader, file, part);
    }

    /// Adds the test of a scenario with `[expect]`.
    fn scenario(&mut self, reader: &mut Reader, file: &Path, name: String) {
        if !name.contains(self.filter) {
            return;
        }
        let target = format!(
            "{}{}",
            if file.components().count() == 1 {
                "./"
            } else {
                ""
            },
            file.display()
        );
        let Some(draft) = self.draft(reader, &FieldPath::key("expect"), &target) else {
            return;
        };
        let part = Part {
            seed: seed_of(&draft),
            seeds: None,
            name,
            block: None,
            path: FieldPath::default(),
            target,
            draft,
            overrides: Vec::new(),
        };
        self.finish(reader, file, part);
    }

    /// Opens a scenario; problems without a place are reported at the key that names it.
    fn draft(&self, reader: &mut Reader, path: &FieldPath, target: &str) -> Option<Draft<'static>> {
        let loader = Loader::new(self.options.kinds).allow_outside(self.options.allow_outside);
        let found = loader.draft(target);
        found
            .map_err(|problems| place_at(reader, path, &problems))
            .ok()
    }

    /// Resolves the scenario of a test, and reads its seeds and expectations.
    fn finish(&mut self, reader: &mut Reader, file: &Path, mut part: Part) {
        for set in &self.options.set {
            part.draft.apply("--set", set);
            part.overrides.push(set.clone());
        }
        let path = part.path.then("expect");
        let Some(node) = reader.root.at(&path).cloned() else {
            return;
        };
        let template = match part.draft.clone().template(&mut self.maps) {
            Ok(template) => template,
            Err(problems) => return place_at(reader, &part.path.then("scenario"), &problems),
        };
        let Some(spec) = reader.read::<ExpectSpec>(&node, &path) else {
            return;
        };
        let scenario = template.scenario();
        if scenario.run.mode != Mode::LockStep {
            let message =
                "a test needs `run.mode = \"lock_step\"`: real-time results cannot be reproduced";
            reader.refuse(
                &part.path.then("scenario"),
                Code::Requirement,
                message,
                "a scenario in lock-step",
            );
        }
        let external = scenario.uses_external_commands();
        if external && !self.options.allow_external {
            let message = "the scenario starts an external program";
            let expected = "--processes --allow-external, after a review of the program";
            reader.refuse(
                &part.path.then("scenario"),
                Code::Requirement,
                message,
                expected,
            );
        }
        let Some(seeds) = missions(reader, &path, &spec, &part) else {
            return;
        };
        let mut expect = ExpectReader {
            reader,
            base: path.clone(),
            scenario,
            seeds: &seeds,
            found: Vec::new(),
        };
        expect.read(&spec);
        let expectations = expect.found;
        let origin = reader.root.at(&part.path).unwrap_or(&reader.root).origin;
        self.tests.push(MissionTest {
            name: part.name,
            file: file.to_owned(),
            line: reader.sources.place(origin).map_or(1, |place| place.line),
            block: part.block,
            target: part.target,
            overrides: part.overrides,
            external,
            seeds,
            outcome_only: spec.outcome_only,
            expectations,
            template,
        });
    }
}

/// Reports the problems of a scenario; those without a place at the key that names it.
fn place_at(reader: &mut Reader, path: &FieldPath, problems: &Diagnostics) {
    for problem in problems.iter() {
        let mut problem = problem.clone();
        if problem.place.is_none() {
            let origin = reader.root.origin_along(path);
            problem = problem.at(reader.sources.place(origin)).field(path);
        }
        reader.problems.push(problem);
    }
}

/// Returns the seed of a scenario.
fn seed_of(draft: &Draft<'_>) -> u64 {
    match draft.find("run.seed").map(|node| &node.value) {
        Some(Value::Int(seed)) if *seed >= 0 => seed.cast_unsigned(),
        _ => RunSpec::default().seed,
    }
}

/// Reads `seeds`.
fn seeds(reader: &mut Reader, path: &FieldPath, node: &Node) -> Option<Seeds> {
    const FORM: &str = "a range such as \"1..200\", or an array of seeds";
    if let Some(text) = node.as_str() {
        match Seeds::parse(text) {
            Ok(seeds) => return Some(seeds),
            Err(error) => reader.refuse(path, Code::OutOfRange, &error.to_string(), FORM),
        }
        return None;
    }
    if node.as_array().is_none() {
        reader.wrong_type(path, node, FORM);
        return None;
    }
    let seeds: Vec<u64> = reader.read(node, path)?;
    if seeds.is_empty() {
        reader.refuse(path, Code::Requirement, "no seeds: nothing to run", FORM);
    }
    Some(Seeds::of(seeds))
}

/// Returns the seeds of the missions of a test.
fn missions(
    reader: &mut Reader,
    path: &FieldPath,
    spec: &ExpectSpec,
    part: &Part,
) -> Option<Vec<u64>> {
    let shares = spec.escape_share.iter().chain(spec.shares.values());
    let shares = shares.filter_map(|share| share.over);
    let over = shares
        .chain(spec.means.values().filter_map(|mean| mean.over))
        .max();
    let range = match (&part.seeds, over) {
        (Some(seeds), None) => return Some(seeds.iter().collect()),
        (Some(_), Some(_)) => {
            let at = part.path.then("seeds");
            reader.refuse(
                &at,
                Code::Requirement,
                "`seeds` beside `over`",
                "one of them",
            );
            return None;
        }
        (None, over) => over.unwrap_or(1),
    };
    let seeds = Seeds::range(part.seed, range.min(MAX_MISSIONS))
        .filter(|_| (1..=MAX_MISSIONS).contains(&range));
    if seeds.is_none() {
        let message = format!("{range} missions from seed {} on", part.seed);
        let expected = format!("`over` from 1 to {MAX_MISSIONS}, seeds below 2^63");
        reader.refuse(path, Code::OutOfRange, &message, &expected);
    }
    seeds.map(|seeds| seeds.iter().collect())
}
