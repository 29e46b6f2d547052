//! Reader of test files, and of scenarios with `[expect]`.

use std::path::{Path, PathBuf};

use config::{Code, Diagnostic, Diagnostics, FieldPath, Node, Value};
use platform::shell;
use scenario::expect::ExpectSpec;
use scenario::files::read_text;
use scenario::spec::{Mode, RunSpec};
use scenario::{Draft, Loader, MapCache, Template};
use sweep::spec::MAX_MISSIONS;
use sweep::{LoadOptions, Reader, Seeds, read_overrides};

use crate::expectation::{ExpectReader, Expectation};
use crate::spec::{SeedList, TestSpec};

/// Maximum size of a test file (bytes); a scenario may contain its map.
const MAX_FILE: u64 = 64 << 20;

/// Files with tests, for errors.
const EXPECTED: &str = "files with `scenario` or `[[test]]`, or scenarios with `[expect]`";

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
        let is_external = self.template.scenario().uses_external_commands();
        words.extend(is_external.then_some("--allow-external"));
        shell::line(words)
    }
}

/// Loads the tests of files, and of the files with tests of folders; without any, those of `tests/*.toml`. Those whose
/// names do not contain `filter` are left out.
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
    if suite.tests.is_empty() {
        problems.push_if_empty(|| {
            let message = format!("no test has {filter:?} in its name");
            Diagnostic::new(Code::File, message).expected("a part of a name")
        });
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

/// A table of a file that is a test.
struct Part<'a> {
    file: &'a Path,
    name: String,
    block: Option<usize>,
    /// Path of the table.
    path: FieldPath,
    /// The key that names the scenario; `expect` in a scenario itself.
    key: FieldPath,
}

impl Suite<'_> {
    /// Adds the tests of a file, or of the files of a folder.
    fn add(&mut self, path: &Path) -> Result<(), Diagnostics> {
        let refuse = |message: String| {
            let problem = Diagnostic::new(Code::File, message).value(path.display());
            Diagnostics::from(problem.expected(EXPECTED))
        };
        let mut files = vec![path.to_owned()];
        // Reading tells why nothing is there.
        if matches!(path.metadata(), Ok(found) if found.is_dir()) {
            let entries = std::fs::read_dir(path).and_then(Iterator::collect::<Result<Vec<_>, _>>);
            let entries =
                entries.map_err(|error| refuse(format!("cannot list the folder: {error}")))?;
            files = entries.into_iter().map(|entry| entry.path()).collect();
            files.retain(|file| file.extension().is_some_and(|ending| ending == "toml"));
            files.sort();
        }
        let mut has_tests = false;
        for file in files {
            let text = read_text(&file, MAX_FILE).map_err(|refused| refuse(refused.message))?;
            has_tests |= self.file(&file, &text)?;
        }
        if has_tests {
            return Ok(());
        }
        Err(refuse(format!("there are no tests in {}", path.display())))
    }

    /// Adds the tests of a file; returns `false` if it has none.
    fn file(&mut self, file: &Path, text: &str) -> Result<bool, Diagnostics> {
        let mut reader = Reader::new(&file.display().to_string(), text)?;
        let root = reader.root.clone();
        // Cargo.toml may have [[test]], too.
        let is_test = |node: &Node| node.get("scenario").or(node.get("expect")).is_some();
        let blocks = root.get("test").and_then(Node::as_array);
        let is_one = is_test(&root);
        if !is_one && !blocks.is_some_and(|blocks| blocks.iter().any(is_test)) {
            return Ok(false);
        }
        let tables = if is_one {
            vec![(FieldPath::default(), root)]
        } else {
            reader.blocks("test")
        };
        let stem = file.with_extension("").display().to_string();
        let stem = stem.trim_start_matches("./");
        for (index, (path, node)) in tables.into_iter().enumerate() {
            let own = node.get("name").and_then(Node::as_str);
            let own = own.map_or_else(|| (index + 1).to_string(), str::to_owned);
            let is_scenario = is_one && node.get("scenario").is_none();
            let part = Part {
                file,
                name: if is_one {
                    stem.to_owned()
                } else {
                    format!("{stem}/{own}")
                },
                block: (!is_one).then_some(index),
                key: path.then(if is_scenario { "expect" } else { "scenario" }),
                path,
            };
            let spec = if is_scenario {
                Some(TestSpec::of_scenario(file))
            } else {
                reader.read(&node, &part.path)
            };
            let Some(spec) = spec else { continue };
            // Problems without a place are reported at the key.
            if let Err(problems) = self.test(&mut reader, &part, &spec) {
                for problem in problems.iter() {
                    let mut problem = problem.clone();
                    if problem.place.is_none() {
                        let place = reader.sources.place(reader.root.origin_along(&part.key));
                        problem = problem.at(place).field(&part.key);
                    }
                    reader.problems.push(problem);
                }
            }
        }
        if reader.problems.is_empty() {
            return Ok(true);
        }
        Err(reader.problems.sorted())
    }

    /// Adds a test; returns the problems of its scenario.
    fn test(
        &mut self,
        reader: &mut Reader,
        part: &Part<'_>,
        spec: &TestSpec,
    ) -> Result<(), Diagnostics> {
        if self.tests.iter().any(|test| test.name == part.name) {
            let message = format!("two tests `{}`", spec.name.as_deref().unwrap_or(&part.name));
            let key = part.path.then("name");
            reader.refuse(&key, Code::Duplicate, &message, "different names");
        }
        if !part.name.contains(self.filter) {
            return Ok(());
        }
        let loader = Loader::new(self.options.kinds).allow_outside(self.options.allow_outside);
        let target = spec.target(part.file);
        let mut draft = loader.draft(&target)?;
        let first = spec.seed.unwrap_or_else(|| seed_of(&draft));
        let set = part.path.then("set");
        let mut overrides = Vec::new();
        if let Some(node) = reader.root.at(&set).cloned() {
            for set in read_overrides(reader, &set, &node) {
                draft.apply(&set.label, &set.argument);
                overrides.push(set.argument);
            }
        }
        for set in &self.options.set {
            draft.apply("--set", set);
            overrides.push(set.clone());
        }
        let template = sweep::template(draft, &mut self.maps, self.options)?;
        let path = part.path.then("expect");
        let node = reader.root.follow(&path).clone();
        let Some(expect) = reader.read::<ExpectSpec>(&node, &path) else {
            return Ok(());
        };
        let scenario = template.scenario();
        if scenario.run.mode != Mode::LockStep {
            let message =
                "a test needs `run.mode = \"lock_step\"`: real-time results cannot be reproduced";
            let expected = "a scenario in lock-step";
            reader.refuse(&part.key, Code::Requirement, message, expected);
        }
        if scenario.uses_external_commands() && !self.options.allow_external {
            let message = "the scenario starts an external program";
            let expected = "--processes --allow-external, after a review of the program";
            reader.refuse(&part.key, Code::Requirement, message, expected);
        }
        let Some(seeds) = seeds(reader, &part.path, spec, first, over(&expect)) else {
            return Ok(());
        };
        let mut found = ExpectReader {
            reader,
            base: path,
            scenario,
            seeds: &seeds,
            found: Vec::new(),
        };
        found.read(&expect);
        let expectations = found.found;
        let origin = reader.root.follow(&part.path).origin;
        self.tests.push(MissionTest {
            name: part.name.clone(),
            file: part.file.to_owned(),
            line: reader.sources.place(origin).map_or(1, |place| place.line),
            block: part.block,
            target,
            overrides,
            seeds,
            outcome_only: expect.outcome_only,
            expectations,
            template,
        });
        Ok(())
    }
}

