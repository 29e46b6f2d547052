//! A run's outcome for people (a table) and for programs (JSON, design §10).

use std::process::ExitStatus;

use comfy_table::presets::UTF8_HORIZONTAL_ONLY;
use comfy_table::{CellAlignment, Table};
use serde_json::{Value as Json, json};

use super::run::MissionReport;
use crate::scenario::ResolvedScenario;
use crate::scenario::spec::Mode;

/// Name of a mode in logs.
pub fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::LockStep => "lock_step",
        Mode::RealTime => "real_time",
    }
}

/// The machine in a line: system, processors, their model.
pub fn machine() -> String {
    let uname = rustix::system::uname();
    let processors = std::thread::available_parallelism().map_or(0, usize::from);
    let model = std::fs::read_to_string("/proc/cpuinfo")
        .ok()
        .and_then(|text| {
            let line = text.lines().find(|line| line.starts_with("model name"))?;
            Some(line.split(':').nth(1)?.trim().to_owned())
        })
        .unwrap_or_else(|| "unknown processor".into());
    format!(
        "{} {} {}, {processors} x {model}",
        uname.sysname().to_string_lossy(),
        uname.release().to_string_lossy(),
        uname.machine().to_string_lossy(),
    )
}

/// How a process ended, in words.
pub fn exit_words(status: ExitStatus) -> String {
    use std::os::unix::process::ExitStatusExt as _;
    match (status.code(), status.signal()) {
        (Some(code), _) => format!("ended with exit code {code}"),
        (None, Some(signal)) => format!("was ended by signal {signal}"),
        (None, None) => "ended".into(),
    }
}

/// The one JSON object of `protean run --json`.
pub fn json(scenario: &ResolvedScenario, report: &MissionReport) -> Json {
    let s = &report.summary;
    json!({
        "scenario": scenario.name,
        "seed": scenario.run.seed,
        "digest": s.digest,
        "ticks": s.ticks,
        "sim_time_s": s.sim_time_s,
        "wall_time_s": report.wall_time_s,
        "start_up_s": report.start_up_s,
        "real_time_factor": factor(report),
        "interrupted": report.interrupted,
        "robots": s.robots,
        "events": s.events,
        "events_omitted": s.events_omitted,
        "topics": s.topics,
        "latency_us": s.latency_us,
        "log": s.log,
        "log_bytes": s.log_bytes,
    })
}

fn factor(report: &MissionReport) -> f64 {
    report.summary.sim_time_s / report.wall_time_s.max(1e-9)
}

fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table
        .load_style(UTF8_HORIZONTAL_ONLY)
        .set_header(header.to_vec());
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

/// The summary for people.
pub fn text(scenario: &ResolvedScenario, report: &MissionReport) -> String {
    let s = &report.summary;
    let mut robots = table(&[
        "robot",
        "team",
        "outcome",
        "time [s]",
        "distance [m]",
        "contacts",
    ]);
    for r in &s.robots {
        robots.add_row([
            r.name.clone(),
            r.team.clone(),
            r.outcome.replace('_', " "),
            format!("{:.2}", r.time_s),
            format!("{:.2}", r.distance_m),
            r.contacts.to_string(),
        ]);
    }
    let mut latency = table(&["hop", "p50 [us]", "p90 [us]", "p99 [us]", "max [us]"]);
    for (hop, p) in &s.latency_us {
        let cell = |value: f64| format!("{value:.1}");
        latency.add_row([
            hop.clone(),
            cell(p.p50),
            cell(p.p90),
            cell(p.p99),
            cell(p.max),
        ]);
    }
    let messages: u64 = s.topics.values().map(|t| t.messages).sum();
    let gaps: u64 = s.topics.values().map(|t| t.gaps).sum();
    let rejected: u64 = s.topics.values().map(|t| t.rejected).sum();
    let mut text = format!(
        "{} (seed {}): {:.2} s simulated in {:.2} s, {:.0}x real time{}\n\n{robots}\n\n{latency}\n\n",
        scenario.name,
        scenario.run.seed,
        s.sim_time_s,
        report.wall_time_s,
        factor(report),
        if report.interrupted {
            ", interrupted"
        } else {
            ""
        },
    );
    text += &format!("ticks     {}\n", s.ticks);
    text += &format!(
        "messages  {messages} on {} topics, {gaps} lost",
        s.topics.len()
    );
    if rejected > 0 {
        text += &format!(", {rejected} rejected");
    }
    text += &format!("\ndigest    {}\n", s.digest);
    if s.log.as_os_str().is_empty() {
        text += "log       none: it ended before the first tick";
    } else {
        let megabytes = s.log_bytes as f64 * 1e-6;
        text += &format!("log       {} ({megabytes:.1} MB)", s.log.display());
    }
    text
}
