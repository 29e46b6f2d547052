//! Declarations of external programs that are asked for them before a run.

use std::io::Read as _;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::time::Duration;

use config::{Node, write_value};
use runtime::config::DECLARE_VARIABLE;
use scenario::{ProcessSpec, Program, ResolvedScenario};

use crate::child_process;

/// Maximum time for the answer.
const PATIENCE: Duration = Duration::from_secs(60);
/// Maximum length of an answer (bytes).
const MAX_ANSWER: u64 = 1 << 20;

/// The program of a process does not state its declaration.
#[derive(Debug, thiserror::Error)]
#[error(
    "process {process}: it does not state its declaration: {fault} (asked with {DECLARE_VARIABLE}=1: {command})"
)]
pub struct AskError {
    /// Name of the process.
    pub process: String,
    /// Command line of its program.
    pub command: String,
    /// Fault of the program.
    #[source]
    pub fault: AskFault,
}

/// Fault of a program that is asked for its declaration.
#[derive(Debug, thiserror::Error)]
pub enum AskFault {
    /// The process has a kind.
    #[error("it is no external program")]
    NotExternal,
    /// It has no words.
    #[error("its command is empty")]
    NoCommand,
    /// The program does not start.
    #[error(transparent)]
    Start(std::io::Error),
    /// Nothing can be read from it.
    #[error("its output is not piped")]
    NotPiped,
    /// It does not end its output.
    #[error("no answer in {} s", PATIENCE.as_secs())]
    Late,
    /// The operating system does not read it.
    #[error("its answer cannot be read: {0}")]
    Read(std::io::Error),
    /// It prints something else.
    #[error("its answer is no JSON ({0}); a program in Python ends with pr.serve")]
    NotJson(serde_json::Error),
    /// It states nothing.
    #[error("its answer is null")]
    Null,
}

/// Asks the programs of a scenario that state their declarations themselves; returns the declarations as overrides of the scenario
/// (`processes.NAME.declaration=…`), none if no program is to be asked.
///
/// # Errors
/// [`AskError`] names the process and the fault.
pub fn ask(scenario: &ResolvedScenario) -> Result<Vec<String>, AskError> {
    let asked = scenario.processes.iter().filter(|p| p.is_to_be_asked());
    asked.map(ask_one).collect()
}

fn ask_one(process: &ProcessSpec) -> Result<String, AskError> {
    let name = &process.name;
    let failed = |fault| AskError {
        process: name.clone(),
        command: process.program.command_line().unwrap_or_default(),
        fault,
    };
    let Program::Command { words, folder, .. } = &process.program else {
        return Err(failed(AskFault::NotExternal));
    };
    let [file, arguments @ ..] = words.as_slice() else {
        return Err(failed(AskFault::NoCommand));
    };
    let started = Command::new(child_process::program_file(file))
        .args(arguments)
        .current_dir(folder)
        .env(DECLARE_VARIABLE, "1")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn();
    let mut child = started.map_err(|error| failed(AskFault::Start(error)))?;
    let answer = answer_of(&mut child);
    // It has nothing more to do, whatever it has answered.
    let _ = child.kill();
    let _ = child.wait();
    let answer = answer.map_err(&failed)?;
    let value: serde_json::Value =
        serde_json::from_str(answer.trim()).map_err(|error| failed(AskFault::NotJson(error)))?;
    let node = Node::from_json(&value).ok_or_else(|| failed(AskFault::Null))?;
    Ok(format!(
        "processes.{name}.declaration={}",
        write_value(&node)
    ))
}

/// Returns what a program prints until it closes its output.
///
/// # Errors
/// It does not end within the maximum time, or its output cannot be read.
fn answer_of(child: &mut Child) -> Result<String, AskFault> {
    let output = child.stdout.take().ok_or(AskFault::NotPiped)?;
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        let mut text = Vec::new();
        let read = output.take(MAX_ANSWER).read_to_end(&mut text);
        let _ = sender.send(read.map(|_| text));
    });
    let answer = receiver.recv_timeout(PATIENCE);
    let text = answer.map_err(|_| AskFault::Late)?;
    let text = text.map_err(AskFault::Read)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}
