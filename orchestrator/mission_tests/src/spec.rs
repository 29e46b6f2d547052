//! The keys of test files.

use std::path::{Path, PathBuf};

use parameters::{for_people, schema_generator};
use scenario::expect::ExpectSpec;
use schemars::{JsonSchema, Schema};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::{Map, Value};

/// A test file.
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "the schema alone")]
enum TestFile {
    /// One test.
    One(Box<TestSpec>),
    /// Several tests.
    Several {
        /// The tests.
        test: Vec<TestSpec>,
    },
}

/// Missions of a scenario, and what is expected of them.
#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TestSpec {
    /// Name of the test, in a file with several.
    #[serde(default)]
    pub name: Option<String>,
    /// Name of a built-in scenario, or path of a scenario file from the folder of this file.
    pub scenario: String,
    /// Seed of the mission, or of the first one; that of the scenario if absent.
    #[serde(default)]
    pub seed: Option<u64>,
    /// Seeds of several missions.
    #[serde(default)]
    pub seeds: Option<SeedList>,
    /// Values that replace those of the scenario, by their dotted keys.
    #[serde(default, rename = "set")]
    #[schemars(with = "Option<Map<String, Value>>")]
    pub _set: Option<IgnoredAny>,
    /// Expected results of every mission, or of all of them.
    #[serde(rename = "expect")]
    #[schemars(with = "ExpectSpec")]
    pub _expect: IgnoredAny,
}

impl TestSpec {
    /// Returns the test of a scenario file with `[expect]`.
    pub fn of_scenario(file: &Path) -> Self {
        let name = file.file_name().unwrap_or_default();
        Self {
            // With a slash: a bare name may be that of a built-in scenario.
            scenario: format!("./{}", name.display()),
            ..Self::default()
        }
    }

    /// Returns the scenario, as `protean run` takes it, of a test in this file.
    pub fn target(&self, file: &Path) -> String {
        let is_file = self.scenario.contains(['/', '.']);
        let folder = file.parent().filter(|_| is_file);
        let path = folder.unwrap_or(Path::new("")).join(&self.scenario);
        // Without `.` between the folders.
        path.components().collect::<PathBuf>().display().to_string()
    }
}

/// Seeds of several missions.
#[derive(Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected a range such as \"1..200\", or an array of seeds"
)]
pub enum SeedList {
    /// A range, both ends included: `"1..200"`.
    Range(String),
    /// Each seed.
    Each(Vec<u64>),
}

impl SeedList {
    /// Its form, for errors.
    pub const FORM: &'static str = "a range such as \"1..200\", or an array of seeds";
}

/// Returns the schema of a test file.
pub fn schema() -> Schema {
    let mut schema = schema_generator().into_root_schema_for::<TestFile>();
    schema.insert("title".into(), "Protean test".into());
    for_people(&mut schema);
    schema
}
