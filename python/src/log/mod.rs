//! Logs of runs: their contents, the columns of their topics, and their views.

mod columns;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use draw::raster::{Pixels, pixels};
use log_tools::{LogInfo, Measured, TopicColumns, events, info_text};
use mcap_log::derived::failed;
use mcap_log::{DerivedError, LogReadError, Origin, ReadProgress};
use numpy::{IntoPyArray as _, PyArray3, PyArrayMethods as _};
use platform::output_format::OutputFormat;
use pyo3::prelude::*;
use recorder::{PatrolMeasurement, RunInfo};
use report::picture::{RunTrace, draw};
use report::{page, picture};

pub use self::columns::Column;
use python_algorithms::arguments::invalid;
use python_algorithms::error::{Error, InvalidInput};
use python_algorithms::interruptible::wait;

/// Names of the robots of a patrol, and its places (m).
type PatrolPlaces = (Vec<String>, Vec<[f64; 2]>);

/// A log file and its contents.
///
/// Raises
/// ------
/// InvalidInput
///     The file is missing or is not an MCAP file.
#[pyclass(frozen, module = "protean_robotics")]
#[derive(Debug)]
pub struct LogFile {
    #[pyo3(get)]
    path: PathBuf,
    info: LogInfo,
}

impl LogFile {
    fn measured<'py>(&self, py: Python<'py>, table: Measured) -> PyResult<Vec<Bound<'py, Column>>> {
        let read = read(py, |watch| Ok(table.read(&self.path, watch)?))?;
        let columns = read.columns.into_iter();
        let columns = columns.map(|column| Bound::new(py, Column::new(py, column)));
        columns.collect()
    }
}

#[pymethods]
impl LogFile {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let info = read(py, |watch| Ok(LogInfo::read(&path, watch)?))?;
        Ok(Self { path, info })
    }

    /// Contents and condition as JSON, as `protean info --json` prints them.
    fn info(&self) -> String {
        serde_json::json!(self.info).to_string()
    }

    /// Contents and condition as text, as `protean info` prints them.
    fn text(&self) -> String {
        info_text(&self.info)
    }

    /// Reads the messages of a topic.
    ///
    /// Returns
    /// -------
    /// list of Column, int
    ///     The columns; the number of messages that do not fit their schema and are not in them.
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     The log has no such topic, or no ROS 2 messages of it.
    fn columns<'py>(
        &self,
        py: Python<'py>,
        topic: &str,
    ) -> PyResult<(Vec<Bound<'py, Column>>, u64)> {
        let Some(info) = self.info.topics.get(topic) else {
            let known: Vec<&str> = self.info.topics.keys().map(String::as_str).collect();
            let known = known.join(", ");
            return Err(InvalidInput::new_err(format!(
                "{topic}: no topic of the log has this name: expected one of {known}"
            )));
        };
        let read = read(py, |watch| {
            Ok(TopicColumns::read(&self.path, info.channel, watch)?)
        })?;
        let columns = read.columns.into_iter();
        let columns = columns.map(|column| Bound::new(py, Column::new(py, column)));
        Ok((columns.collect::<PyResult<_>>()?, read.undecodable))
    }

    /// The idleness of the patrols over time, as `protean export` writes it.
    fn patrols<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, Column>>> {
        self.measured(py, Measured::Patrols)
    }

    /// The errors of the beliefs, as `protean export` writes them.
    fn beliefs<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, Column>>> {
        self.measured(py, Measured::Beliefs)
    }

    /// Of each patrol: the names of its robots, and its places (m).
    fn patrol_places(&self, py: Python<'_>) -> PyResult<Vec<PatrolPlaces>> {
        let run = read(py, |_| Ok(RunInfo::from_log(&Origin::read(&self.path)?)))?;
        let run = run.unwrap_or_default();
        let patrols = PatrolMeasurement::of_all(&run.patrols, &run.robots);
        let middle = |[a, b]: [[f64; 2]; 2]| [0, 1].map(|axis| f64::midpoint(a[axis], b[axis]));
        let places = |of: &PatrolMeasurement| of.ends().into_iter().map(middle).collect();
        Ok(patrols
            .iter()
            .map(|of| (of.names().to_vec(), places(of)))
            .collect())
    }

    /// Events of the run as JSON: a list as `events` in `protean run --json`.
    fn events(&self, py: Python<'_>) -> PyResult<String> {
        let found = read(py, |watch| Ok(events(&self.path, watch)?))?;
        Ok(serde_json::json!(found).to_string())
    }

    /// The page of the run (HTML).
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        let render = |watch: &mut ReadProgress| page::render(&[&self.path], None, watch);
        let (page, _) = read(py, |watch| Ok(render(watch)?))?;
        Ok(page)
    }

    /// Writes the page of the run, as `protean report` does.
    fn report(&self, py: Python<'_>, out: PathBuf, force: bool) -> PyResult<()> {
        let out = OutputFormat::PAGE.check(out).map_err(invalid)?;
        let log: &Path = &self.path;
        read(py, |watch| page::report(&[log], &out, force, None, watch)).map(drop)
    }

    /// The plots of the page as JSON: `title`, `unit`, `steps` if values hold until the next one, and `curves` with
    /// `name`, `times_ns` and `values`.
    fn plots(&self, py: Python<'_>) -> PyResult<String> {
        let plots = read(py, |watch| Ok(page::plots(&self.path, watch)?))?;
        Ok(serde_json::json!(plots).to_string())
    }

    /// Pixels of the picture at a time (s), shape (height, width, 3), fitted into a size (px) if given.
    #[pyo3(signature = (at, size=None))]
    fn frame<'py>(
        &self,
        py: Python<'py>,
        at: f64,
        size: Option<[u32; 2]>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let pixels = read(py, |watch| {
            let trace = RunTrace::read(&self.path, Some(at), watch)?.0;
            pixels(&draw(&trace), size).map_err(failed(&self.path))
        })?;
        image(py, pixels)
    }

    /// Draws the run at a time (s), as `protean picture` does.
    #[pyo3(signature = (out, at, force))]
    fn picture(&self, py: Python<'_>, out: PathBuf, at: Option<f64>, force: bool) -> PyResult<()> {
        let out = OutputFormat::PICTURE.check(out).map_err(invalid)?;
        read(py, |watch| {
            picture::save(&self.path, at, &out, force, watch)
        })
        .map(drop)
    }
}

/// Returns pixels as an array of shape (height, width, 3).
pub fn image(py: Python<'_>, pixels: Pixels) -> PyResult<Bound<'_, PyArray3<u8>>> {
    let shape = [pixels.height as usize, pixels.width as usize, 3];
    pixels.rgb.into_pyarray(py).reshape(shape)
}

/// Reads a log in a thread of its own, until it ends or Ctrl-C interrupts it.
fn read<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&mut ReadProgress) -> Result<T, DerivedError> + Send,
) -> PyResult<T> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let (result, signal) = wait(py, &interrupted, || {
        work(&mut ReadProgress::new(Arc::clone(&interrupted), true))
    })?;
    signal?;
    result.map_err(|error| match error {
        DerivedError::Write { .. } | DerivedError::Log(LogReadError::Interrupted) => {
            Error::new_err(error.to_string())
        }
        _ => InvalidInput::new_err(error.to_string()),
    })
}
