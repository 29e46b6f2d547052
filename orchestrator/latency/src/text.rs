//! The measurements as text.

use std::fmt::Write as _;

use platform::machine::machine;
use statistics::Percentiles;
use tables::{Importance, TerminalTable};

use super::TICK_JITTER;
use super::report::{Report, Run};

/// Returns the tables.
pub fn text(report: &Report) -> String {
    let [one, five, fifteen] = report.load;
    let mut text = format!(
        "{}; load {one:.1} {five:.1} {fifteen:.1}; all times in us\n",
        machine()
    );
    for run in &report.runs {
        of_run(&mut text, run);
    }
    for error in &report.errors {
        let _ = write!(text, "\nFAILED: {error}");
    }
    if report.interrupted {
        text += "\ninterrupted: some measurements are missing";
    }
    text.trim_end().to_owned()
}

const PERCENTILES: [(&str, Importance); 7] = [
    ("count", 3),
    ("p50", 0),
    ("p90", 4),
    ("p99", 0),
    ("p99.9", 5),
    ("max", 1),
    ("jitter", 2),
];

fn cells(p: &Percentiles) -> [String; 7] {
    [
        p.count.to_string(),
        us(p.p50),
        us(p.p90),
        us(p.p99),
        us(p.p999),
        us(p.max),
        us(p.jitter),
    ]
}

/// Formats microseconds, with two digits after the point below ten.
fn us(value: f64) -> String {
    match value {
        v if v < 10.0 => format!("{v:.2}"),
        v if v < 1000.0 => format!("{v:.1}"),
        v => format!("{v:.0}"),
    }
}

/// Describes a run in one line.
fn headline(run: &Run) -> String {
    let m = &run.measured;
    let pace = match m.period_ns {
        Some(period) => format!("real time, {:.0} ticks/s", 1e9 / period.max(1) as f64),
        None => "lock-step".to_owned(),
    };
    let ended = if run.interrupted { ", interrupted" } else { "" };
    format!(
        "{} (seed {}), {pace}: {} ticks{ended}",
        m.scenario, m.seed, m.answers.ticks
    )
}

/// Describes the answers to ticks in one or two lines.
fn deadlines(run: &Run) -> Vec<String> {
    let a = &run.measured.answers;
    let mut lines = vec![format!(
        "deadlines  {} of {} ticks answered in time, {} late, {} not answered, {} without the \
         beliefs of the tick",
        a.in_time, a.ticks, a.late, a.unanswered, a.without_beliefs
    )];
    let overruns: Vec<String> = run
        .measured
        .overruns
        .iter()
        .filter(|(_, count)| **count > 0)
        .map(|(name, count)| format!("{name} {count}"))
        .collect();
    lines.push(if overruns.is_empty() {
        "overruns   none".to_owned()
    } else {
        format!("overruns   {}", overruns.join(", "))
    });
    if let Some(off) = run.measured.period.get(TICK_JITTER) {
        let p = off.percentiles();
        lines.push(format!(
            "ticks      deviation from schedule {} (p50), {} (p99), {} (max)",
            us(p.p50),
            us(p.p99),
            us(p.max)
        ));
    }
    if let Some(share) = run.share_of_period() {
        lines.push(format!(
            "reaction   {:.1} % of the tick period (p99)",
            100.0 * share
        ));
    }
    lines
}

fn of_run(text: &mut String, run: &Run) {
    let _ = writeln!(text, "\n{}", headline(run));
    let table =
        |first: &'static str| TerminalTable::new([(first, 0)].into_iter().chain(PERCENTILES), 1);
    let mut stages = table("sense-to-act");
    for (name, p) in run.stages() {
        stages.add_row([vec![name.to_owned()], cells(&p).to_vec()].concat());
    }
    let mut hops = table("hop");
    for (name, own) in run.measured.hops.iter() {
        hops.add_row([vec![name.clone()], cells(&own.percentiles()).to_vec()].concat());
    }
    let _ = writeln!(text, "{stages}\n\n{hops}\n\n{}\n", turns(run));
    for line in deadlines(run) {
        let _ = writeln!(text, "{line}");
    }
    let _ = writeln!(
        text,
        "sums       sum of the stages and total of {} ticks differ by at most {} ns",
        run.measured.passages.len(),
        run.sum_error_ns()
    );
    if let Some(log) = &run.log {
        let _ = writeln!(text, "log        {}", log.display());
    }
}

/// Returns a table of the parts of steps, a row per kind of process.
fn turns(run: &Run) -> TerminalTable {
    const PARTS: [&str; 4] = ["wakes up", "takes its input", "computes", "writes"];
    let header = [("step of: p50 / p99", 0)].into_iter();
    let mut found = TerminalTable::new(header.chain(PARTS.into_iter().zip([3, 2, 0, 1])), 1);
    let all = &run.measured.turns;
    let mut kinds: Vec<&str> = all
        .iter()
        .filter_map(|(name, _)| PARTS.iter().find_map(|part| name.strip_suffix(part)))
        .map(str::trim_end)
        .collect();
    kinds.dedup();
    for kind in kinds {
        let mut row = vec![kind.to_owned()];
        row.extend(PARTS.map(|part| {
            let own = all.get(&format!("{kind} {part}"));
            own.map_or_else(String::new, |own| {
                format!("{} / {}", us(own.at(0.5)), us(own.at(0.99)))
            })
        }));
        found.add_row(row);
    }
    found
}
