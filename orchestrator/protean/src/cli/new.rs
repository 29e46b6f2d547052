//! `protean new`.

use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use platform::atomic_file::{AtomicFile, Existing, Readers};
use platform::{eprintln, shell};
use scenario::builtin;

use super::common::ForceArg;
use super::output::{EXIT_FAILED, EXIT_INVALID, print};
use super::run_args::DEFAULT_SCENARIO;

/// Help below the options.
pub(super) const HELP: &str = "\
The file is a copy of a built-in scenario. A map file that the scenario uses is written to the folder maps beside it.

Exit codes: 0 written, 1 a file cannot be written, 2 wrong usage, or a file exists and --force is absent.";

/// Arguments of `protean new`.
#[derive(Debug, clap::Args)]
pub(super) struct NewArgs {
    /// Scenario file to write, for example `mine.toml`
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Built-in scenario to copy (see `protean list`)
    #[arg(long, value_name = "SCENARIO", default_value = DEFAULT_SCENARIO)]
    from: String,
    #[command(flatten)]
    force: ForceArg,
}

/// Reason why no scenario was written.
#[derive(Debug, thiserror::Error)]
enum NewError {
    #[error("{}: expected a file name that ends in .toml", _0.display())]
    Name(PathBuf),
    #[error("no built-in scenario {0:?}; expected one of {1}")]
    Unknown(String, String),
    #[error("{} exists; add --force to overwrite it", _0.display())]
    Exists(PathBuf),
    #[error("cannot write {}: {_1}", _0.display())]
    Write(PathBuf, io::Error),
}

/// Writes a scenario and the map that it uses.
pub(super) fn run(args: &NewArgs) -> ExitCode {
    match write(args) {
        Ok(files) => {
            for file in &files {
                print(&file.display().to_string());
            }
            let file = args.file.to_string_lossy();
            eprintln!("next: {}", shell::line(["protean", "run", &file]));
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(match error {
                NewError::Write(..) => EXIT_FAILED,
                _ => EXIT_INVALID,
            })
        }
    }
}

/// Writes the files; returns their paths.
fn write(args: &NewArgs) -> Result<Vec<PathBuf>, NewError> {
    if args.file.extension().is_none_or(|end| end != "toml") {
        return Err(NewError::Name(args.file.clone()));
    }
    let Some(scenario) = builtin::scenario(&args.from) else {
        let names = builtin::SCENARIOS.map(|scenario| scenario.name).join(", ");
        return Err(NewError::Unknown(args.from.clone(), names));
    };
    let folder = args.file.parent().unwrap_or(Path::new(""));
    let mut files = vec![(args.file.clone(), scenario.text)];
    if let Some((path, text)) = scenario.map() {
        let path = folder.join(path);
        // Several scenarios of a folder share a map.
        if !fs::read(&path).is_ok_and(|found| found == text.as_bytes()) {
            files.push((path, text));
        }
    }
    let existing = Existing::of_force(args.force.force);
    if existing == Existing::Keep
        && let Some((path, _)) = files
            .iter()
            .find(|(path, _)| path.symlink_metadata().is_ok())
    {
        return Err(NewError::Exists(path.clone()));
    }
    for (path, text) in &files {
        write_file(path, text, existing).map_err(|error| match error.kind() {
            io::ErrorKind::AlreadyExists => NewError::Exists(path.clone()),
            _ => NewError::Write(path.clone(), error),
        })?;
    }
    Ok(files.into_iter().map(|(path, _)| path).collect())
}

fn write_file(path: &Path, text: &str, existing: Existing) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let mut file = AtomicFile::create(path, existing, Readers::All)?;
    file.write_all(text.as_bytes())?;
    file.commit()
}
