//! The lines that a process writes to stdout or stderr: read, shown, stored and forwarded.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read as _};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::eprintln;

/// Number of last lines of a process that are stored, to be shown if it fails.
const MAX_STORED_LINES: usize = 20;
/// Maximum number of lines of a panic's message that are stored beside them.
const MAX_PANIC_LINES: usize = 6;
/// Maximum time until the last lines of a process that has ended arrive.
const LAST_LINES_TIMEOUT: Duration = Duration::from_millis(500);
/// Maximum length of a stored line, including its end (bytes).
const MAX_LINE_BYTES: u64 = 2048;
/// Maximum length of a forwarded line (bytes): a byte that is not UTF-8 becomes three bytes, and a mark shows that
/// the line was cut.
pub const MAX_TEXT_BYTES: usize = MAX_LINE_BYTES as usize * 3 + 64;

/// A line of a process's output.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OutputLine {
    /// Index of the process in the run.
    pub slot: usize,
    /// Text without the end of the line.
    pub text: String,
}

/// The last lines of a process, read by a thread.
#[derive(Debug)]
pub struct OutputLines {
    kept: Arc<Mutex<LastLines>>,
    /// `true` if every line has been shown already.
    echo: bool,
    /// The thread, and what it closes when every process that could write to this pipe has ended.
    reader: Option<(JoinHandle<()>, Receiver<()>)>,
}

impl OutputLines {
    /// Starts to read the output of a process. `echo` shows every line on this program's stderr after the name of the
    /// process. `lines` receives lines while it has room: a process that writes without end must not block the others.
    ///
    /// # Errors
    /// The error of the system if no thread can be started: without a reader, the process would block.
    pub fn read(
        output: File,
        name: &str,
        slot: usize,
        echo: bool,
        lines: Option<SyncSender<OutputLine>>,
    ) -> io::Result<Self> {
        let kept = Arc::new(Mutex::new(LastLines::default()));
        let (to, name) = (Arc::clone(&kept), name.to_owned());
        let (reading, reader) = mpsc::channel();
        let thread = std::thread::Builder::new()
            .name(format!("output-{slot}"))
            .spawn(move || {
                let _reading = reading;
                let mut output = BufReader::new(output);
                while let Some(line) = next_line(&mut output) {
                    if echo {
                        eprintln!("[{name}] {line}");
                    }
                    if let Some(lines) = &lines {
                        let text = line.clone();
                        let _ = lines.try_send(OutputLine { slot, text });
                    }
                    if let Ok(mut kept) = to.lock() {
                        kept.push(line);
                    }
                }
            })?;
        Ok(Self {
            kept,
            echo,
            reader: Some((thread, reader)),
        })
    }

    /// Waits for the last lines of a process that has ended, until its end of the pipe is closed. A process outside its
    /// group may keep the pipe open.
    pub fn finish(&mut self) {
        if let Some((thread, reader)) = self.reader.take()
            && reader.recv_timeout(LAST_LINES_TIMEOUT) == Err(RecvTimeoutError::Disconnected)
        {
            // A process that is copied next may have no second thread.
            let _ = thread.join();
        }
    }

    /// Returns the stored lines; the oldest comes first. Of lines that have been shown, only those that name the cause.
    pub fn last(&self) -> Vec<String> {
        let lines = |kept: &LastLines| {
            if self.echo {
                kept.cause()
            } else {
                kept.lines()
            }
        };
        let kept = self.kept.lock();
        kept.map(|kept| lines(&kept)).unwrap_or_default()
    }
}

/// Returns `true` if a line begins the message of a panic.
pub fn begins_panic(line: &str) -> bool {
    line.contains("panicked at")
}

/// The last lines of a process, and the message of its last panic, which a backtrace would push out.
#[derive(Debug, Default)]
struct LastLines {
    lines: VecDeque<String>,
    /// Number of all lines.
    count: usize,
    panic: Vec<String>,
    /// Number of lines before the panic.
    before_panic: usize,
    in_message: bool,
}

impl LastLines {
    fn push(&mut self, line: String) {
        if begins_panic(&line) {
            self.panic.clear();
            self.before_panic = self.count;
            self.in_message = true;
        } else if self.panic.len() == MAX_PANIC_LINES || line == "stack backtrace:" {
            self.in_message = false;
        }
        if self.in_message {
            self.panic.push(line.clone());
        }
        if self.lines.len() == MAX_STORED_LINES {
            self.lines.pop_front();
        }
        self.lines.push_back(line);
        self.count += 1;
    }

