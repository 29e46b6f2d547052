//! Progress of long commands: a bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal as _;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::eprintln;

/// How often a plain line is written when stderr is not a terminal.
const PLAIN_EVERY: Duration = Duration::from_secs(10);

/// A bar on standard error up to `length`, with this template; hidden if standard error is no terminal,
/// or `quiet`.
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
    // A template that does not parse would only cost the bar its looks.
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// A bar on a terminal, now and then a line elsewhere, over things of one unit.
pub struct Progress {
    bar: ProgressBar,
    plain: bool,
    quiet: bool,
    start: Instant,
    last_plain: Instant,
    total: usize,
    done: usize,
    failed: usize,
    /// What there are so many of.
    unit: &'static str,
}

impl Progress {
    /// Progress over `total` of a unit; `known` are done already.
    pub fn new(total: usize, known: usize, quiet: bool, unit: &'static str) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar = bar(Some(total as u64), "{bar:30} {pos}/{len}  {msg}", quiet);
        if known > 0 && !quiet {
            eprintln!("{known} {unit} are done already");
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

    /// A mission is over; `words` say how it failed.
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

    /// Says something beside the bar.
    pub fn say(&self, words: &str) {
        if self.bar.is_hidden() {
            eprintln!("{words}");
        } else {
            self.bar.println(crate::terminal::harmless(words));
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

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// `2 h 05 min`, `3 min 20 s`, `7 s`.
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
    fn times_are_told_in_the_units_that_matter() {
        assert_eq!(duration(6.2), "7 s");
        assert_eq!(duration(200.0), "3 min 20 s");
        assert_eq!(duration(7500.0), "2 h 05 min");
        assert_eq!(duration(0.0), "0 s");
    }
}
