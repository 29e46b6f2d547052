//! The processes of a measurement: started, watched, ended.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::Serialize;

use super::BenchError;
use crate::mission::children::{Executable, RunningProcess, end_all};
use crate::mission::spaces::OwnedSpace;

/// Time that processes have to get ready, and to end.
const READY_WITHIN: Duration = Duration::from_secs(10);
const END_WITHIN: Duration = Duration::from_secs(3);

/// Processes of a measurement, ended when dropped.
pub struct Crew(Vec<RunningProcess>);

impl Crew {
    /// Fails if one has ended.
    pub fn check(&mut self) -> Result<(), BenchError> {
        match self.0.iter_mut().find_map(|p| p.check_exit().then_some(p)) {
            None => Ok(()),
            Some(process) => Err(BenchError::Process {
                process: process.name.clone(),
                how: format!("ended: {}", process.last_words().join(" / ")),
            }),
        }
    }

    /// Waits until `done`; fails when a process ends before, or too late.
    pub fn wait(&mut self, what: &str, mut done: impl FnMut() -> bool) -> Result<(), BenchError> {
        let deadline = Instant::now() + READY_WITHIN;
        while !done() {
            self.check()?;
            if Instant::now() > deadline {
                return Err(BenchError::TooSlow {
                    what: what.to_owned(),
                    limit: READY_WITHIN,
                });
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(())
    }
}

/// Starts a process of this hidden kind for every configuration.
pub fn launch(
    space: &OwnedSpace,
    kind: &str,
    configs: &[impl Serialize],
) -> Result<Crew, BenchError> {
    let mut crew = Crew(Vec::new());
    for (slot, config) in configs.iter().enumerate() {
        let path = write_config(space.space().root(), slot, config)?;
        let executable = Executable::Kind(kind.into());
        let name = format!("{kind}-{slot}");
        crew.0.push(RunningProcess::start(
            &name,
            slot,
            &executable,
            &path,
            true,
        )?);
    }
    space.note_processes(crew.0.iter().map(RunningProcess::pid))?;
    Ok(crew)
}

fn write_config(root: &Path, slot: usize, config: &impl Serialize) -> Result<PathBuf, BenchError> {
    let path = root.join(format!("process-{slot}.json"));
    let text = serde_json::to_vec(config)
        .map_err(|e| BenchError::system("cannot write a configuration")(std::io::Error::from(e)))?;
    std::fs::write(&path, text).map_err(BenchError::system(format!("{}", path.display())))?;
    Ok(path)
}

impl Drop for Crew {
    fn drop(&mut self) {
        end_all(&mut self.0, END_WITHIN);
    }
}
