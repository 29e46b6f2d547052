//! Loading of experiment files into validated cells.

use std::path::{Path, PathBuf};

use config::{Code, Diagnostic, Diagnostics, FieldPath, Node};

use super::cases::{Case, read_cases};
use super::cell::Cell;
use super::manifest::{FORMAT, Manifest, ManifestCell};
use super::options::LoadOptions;
use super::parts::{check_name, read_figures, read_run, read_seeds};
use super::reader::Reader;
use super::row::Record as _;
use super::seeds::Seeds;
use super::spec::{FigureSpec, MAX_CELLS, MAX_MISSIONS, RunSpec, TopLevel};
use super::subject::Subject;
use super::table::is_taken;
use super::{grid, parameters};
use platform::file_kind::FileKind;
use scenario::files::read_text;

/// Maximum size of an experiment file (bytes).
pub const MAX_FILE: u64 = 1 << 20;

/// A column of the results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Name.
    pub name: String,
    /// Title, with the unit.
    pub title: String,
}

/// A validated experiment.
#[derive(Debug, Clone)]
pub struct ExperimentOf<S> {
    /// Short name, and name of the directory of its results.
    pub name: String,
    /// Title, one line.
    pub title: String,
    /// Description, some lines.
    pub description: String,
    /// Text of the file.
    pub text: String,
    /// The cases, in the order of the file.
    pub cases: Vec<Case>,
    /// The parameters, in the order of the file.
    pub parameters: Vec<Column>,
    /// Every combination of case and parameters: case by case, the last parameter fastest.
    pub cells: Vec<Cell<S>>,
    /// The seeds, the same for every cell.
    pub seeds: Seeds,
    /// Options of the execution of missions.
    pub run: RunSpec,
    /// Figures that are drawn from the results.
    pub figures: Vec<FigureSpec>,
}

impl<S: Subject> ExperimentOf<S> {
    /// Reads an experiment and validates all its cells.
    ///
    /// # Errors
    /// All problems, each with file, line, field, value and expected value.
    pub fn load(path: &Path, options: &LoadOptions) -> Result<Self, Diagnostics> {
        let problem = |message: String, expected: &str| {
            Diagnostic::new(Code::File, message)
                .value(path.display())
                .expected(format!("the path of an experiment: {expected}"))
        };
        if let Some(other) = FileKind::from_path(path).filter(|kind| *kind != FileKind::Experiment)
        {
            let message = format!("{} is not an experiment", path.display());
            return Err(problem(message, "a TOML file")
                .help(other.help(path))
                .into());
        }
        let text = read_text(path, MAX_FILE)
            .map_err(|refused| problem(refused.message, &refused.expected))?;
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
            _ => PathBuf::from("."),
        };
        let stem = path.file_stem().and_then(|s| s.to_str());
        let label = path.display().to_string();
        Self::from_parts(&label, text, &folder, stem.unwrap_or("experiment"), options)
    }

    fn from_parts(
        label: &str,
        text: String,
        folder: &Path,
        stem: &str,
        options: &LoadOptions,
    ) -> Result<Self, Diagnostics> {
        let mut reader = Reader::new(label, &text)?;
        match Self::read(&mut reader, folder, stem, options) {
            Some(experiment) if reader.problems.is_empty() => Ok(Self { text, ..experiment }),
            _ => {
                let unexplained =
                    || Diagnostic::new(Code::Requirement, "the experiment is incomplete");
                reader.problems.push_if_empty(unexplained);
                Err(reader.problems.sorted())
            }
        }
    }

    fn read(reader: &mut Reader, folder: &Path, stem: &str, options: &LoadOptions) -> Option<Self> {
        let root = reader.root.clone();
        let top: Option<TopLevel> = reader.read(&root, &FieldPath::default());
        let name = root.get("name").and_then(Node::as_str).unwrap_or(stem);
        check_name(reader, &FieldPath::key("name"), name);
        let parameters = parameters::read(reader, is_taken::<S::Row>);
        let combinations = grid::read(reader, &parameters);
        let seeds = read_seeds(reader, options);
        let run = read_run(reader);
        let figures = read_figures(reader, &parameters);
        for (key, expected) in S::FOREIGN_KEYS {
            if root.get(key).is_some() {
                let message = format!("`{key}` is not a key of an experiment of {}", S::UNIT);
                reader.refuse(&FieldPath::key(key), Code::Requirement, &message, expected);
            }
        }
        let open = |reader: &mut Reader, case: Option<(&FieldPath, &Node)>| {
            S::open(reader, folder, case, options)
        };
        let cases = read_cases(reader, open, S::case_name);
        let (top, combinations, seeds, run) = (top?, combinations?, seeds?, run?);
        let (cases, figures) = (cases?, figures?);
        if !reader.problems.is_empty() {
            return None;
        }
        let count = cases.len().saturating_mul(combinations.len());
        if count > MAX_CELLS || count.saturating_mul(seeds.len()) > MAX_MISSIONS {
            let message = format!("{count} cells times {} seeds are too many", seeds.len());
            let expected = format!("at most {MAX_CELLS} cells and {MAX_MISSIONS} missions");
            reader.refuse(&FieldPath::key("seeds"), Code::Limit, &message, &expected);
            return None;
        }
        let cells = S::cells(reader, &cases, &parameters, &combinations, options);
        Some(Self {
            name: name.to_owned(),
            title: top.title.unwrap_or_else(|| name.to_owned()),
            description: top.description.unwrap_or_default().trim().to_owned(),
            text: String::new(),
            cases: cases.into_iter().map(|c| c.case).collect(),
            parameters: parameters
                .into_iter()
                .map(|p| Column {
                    name: p.name,
                    title: p.title,
                })
                .collect(),
            cells,
            seeds,
            run,
            figures,
        })
    }
    /// Returns the manifest of its results, as this program writes it.
    pub fn manifest(&self) -> Manifest {
        let cells = self.cells.iter().map(|cell| ManifestCell {
            case: cell.case.clone(),
            values: cell.values.clone(),
            blake3: cell.blake3.clone(),
            scenario: cell.target.clone(),
            set: cell.overrides.clone(),
            external: cell.external,
        });
        let names = self.parameters.iter().map(|p| p.name.clone());
        let mut manifest = Manifest {
            format: FORMAT,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            kind: S::Row::KIND,
            experiment: self.name.clone(),
            title: self.title.clone(),
            blake3: String::new(),
            parameters: names.collect(),
            cells: cells.collect(),
            seeds: self.seeds.clone(),
        };
        manifest.blake3 = manifest.fingerprint();
        manifest
    }
}
