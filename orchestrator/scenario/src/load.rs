//! Loading a [`ResolvedScenario`] from a path or a name.

use std::path::{Path, PathBuf};

use config::{
    Code, Diagnostic, Diagnostics, Node, SourceKind, Sources, list_choices, nearest, parse_document,
};
use platform::presence;

use super::builtin;
use super::draft::Draft;
use super::files::{Base, read_text};
use super::kind::Kind;
use super::resolved::ResolvedScenario;
use platform::file_kind::FileKind;

/// Maximum size of a scenario file (bytes); a file that contains its map is far smaller.
const MAX_SCENARIO: u64 = 64 << 20;

/// Loader of scenarios.
///
/// ```
/// use scenario::Loader;
///
/// // A program passes its list of kinds, here none.
/// let refused = Loader::new(&[]).load("chse", &[], None).unwrap_err();
/// assert!(refused.to_string().contains("did you mean `chase`?"));
/// ```
#[derive(Clone, Copy)]
pub struct Loader<'k> {
    kinds: &'k [Kind],
    allow_outside: bool,
}

impl<'k> Loader<'k> {
    /// Creates a loader for these kinds of processes.
    pub fn new(kinds: &'k [Kind]) -> Self {
        Self {
            kinds,
            allow_outside: false,
        }
    }

    /// Permits files of the scenario outside its folder.
    #[must_use]
    pub fn allow_outside(self, allow_outside: bool) -> Self {
        Self {
            allow_outside,
            ..self
        }
    }

    /// Loads a scenario.
    ///
    /// `target` is the path of a TOML file or the name of a built-in scenario, `overrides` are
    /// `key=value` arguments, applied in order, and `seed` is applied last.
    ///
    /// # Errors
    /// All problems of the scenario, each with its place.
    pub fn load(
        &self,
        target: &str,
        overrides: &[String],
        seed: Option<u64>,
    ) -> Result<ResolvedScenario, Diagnostics> {
        let mut draft = self.draft(target)?;
        draft.apply_all(overrides, seed);
        draft.resolve()
    }

    /// Reads a scenario without resolving it, for several runs with different overrides and seeds.
    ///
    /// # Errors
    /// The scenario is unreadable or is not TOML.
    pub fn draft(&self, target: &str) -> Result<Draft<'k>, Diagnostics> {
        let path = Path::new(target);
        let is_bare_name = !target.contains(['/', '.']);
        let built_in = builtin::scenario(target);
        if let Some(scenario) =
            built_in.filter(|_| is_bare_name || matches!(presence::entry(path), Ok(None)))
        {
            let file = format!("{}.toml", scenario.name);
            let base = Base::Builtin {
                allow_outside: self.allow_outside,
            };
            return self.draft_text(&file, scenario.text, &base);
        }
        let names = builtin::SCENARIOS.map(|s| s.name);
        let problem = |message: String| {
            Diagnostic::new(Code::File, message)
                .value(target)
                .expected(format!(
                    "the path of a scenario, or a built-in scenario: {}",
                    list_choices(&names)
                ))
        };
        if let Some(other) = FileKind::from_path(path).filter(|kind| *kind != FileKind::Scenario) {
            let problem = problem(format!("{target} is not a scenario"));
            return Err(problem.help(other.help(path)).into());
        }
        let text = read_text(path, MAX_SCENARIO).map_err(|refused| {
            let stem = path.file_stem().and_then(|s| s.to_str());
            let problem = problem(refused.message);
            match nearest(stem.unwrap_or_default(), names) {
                Some(near) => problem.help(format!("did you mean `{near}`?")),
                None => problem,
            }
        })?;
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
            _ => PathBuf::from("."),
        };
        let base = Base::Folder {
            folder,
            allow_outside: self.allow_outside,
        };
        self.draft_text(target, &text, &base)
    }

    /// Loads the text of a scenario. Errors contain `file` as its name; its paths are relative to `base`
    /// ([`Base::Nothing`] for one from a log).
    ///
    /// # Errors
    /// As [`Loader::load`].
    pub fn load_text(
        &self,
        file: &str,
        text: &str,
        base: &Base,
        overrides: &[String],
        seed: Option<u64>,
    ) -> Result<ResolvedScenario, Diagnostics> {
        let mut draft = self.draft_text(file, text, base)?;
        draft.apply_all(overrides, seed);
        draft.resolve()
    }

    /// Parses the text of a scenario without resolving it; arguments as those of [`Loader::load_text`].
    ///
    /// # Errors
    /// The text is not TOML.
    pub fn draft_text(
        &self,
        file: &str,
        text: &str,
        base: &Base,
    ) -> Result<Draft<'k>, Diagnostics> {
        let mut sources = Sources::default();
        let mut problems = Diagnostics::default();
        let source = sources.add(SourceKind::File, file, text);
        let Some(root) = parse_document(&sources, source, &mut problems) else {
            problems.push_if_empty(|| Diagnostic::new(Code::Syntax, "not a scenario"));
            return Err(problems.sorted());
        };
        let stem = Path::new(file)
            .file_stem()
            .and_then(|s| s.to_str())
            .unwrap_or("scenario");
        Ok(Draft {
            sources,
            root,
            problems,
            kinds: self.kinds,
            base: base.clone(),
            stem: stem.to_owned(),
        })
    }
}

/// A built-in scenario in the list of `protean list`.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct ScenarioEntry {
    /// Name to pass to `protean run`.
    pub name: String,
    /// Title.
    pub title: String,
    /// First line of the description.
    pub summary: String,
}

/// Lists the built-in scenarios; the default comes first.
pub fn list() -> Vec<ScenarioEntry> {
    builtin::SCENARIOS
        .iter()
        .map(|s| {
            let mut sources = Sources::default();
            let source = sources.add(SourceKind::File, s.name, s.text);
            let root = parse_document(&sources, source, &mut Diagnostics::default());
            let text = |key: &str| {
                let node = root.as_ref().and_then(|r| r.get(key));
                node.and_then(Node::as_str)
                    .unwrap_or_default()
                    .trim()
                    .to_owned()
            };
            ScenarioEntry {
                name: s.name.to_owned(),
                title: text("title"),
                summary: text("description")
                    .lines()
                    .next()
                    .unwrap_or_default()
                    .to_owned(),
            }
        })
        .collect()
}
