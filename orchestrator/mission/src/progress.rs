//! Progress display of a run: a progress bar on a terminal, plain lines elsewhere.

use std::io::{IsTerminal as _, Write as _};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use ipc_types::consumer::{Consumer, EVENTS, LoggedMessage};
use ipc_types::event_names::EventNames;
use ipc_types::messages::world::WorldEvent;
use ipc_types::topics::TopicId;
use platform::eprintln;
use platform::progress;
use platform::terminal::{Colours, is_coloured};
use recorder::time_text;

/// Interval between plain lines if stderr is not a terminal.
const PLAIN_INTERVAL: Duration = Duration::from_secs(5);

/// Display of a run's progress.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    plain: bool,
    start: Instant,
    last_plain: Instant,
}

impl Progress {
    /// Creates the display up to the time limit (s), if there is one; `quiet` shows nothing.
    pub fn new(limit_s: Option<f64>, quiet: bool) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let limit = limit_s.filter(|limit| limit.is_finite());
        let length = limit.map(|limit| (limit * 1e3) as u64);
        let bar = progress::bar(length, "{bar:30} {msg}", quiet);
        let now = Instant::now();
        Self {
            bar,
            plain: !quiet && !terminal,
            start: now,
            last_plain: now,
        }
    }

    /// Returns a printer for the recorder's thread that writes events above the bar, in these colours if stderr is
    /// coloured.
    pub fn events(&self, names: EventNames, colours: Colours, quiet: bool) -> EventPrinter {
        let coloured = is_coloured(&std::io::stderr());
        EventPrinter {
            colours: if coloured {
                colours
            } else {
                Colours::default()
            },
            bar: self.bar.clone(),
            plain: self.plain,
            quiet,
            names,
        }
    }

    /// Shows that the run has reached a simulated time (s).
    pub fn at(&mut self, time_s: f64) {
        let factor = time_s / self.start.elapsed().as_secs_f64().max(1e-9);
        self.bar.set_position((time_s * 1e3) as u64);
        let message = format!("t = {} s  ({factor:.0}x real time)", time_text(time_s));
        self.bar.set_message(message.clone());
        if self.plain && self.last_plain.elapsed() >= PLAIN_INTERVAL {
            self.last_plain = Instant::now();
            eprintln!("{message}");
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Printer of events as they are recorded.
#[derive(Debug)]
pub struct EventPrinter {
    bar: ProgressBar,
    plain: bool,
    quiet: bool,
    names: EventNames,
    colours: Colours,
}

impl Consumer for EventPrinter {
    fn topics(&self) -> &[TopicId] {
        if self.quiet { &[] } else { &EVENTS }
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        for event in message.events() {
            self.print(message.time_s(), &event);
        }
    }
}

impl EventPrinter {
    fn print(&self, time_s: f64, event: &WorldEvent) {
        // Too frequent, or part of the summary.
        if ["contact_begin", "contact_end", "game_over"].contains(&WorldEvent::name_of(event.kind))
        {
            return;
        }
        let line = format!("{:>8} s  {}", time_text(time_s), self.names.words(event));
        let line = self.colours.paint(&line);
        if self.plain {
            // A closed stderr is ignored.
            let _ = writeln!(std::io::stderr().lock(), "{line}");
        } else {
            self.bar.println(line);
        }
    }
}
