//! The picture of a log in a file.

use std::path::Path;

use draw::raster;
use mcap_log::{Condition, DerivedError, ReadProgress, derived};
use platform::atomic_file::Readers;

use super::draw::draw;
use super::trace::RunTrace;

/// Draws a log at a simulated time (s; `None` for the end) into a file, whose ending tells the format. On an error, no file remains.
///
/// # Errors
/// [`DerivedError`]: the log cannot be read, is not a Protean log of this version or ends before this time, or the
/// picture cannot be written.
pub fn save(
    log: &Path,
    at_s: Option<f64>,
    out: &Path,
    force: bool,
    watch: &mut ReadProgress,
) -> Result<Condition, DerivedError> {
    let (trace, condition) = RunTrace::read(log, at_s, watch)?;
    let bytes = raster::encoded(draw(&trace), out).map_err(derived::failed(out))?;
    derived::write(&bytes, out, log, force, Readers::All)?;
    Ok(condition)
}
