//! The processes of a measurement: started, watched, ended.

use std::time::{Duration, Instant};

use orchestrator::mission::children::{Executable, RunningProcess, end_all};
use orchestrator::mission::spaces::OwnedSpace;
use serde::Serialize;

use crate::Result;

/// Time that processes have to get ready, and to end.
const READY_WITHIN: Duration = Duration::from_secs(10);
const END_WITHIN: Duration = Duration::from_secs(3);

/// Processes of a measurement, ended when dropped.
pub struct Crew(Vec<RunningProcess>);

impl Crew {
    /// Starts a process of this kind for every configuration.
    ///
    /// # Errors
    /// An error of the operating system.
    pub fn start(space: &OwnedSpace, kind: &str, configs: &[impl Serialize]) -> Result<Self> {
        let mut crew = Self(Vec::new());
        for (slot, config) in configs.iter().enumerate() {
            let path = space.space().root().join(format!("process-{slot}.json"));
            std::fs::write(&path, serde_json::to_vec(config)?)?;
            let executable = Executable::Kind(kind.into());
            let name = format!("{kind}-{slot}");
            let process = RunningProcess::start(&name, slot, &executable, &path, true)?;
            crew.0.push(process);
        }
        Ok(crew)
    }

    /// Fails if one has ended.
    ///
    /// # Errors
    /// The last words of that process.
    pub fn check(&mut self) -> Result<()> {
        match self.0.iter_mut().find_map(|p| p.check_exit().then_some(p)) {
            None => Ok(()),
            Some(process) => {
                let words = process.last_words().join(" / ");
                Err(format!("{} ended: {words}", process.name).into())
            }
        }
    }

    /// Waits until `done`; fails when a process ends before, or too late.
    ///
    /// # Errors
    /// Which process ended, or that they took too long.
    pub fn wait(&mut self, mut done: impl FnMut() -> bool) -> Result<()> {
        let deadline = Instant::now() + READY_WITHIN;
        while !done() {
            self.check()?;
            if Instant::now() > deadline {
                return Err(format!("planners are not ready within {READY_WITHIN:?}").into());
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(())
    }
}

impl Drop for Crew {
    fn drop(&mut self) {
        end_all(&mut self.0, END_WITHIN);
    }
}
