//! The ecosystem's own reader: the Python packages `mcap`, `mcap-ros2-support` and
//! `rosbags` in an environment that the tests share.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::history::History;
use super::skipped;

/// An environment ([`prepare`]) with what builds and tests the Python package, and with what its users read tables with.
pub const PACKAGES: &[&str] = &[
    "python-wheel",
    "gymnasium==1.4.0",
    "check-jsonschema==0.39.0",
    "distributed==2026.8.0",
    "duckdb==2.0.1",
    "hyperqueue==0.27.0",
    "jinja2==3.1.6",
    "joblib==1.6.0",
    "matplotlib==3.11.2",
    "maturin==1.16.0",
    "mcap==1.6.0",
    "mcap-ros2-support==0.6.0",
    "mpi4py==4.1.2",
    "mpich==5.0.2",
    "mypy==2.4.1",
    "numpy==2.4.6",
    "onnx==1.23.2",
    "optuna==5.0.0",
    "pandas==3.1.1",
    "pettingzoo==1.27.0",
    "polars==2.1.0",
    "pre-commit==4.7.0",
    "pyarrow==26.0.1",
    "pyright[nodejs]==1.1.414",
    "pytest==9.2.0",
    "pytest-xdist==3.8.0",
    "ray==2.60.0",
    "scipy==1.17.1",
    "submitit==1.5.4",
];

/// A log as Python reads it.
#[derive(Debug, Deserialize)]
pub struct PythonLog {
    #[serde(flatten)]
    pub history: History,
    /// Positions of the robots for viewers: log time, frame, x, y.
    pub transforms: Vec<(u64, String, f64, f64)>,
}

/// The interpreter with the packages, or why there is none. Made at the first call (any test may
/// come first: a lock keeps them apart) and kept between test runs.
pub fn interpreter() -> Result<PathBuf, String> {
    prepare(&[])
}

/// As [`interpreter`], with other packages: the name of the environment and what it holds.
pub fn prepare(environment: &[&str]) -> Result<PathBuf, String> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../ipc_types/tests/python/prepare.py");
    let output = Command::new("python3")
        .arg(script)
        .arg(env!("CARGO_TARGET_TMPDIR"))
        .args(environment)
        .output()
        .map_err(|e| format!("python3: {e}"))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).trim().into())
    } else {
        Err(String::from_utf8_lossy(&output.stderr).trim().to_owned())
    }
}

/// Reads a log with Python; `None`, and a note on stderr, if this machine cannot.
pub fn read(log: &Path) -> Option<PythonLog> {
    call("read_log.py", log)
}

/// Runs a script of `tests/python` on a log and returns its output; `None`, and a note on stderr, if this
/// machine has no Python for it.
pub fn call<T: DeserializeOwned>(script: &str, log: &Path) -> Option<T> {
    call_with(&[], script, log)
}

/// As [`call`], with the packages of another environment ([`prepare`]).
pub fn call_with<T: DeserializeOwned>(environment: &[&str], script: &str, log: &Path) -> Option<T> {
    let python = match prepare(environment) {
        Ok(python) => python,
        Err(reason) => {
            skipped(&format!("{script} with {}", log.display()), &reason);
            return None;
        }
    };
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("python");
    let output = Command::new(python)
        .arg(scripts.join(script))
        .arg(log)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Some(serde_json::from_slice(&output.stdout).unwrap())
}