/// Returns the seed of a scenario.
fn seed_of(draft: &Draft<'_>) -> u64 {
    match draft.find("run.seed").map(|node| &node.value) {
        Some(Value::Int(seed)) if *seed >= 0 => seed.cast_unsigned(),
        _ => RunSpec::default().seed,
    }
}

/// Returns the number of missions that shares and means need, if they state it.
fn over(expect: &ExpectSpec) -> Option<u64> {
    let shares = expect.escape_share.iter().chain(expect.shares.values());
    let shares = shares.filter_map(|share| share.over);
    let means = expect.means.values().filter_map(|mean| mean.over);
    shares.chain(means).max()
}

/// Returns the seeds of the missions of a test: its own, or `over` from the first on.
fn seeds(
    reader: &mut Reader,
    path: &FieldPath,
    spec: &TestSpec,
    first: u64,
    over: Option<u64>,
) -> Option<Vec<u64>> {
    let at = path.then("seeds");
    if let Some(list) = &spec.seeds {
        for (other, is_there) in [("seed", spec.seed.is_some()), ("over", over.is_some())] {
            if is_there {
                let message = format!("`seeds` beside `{other}`");
                reader.refuse(&at, Code::Requirement, &message, "one of them");
            }
        }
        let seeds = match list {
            SeedList::Range(text) => Seeds::parse(text),
            SeedList::Each(seeds) => Ok(Seeds::from_values(seeds.clone())),
        };
        return match seeds {
            Ok(seeds) if !seeds.is_empty() => Some(seeds.iter().collect()),
            refused => {
                let message = refused.err().map(|error| error.to_string());
                let message = message.as_deref().unwrap_or("no seeds: nothing to run");
                reader.refuse(&at, Code::OutOfRange, message, SeedList::FORM);
                None
            }
        };
    }
    let (count, most) = (over.unwrap_or(1), MAX_MISSIONS as u64);
    let seeds = Seeds::range(first, count.min(most)).filter(|_| (1..=most).contains(&count));
    if seeds.is_none() {
        let message = format!("{count} missions from seed {first} on");
        let expected = format!("`over` from 1 to {most}, seeds below 2^63");
        let expect = path.then("expect");
        reader.refuse(&expect, Code::OutOfRange, &message, &expected);
    }
    seeds.map(|seeds| seeds.iter().collect())
}
