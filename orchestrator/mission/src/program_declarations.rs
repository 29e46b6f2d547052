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

/// Asks the programs of a scenario that state their declarations themselves; returns the declarations as overrides of the scenario
/// (`processes.NAME.declaration=…`), none if no program is to be asked.
///
/// # Errors
/// A text that names the process and the fault.
pub fn ask(scenario: &ResolvedScenario) -> Result<Vec<String>, String> {
    let asked = scenario.processes.iter().filter(|p| p.is_to_be_asked());
    asked.map(ask_one).collect()
}

fn ask_one(process: &ProcessSpec) -> Result<String, String> {
    let name = &process.name;
    let failed = |what: String| {
        format!(
            "process {name}: it does not state its declaration: {what} (asked with {DECLARE_VARIABLE}=1: {})",
            process.program.command_line().unwrap_or_default()
        )
    };
    let Program::Command { words, folder, .. } = &process.program else {
        return Err(failed("it is no external program".to_owned()));
    };
    let [file, arguments @ ..] = words.as_slice() else {
        return Err(failed("its command is empty".to_owned()));
    };
    let started = Command::new(child_process::program_file(file))
        .args(arguments)
        .current_dir(folder)
        .env(DECLARE_VARIABLE, "1")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn();
    let mut child = started.map_err(|error| failed(error.to_string()))?;
    let answer = answer_of(&mut child);
    // It has nothing more to do, whatever it has answered.
    let _ = child.kill();
    let _ = child.wait();
    let answer = answer.map_err(&failed)?;
    let value: serde_json::Value = serde_json::from_str(answer.trim()).map_err(|error| {
        failed(format!(
            "its answer is no JSON ({error}); a program in Python ends with pr.serve"
        ))
    })?;
    let node = Node::from_json(&value).ok_or_else(|| failed("its answer is null".to_owned()))?;
    Ok(format!(
        "processes.{name}.declaration={}",
        write_value(&node)
    ))
}

/// Returns what a program prints until it closes its output.
///
/// # Errors
/// A text: it does not end within the maximum time, or its output cannot be read.
fn answer_of(child: &mut Child) -> Result<String, String> {
    let output = child.stdout.take().ok_or("its output is not piped")?;
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        let mut text = Vec::new();
        let read = output.take(MAX_ANSWER).read_to_end(&mut text);
        let _ = sender.send(read.map(|_| text));
    });
    let answer = receiver.recv_timeout(PATIENCE);
    let text = answer.map_err(|_| format!("no answer in {} s", PATIENCE.as_secs()))?;
    let text = text.map_err(|error| format!("its answer cannot be read: {error}"))?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}
