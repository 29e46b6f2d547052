//! `protean new`.

mod project;

use std::borrow::Cow;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use mcap_log::{DerivedError, derived};
use platform::file_kind::FileKind;
use platform::{eprintln, presence};
use scenario::builtin;

use super::common::{Expected, ForceArg};
use super::lab::{self, LabError};
use super::logs::exit_code_of_derived;
use super::output::{self, EXIT_FAILED, EXIT_INVALID, command_line, create, print};
use super::run_args::DEFAULT_SCENARIO;
use project::Project;

/// Help below the options.
pub const HELP: &str = "\
The file is a copy of a built-in scenario, or made from a published file: a ROS map (.yaml, with its image), a MovingAI \
map (.map) or problems on one (.scen), a street graph (.graphml, OpenStreetMap .osm), or a patrol graph of \
patrolling_sim (.graph). A map file that the scenario \
uses is written to the folder maps beside it. Published files need the Python package: \
pip install 'protean-robotics[lab]'.

With --python, --rust or --cpp, FILE is the folder of a new project: a planner, its mission, tests, and files that run
them on GitHub, on GitLab and before every commit.

Exit codes: 0 written, 1 a file cannot be written, 2 wrong usage, or a file exists and --force is absent.";

/// Arguments of `protean new`.
#[derive(Debug, clap::Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "one per switch of the command line"
)]
pub struct NewArgs {
    /// Scenario file to write, for example `mine.toml`; with a language the folder of the project
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Built-in scenario to copy (see `protean list`), or a .yaml, .map, .scen, .graph, .graphml or .osm
    #[arg(long, value_name = "SCENARIO", default_value = DEFAULT_SCENARIO)]
    from: String,
    /// Write a project with a planner in Python
    #[arg(long, group = "language", conflicts_with = "from")]
    python: bool,
    /// Write a project with a planner in Rust
    #[arg(long, group = "language", conflicts_with = "from")]
    rust: bool,
    /// Write a project with a planner in C++
    #[arg(long, group = "language", conflicts_with = "from")]
    cpp: bool,
    /// Side of a cell of a .map (m)
    #[arg(long, value_name = "M", default_value_t = 1.0, value_parser = length)]
    cell: f64,
    /// Width of the streets of a street graph (m)
    #[arg(long, value_name = "M", default_value_t = 8.0, value_parser = length)]
    street: f64,
    /// Let the file of --from use files outside its folder
    #[arg(long)]
    allow_outside: bool,
    #[command(flatten)]
    force: ForceArg,
}

impl NewArgs {
    /// Returns the kind of project; `None` for a scenario.
    fn project(&self) -> Option<&'static Project> {
        let languages = [
            (self.python, &project::PYTHON),
            (self.rust, &project::RUST),
            (self.cpp, &project::CPP),
        ];
        let chosen = languages.into_iter().find(|(is_chosen, _)| *is_chosen);
        chosen.map(|(_, project)| project)
    }
}

/// Extensions of published files.
const EXTENSIONS: &str = ".yaml, .yml, .map, .scen, .graph, .graphml, .osm or .xml";
/// Extensions of images, which have no size.
const IMAGES: [&str; 8] = ["pgm", "png", "jpg", "jpeg", "bmp", "gif", "tif", "tiff"];