    /// Returns the message of the panic, or the last line: that of a traceback names the exception.
    fn cause(&self) -> Vec<String> {
        if self.panic.is_empty() {
            let last = self.lines.iter().rfind(|line| !line.trim().is_empty());
            return last.cloned().into_iter().collect();
        }
        self.panic.clone()
    }

    /// Returns the message of the panic, as far as the last lines do not contain it, and the last lines.
    fn lines(&self) -> Vec<String> {
        let dropped = self.count - self.lines.len();
        let missing = dropped.saturating_sub(self.before_panic);
        let panic = self.panic.iter().take(missing);
        let gap = (missing > self.panic.len()).then(|| "…".to_owned());
        let gap = gap.filter(|_| !self.panic.is_empty());
        panic
            .cloned()
            .chain(gap)
            .chain(self.lines.iter().cloned())
            .collect()
    }
}

/// Reads the next line; `None` at the end. Keeps the beginning of a line longer than [`MAX_LINE_BYTES`] and drops the
/// rest. Replaces bytes that are not UTF-8.
fn next_line(from: &mut impl BufRead) -> Option<String> {
    let mut line = Vec::new();
    // An unreadable pipe counts as ended.
    let length = from
        .take(MAX_LINE_BYTES)
        .read_until(b'\n', &mut line)
        .ok()?;
    if length == 0 {
        return None;
    }
    let is_whole = line.pop_if(|byte| *byte == b'\n').is_some();
    let mut text = String::from_utf8_lossy(&line).into_owned();
    if !is_whole && from.skip_until(b'\n').ok()? > 0 {
        text.push_str(" …");
    }
    Some(text)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn lines(mut text: &[u8]) -> Vec<String> {
        std::iter::from_fn(|| next_line(&mut text)).collect()
    }

    #[test]
    fn lines_are_split_at_their_ends() {
        assert_eq!(lines(b""), [] as [&str; 0]);
        assert_eq!(lines(b"\n"), [""]);
        assert_eq!(lines(b"one\n\ntwo"), ["one", "", "two"]);
        assert_eq!(lines(b"caf\xc3\xa9 \xff\xfe\n"), ["café \u{fffd}\u{fffd}"]);
    }

    #[test]
    fn a_long_line_is_cut() {
        let most = MAX_LINE_BYTES as usize;
        let mut text = vec![b'x'; most - 1];
        text.push(b'\n');
        assert_eq!(lines(&text), ["x".repeat(most - 1)]);
        text.pop();
        text.push(b'y');
        text.extend(vec![0xff; 10 << 20]);
        text.extend(b"\nnext\n");
        let cut = format!("{}y …", "x".repeat(most - 1));
        assert_eq!(lines(&text), [&*cut, "next"]);
    }

    #[test]
    fn the_message_of_a_panic_survives_a_long_backtrace() {
        let last = |lines: &[&str], frames: usize| {
            let mut last = LastLines::default();
            let frames = (0..frames).map(|i| format!("{i}: frame"));
            for line in lines.iter().map(|&line| line.to_owned()).chain(frames) {
                last.push(line);
            }
            last
        };
        let stored = |lines: &[&str], frames: usize| last(lines, frames).lines();
        let panic = [
            "start",
            "thread 'main' panicked at src/main.rs:3:5:",
            "no map",
            "stack backtrace:",
        ];
        let lines = stored(&panic, 100);
        assert_eq!(lines[..4], [panic[1], panic[2], "…", "80: frame"]);
        assert_eq!(
            (lines.len(), lines.last().unwrap().as_str()),
            (23, "99: frame")
        );
        // Not twice, if the last lines contain it.
        assert_eq!(stored(&panic, 16)[..3], panic[..3]);
        assert_eq!(stored(&panic, 18)[..3], [panic[1], panic[2], panic[3]][..]);
        assert_eq!(stored(&panic, 19)[..3], [panic[1], panic[2], panic[3]][..]);
        assert_eq!(stored(&["start"], 20)[0], "0: frame");
        assert_eq!(last(&panic, 100).cause(), panic[1..3]);
        let traceback = [
            "Traceback (most recent call last):",
            "  line 3",
            "ValueError: no map",
            "",
        ];
        assert_eq!(last(&traceback, 0).cause(), traceback[2..3]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]
        #[test]
        fn every_line_fits_and_none_is_lost(
            text in prop::collection::vec(
                prop_oneof![8 => any::<u8>(), 1 => Just(b'\n')], 0..3 * MAX_LINE_BYTES as usize
            ),
        ) {
            let found = lines(&text);
            let expected = text.split_inclusive(|&byte| byte == b'\n').count();
            prop_assert_eq!(found.len(), expected);
            prop_assert!(found.iter().all(|line| line.len() <= MAX_TEXT_BYTES));
        }
    }
}
