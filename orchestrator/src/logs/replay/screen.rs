//! What a person sees of a replay.

use std::io::IsTerminal as _;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A line on a terminal; nothing elsewhere.
pub(super) struct Screen {
    bar: ProgressBar,
    keys: bool,
}

impl Screen {
    /// For a log up to this time [ns]; with a word on the keys if there are any.
    pub(super) fn new(last: Option<u64>, quiet: bool, keys: bool) -> Self {
        let hidden = quiet || !std::io::stderr().is_terminal();
        let bar = match last {
            Some(last) => ProgressBar::new(last / 1_000_000),
            None => ProgressBar::no_length(),
        };
        bar.set_draw_target(if hidden {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr_with_hz(10)
        });
        // A template that does not parse would only cost the bar its looks.
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {msg}") {
            bar.set_style(style);
        }
        Self { bar, keys }
    }

    /// Shows where the replay is: log time [ns], rate, whether it stands.
    pub(super) fn show(&self, time: u64, rate: f64, paused: bool) {
        if self.bar.is_hidden() {
            return;
        }
        self.bar.set_position(time / 1_000_000);
        let speed = match (paused, rate.is_infinite()) {
            (true, _) => "paused".to_owned(),
            (false, true) => "as fast as possible".to_owned(),
            (false, false) => format!("x{rate}"),
        };
        let keys = if self.keys {
            "  [space pause, → step, ← back 5 s, ↑↓ rate, q quit]"
        } else {
            ""
        };
        let seconds = super::super::seconds(time);
        self.bar
            .set_message(format!("t = {seconds:.2} s  {speed}{keys}"));
    }

    /// Takes the line away.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
