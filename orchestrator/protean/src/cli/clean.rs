//! `protean clean`.

use std::process::ExitCode;

use platform::eprintln;
use serde_json::json;

use super::output::{EXIT_FAILED, print, print_json};
use mission::run_directory::{self, FoundDirectory};
use platform::scratch;

/// Removes the remains of killed runs and lists them.
pub fn clean(as_json: bool) -> ExitCode {
    let mut found = match run_directory::clean() {
        Ok(found) => found,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::from(EXIT_FAILED);
        }
    };
    found.extend(scratch_directories());
    let failed = found
        .iter()
        .any(|f| matches!(f, FoundDirectory::Failed(..)));
    if as_json {
        let runs: Vec<_> = found
            .iter()
            .map(|f| match f {
                FoundDirectory::Alive(root) => json!({ "run": root, "state": "alive" }),
                FoundDirectory::Removed { root, killed } => {
                    json!({ "run": root, "state": "removed", "killed": killed })
                }
                FoundDirectory::Failed(root, reason) => {
                    json!({ "run": root, "state": "failed", "reason": reason })
                }
            })
            .collect();
        print_json(&json!({ "runs": runs }));
    } else if found.is_empty() {
        print("nothing to clean");
    } else {
        for f in &found {
            print(&match f {
                FoundDirectory::Alive(root) => format!("{}: running, kept", root.display()),
                FoundDirectory::Removed { root, killed } if killed.is_empty() => {
                    format!("{}: removed", root.display())
                }
                FoundDirectory::Removed { root, killed } => {
                    format!(
                        "{}: removed, {} processes killed",
                        root.display(),
                        killed.len()
                    )
                }
                FoundDirectory::Failed(root, reason) => format!("{}: {reason}", root.display()),
            });
        }
    }
    if failed {
        ExitCode::from(EXIT_FAILED)
    } else {
        ExitCode::SUCCESS
    }
}

/// Removes the scratch directories of killed commands.
fn scratch_directories() -> Vec<FoundDirectory> {
    let entry = |(root, error): (_, Option<std::io::Error>)| match error {
        None => FoundDirectory::Removed {
            root,
            killed: Vec::new(),
        },
        Some(error) => FoundDirectory::Failed(root, error.to_string()),
    };
    match scratch::clean() {
        Ok(found) => found.into_iter().map(entry).collect(),
        Err(error) => vec![FoundDirectory::Failed(
            std::env::temp_dir(),
            error.to_string(),
        )],
    }
}