/// Reason why no scenario was written.
#[derive(Debug, thiserror::Error)]
enum NewError {
    #[error("{}: expected a file name that ends in .toml", _0.display())]
    Name(PathBuf),
    #[error("{}: expected a folder whose name has only ASCII letters, digits, `_` and `-` and begins with a letter", _0.display())]
    ProjectName(PathBuf),
    #[error(
        "no built-in scenario {0:?}: expected one of {1}, or a file that ends in {EXTENSIONS}{2}"
    )]
    Unknown(String, String, String),
    #[error("{}: an image without its scale: expected the .yaml of the ROS map that names it", _0.display())]
    Image(PathBuf),
    #[error("{}: unknown kind of file: expected {EXTENSIONS}{_1}", _0.display())]
    Kind(PathBuf, String),
    #[error(transparent)]
    Lab(#[from] LabError),
    #[error("the package's answer: {0}")]
    Answer(#[from] serde_json::Error),
    /// The package has told the error.
    #[error("no scenario of {0}")]
    Import(String, u8),
    #[error("{} exists already; choose another name or overwrite it with --force", _0.display())]
    Exists(PathBuf),
    #[error(transparent)]
    Refused(#[from] DerivedError),
}

/// Writes a scenario and the map that it uses, or a project.
pub fn run(args: &NewArgs) -> ExitCode {
    match write(args) {
        Ok(files) => {
            for file in &files {
                print(&file.display().to_string());
            }
            let file = args.file.to_string_lossy();
            if let Some(project) = args.project() {
                eprintln!("next: {}", project.next(&file));
            } else {
                eprintln!("next: {}", command_line(&["run", &file]));
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            if !matches!(error, NewError::Import(..)) {
                eprintln!("error: {error}");
            }
            ExitCode::from(match error {
                NewError::Refused(error) => exit_code_of_derived(&error),
                NewError::Import(_, code) => code,
                NewError::Lab(_) | NewError::Answer(_) => EXIT_FAILED,
                _ => EXIT_INVALID,
            })
        }
    }
}

/// Writes the files; returns their paths.
fn write(args: &NewArgs) -> Result<Vec<PathBuf>, NewError> {
    let files = match args.project() {
        Some(project) => {
            let name = project::name(&args.file);
            let name = name.ok_or_else(|| NewError::ProjectName(args.file.clone()))?;
            project.files(&args.file, name)
        }
        None => scenario_files(args)?,
    };
    write_all(&files, args.force.force)?;
    Ok(files.into_iter().map(|(path, _)| path).collect())
}

/// Returns the scenario and the map that it uses.
fn scenario_files(args: &NewArgs) -> Result<Vec<(PathBuf, String)>, NewError> {
    if args.file.extension().is_none_or(|end| end != "toml") {
        return Err(NewError::Name(args.file.clone()));
    }
    let (text, map) = content(args)?;
    let folder = args.file.parent().unwrap_or(Path::new(""));
    let mut files = vec![(args.file.clone(), text.into_owned())];
    if let Some((path, text)) = map {
        let path = folder.join(&*path);
        // Several scenarios of a folder share a map.
        if !fs::read(&path).is_ok_and(|found| found == text.as_bytes()) {
            files.push((path, text.into_owned()));
        }
    }
    Ok(files)
}

fn write_all(files: &[(PathBuf, String)], force: bool) -> Result<(), NewError> {
    for (path, _) in files {
        let there = presence::entry(path).map_err(derived::refused(path))?;
        if !force && there.is_some() {
            return Err(NewError::Exists(path.clone()));
        }
    }
    let mut created = Vec::new();
    for (path, text) in files {
        created.push((create(path, force)?, path, text));
    }
    for (file, path, text) in created {
        output::write(file, path, text)?;
    }
    Ok(())
}

type Text = Cow<'static, str>;

/// Returns the text of the scenario, and path and text of its map.
fn content(args: &NewArgs) -> Result<(Text, Option<(Text, Text)>), NewError> {
    if let Some(scenario) = builtin::scenario(&args.from) {
        let map = scenario
            .map()
            .map(|(path, text)| (path.into(), text.into()));
        return Ok((scenario.text.into(), map));
    }
    let file = Path::new(&args.from);
    let help = || {
        let help = FileKind::from_path(file).map(|kind| format!("; {}", kind.help(file)));
        help.unwrap_or_default()
    };
    let Some(extension) = file.extension() else {
        let names = builtin::SCENARIOS.map(|scenario| scenario.name).join(", ");
        return Err(NewError::Unknown(args.from.clone(), names, help()));
    };
    let extension = extension.to_string_lossy().to_ascii_lowercase();
    if IMAGES.contains(&&*extension) {
        return Err(NewError::Image(file.to_owned()));
    }
    if !EXTENSIONS
        .split([' ', ',', '.'])
        .any(|known| known == extension)
    {
        return Err(NewError::Kind(file.to_owned(), help()));
    }
    let [scenario, map_path, map] = import(args)?;
    Ok((scenario.into(), Some((map_path.into(), map.into()))))
}

/// Returns a published file as scenario, path of the map and map, from the Python package.
fn import(args: &NewArgs) -> Result<[String; 3], NewError> {
    let [cell, street] = [args.cell, args.street].map(|length| length.to_string());
    let words = ["--cell", &cell, "--street", &street];
    let mut words: Vec<OsString> = words.map(OsString::from).into();
    words.extend(args.allow_outside.then(|| "--allow-outside".into()));
    words.extend(["--".into(), args.from.clone().into()]);
    let output = lab::output("maps", &words)?;
    let code = output
        .status
        .code()
        .and_then(|code| u8::try_from(code).ok());
    match code {
        Some(0) => Ok(serde_json::from_slice(&output.stdout)?),
        code => Err(NewError::Import(
            args.from.clone(),
            code.unwrap_or(EXIT_FAILED),
        )),
    }
}

/// Parses a length (m).
fn length(text: &str) -> Result<f64, Expected> {
    match text.parse::<f64>() {
        Ok(length) if length > 0.0 && length <= 1000.0 => Ok(length),
        _ => Err(Expected("a number > 0 and ≤ 1000 (m)".to_owned())),
    }
}
