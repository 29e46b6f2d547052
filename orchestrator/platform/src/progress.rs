//! Progress of long commands: a bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal as _;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::eprintln;

/// Interval of progress lines if stderr is not a terminal.
const PLAIN_EVERY: Duration = Duration::from_secs(10);

/// Returns a progress bar on stderr up to `length` with this template; hidden if stderr is not a terminal or
/// if `quiet`.
pub fn bar(length: Option<u64>, template: &str, quiet: bool) -> ProgressBar {
    let bar = match length {
        Some(length) => ProgressBar::new(length),
        None => ProgressBar::no_length(),
    };
    bar.set_draw_target(if quiet || !std::io::stderr().is_terminal() {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr_with_hz(10)
    });
    // With an invalid template the bar keeps its default style.
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// Progress over items of one unit: a bar on a terminal, otherwise a line at intervals.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    plain: bool,
    quiet: bool,
    start: Instant,
    last_plain: Instant,
    total: usize,
    done: usize,
    failed: usize,
    /// Name of the items, plural.
    unit: &'static str,
}

impl Progress {
    /// Starts progress over `total` items, of which `known` are done already.
    pub fn new(total: usize, known: usize, quiet: bool, unit: &'static str) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar = bar(Some(total as u64), "{bar:30} {pos}/{len}  {msg}", quiet);
        if known > 0 && !quiet {
            eprintln!("{known} {unit} already done");
        }
        let now = Instant::now();
        Self {
            bar,
            plain: !quiet && !terminal,
            quiet,
            start: now,
            last_plain: now,
            total,
            done: 0,
            failed: 0,
            unit,
        }
    }

    /// Counts an item as done; `words` returns the description of a failure.
    pub fn done(&mut self, failed: bool, words: impl FnOnce() -> String) {
        self.done += 1;
        self.failed += usize::from(failed);
        if failed && !self.quiet {
            self.say(&words());
        }
        let text = self.text();
        self.bar.set_position(self.done as u64);
        self.bar.set_message(text.clone());
        if self.plain && self.last_plain.elapsed() >= PLAIN_EVERY {
            self.last_plain = Instant::now();
            eprintln!("{}/{}  {text}", self.done, self.total);
        }
    }

    /// Prints a line above the bar.
    pub fn say(&self, words: &str) {
        if self.bar.is_hidden() {
            eprintln!("{words}");
        } else {
            self.bar.println(crate::terminal::escape_controls(words));
        }
    }

    fn text(&self) -> String {
        let rate = self.done as f64 / self.start.elapsed().as_secs_f64().max(1e-9);
        let left = (self.total - self.done.min(self.total)) as f64 / rate.max(1e-9);
        let failed = match self.failed {
            0 => String::new(),
            n => format!(", {n} failed"),
        };
        format!("{rate:.1} {}/s, {} left{failed}", self.unit, duration(left))
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Formats a duration: `2 h 05 min`, `3 min 20 s`, `7 s`.
fn duration(seconds: f64) -> String {
    let s = seconds.ceil() as u64;
    match (s / 3600, s / 60 % 60, s % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, m, s) => format!("{m} min {s:02} s"),
        (h, m, _) => format!("{h} h {m:02} min"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_formatted_in_at_most_two_units() {
        assert_eq!(duration(6.2), "7 s");
        assert_eq!(duration(200.0), "3 min 20 s");
        assert_eq!(duration(7500.0), "2 h 05 min");
        assert_eq!(duration(0.0), "0 s");
    }
}
