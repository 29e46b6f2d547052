//! The summary of a run for people.

use mission::MissionReport;
use recorder::{
    AttackTotals, LapFigures, PredictionOutcome, ProcessOutcome, RobotOutcome, Summary, TopicCount,
    WaypointOutcome, outcome_words, time_text,
};
use scenario::{ResolvedScenario, ScenarioRemark, remark_lines};
use tables::TerminalTable;

use super::output::command_line;

/// Outcomes of the robots, with the verdicts of a referee, if one ran.
fn robots_table(s: &Summary) -> TerminalTable {
    let mut columns = vec![
        ("robot", 0),
        ("team", 3),
        ("outcome", 0),
        ("time (s)", 0),
        ("distance (m)", 1),
        ("contacts", 2),
    ];
    let judged = s.escape_possible_fraction.is_some();
    if judged {
        columns.extend([("can escape", 1), ("not from (s)", 1)]);
    }
    let mut robots = TerminalTable::new(columns, 1);
    for r in &s.robots {
        let mut row = vec![
            r.name.clone(),
            r.team.clone(),
            r.outcome.replace('_', " "),
            time_text(r.time_s),
            format!("{:.2}", r.distance_m),
            r.contacts.to_string(),
        ];
        if judged {
            let cell =
                |value: Option<f64>, text: fn(f64) -> String| value.map_or_else(String::new, text);
            row.push(cell(r.escape_possible_fraction, |f| {
                format!("{:.0} %", 100.0 * f)
            }));
            row.push(cell(r.escape_impossible_from_s, time_text));
        }
        robots.add_row(row);
    }
    robots
}

/// Outcomes of a robot's waypoints, as a line of text.
fn waypoints_text(robot: &RobotOutcome, w: &WaypointOutcome) -> String {
    let left_out = [
        (w.inside_obstacle, "inside obstacles"),
        (w.timed_out, "timed out"),
        (w.unreachable, "unreachable"),
        (w.stuck, "stuck"),
    ];
    let reasons: Vec<String> = left_out
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, why)| format!("{count} {why}"))
        .collect();
    let mut text = format!(
        "waypoints {}: {} reached within {:.2} m, {} skipped{}",
        robot.name,
        w.reached,
        w.farthest_m,
        w.left_out(),
        if reasons.is_empty() {
            String::new()
        } else {
            format!(" ({})", reasons.join(", "))
        },
    );
    if w.route_left_out > 0 {
        text += &format!(", {} of the route", w.route_left_out);
    }
    if let Some(laps) = w.laps {
        text += &format!("; {laps} {}", if laps == 1 { "lap" } else { "laps" });
    }
    if let Some(longest) = w.longest_lap_s {
        text += &format!(", longest {} s", time_text(longest));
    }
    if let (Some(longest), Some(limit)) = (w.longest_lap_s, w.lap_limit_s) {
        text += &if longest <= limit {
            format!(" of {limit} s")
        } else {
            format!(
                ", {} s over the limit of {limit} s",
                time_text(longest - limit)
            )
        };
    }
    text.push('\n');
    let lap = |what: &str, f: &LapFigures| {
        format!(
            "          lap {what}: {:.1} m, MAE {:.2} m, {:.0} turns of {:.2} rad\n",
            f.length_m, f.mae_m, f.turns, f.maa,
        )
    };
    for (what, figures) in [("as planned", &w.planned), ("as driven", &w.driven)] {
        if let Some(figures) = figures {
            text += &lap(what, figures);
        }
    }
    text
}

/// Failures of a process, as a line of text.
fn failures_text(process: &ProcessOutcome) -> String {
    let mut text = format!(
        "failed    {}: {} times, absent for {} ticks{}\n",
        process.name,
        process.outages.len(),
        process.ticks_absent,
        if process.given_up { ", given up" } else { "" },
    );
    for outage in &process.outages {
        let back = match outage.back_tick {
            Some(tick) => format!("restarted at tick {tick}"),
            None => "not restarted".to_owned(),
        };
        text += &format!(
            "          {} s, tick {}: {}; {back}\n",
            time_text(outage.left_time_s),
            outage.left_tick,
            outage.reason,
        );
    }
    text
}

/// Prediction errors of observers: a row per robot and method, the mean errors side by side.
fn predictions_table(predictions: &[PredictionOutcome]) -> TerminalTable {
    let mut ahead: Vec<f64> = predictions.iter().map(|p| p.horizon_s).collect();
    ahead.sort_by(f64::total_cmp);
    ahead.dedup();
    let mut columns = vec![("robot".to_owned(), 0), ("predicted by".to_owned(), 0)];
    columns.extend(ahead.iter().map(|s| (format!("{s} s ahead (m)"), 1)));
    let keys = predictions.iter().any(|p| p.key_recovered_s.is_some());
    if keys {
        columns.push(("key recovered".to_owned(), 0));
    }
    let mut found = TerminalTable::new(columns, 1);
    let same = |a: &PredictionOutcome, b: &PredictionOutcome| {
        (a.observer, &a.robot, &a.method) == (b.observer, &b.robot, &b.method)
    };
    for of_a_method in predictions.chunk_by(same) {
        let Some(first) = of_a_method.first() else {
            continue;
        };
        let mut row = vec![first.robot.clone(), first.method.replace('_', " ")];
        row.extend(ahead.iter().map(|horizon| {
            let outcome = of_a_method.iter().find(|p| p.horizon_s == *horizon);
            let mean = outcome.and_then(|p| p.mean_m);
            mean.map_or_else(String::new, |mean| format!("{mean:.2}"))
        }));
        if keys {
            row.push(match (first.key_recovered_s, first.key_recovered_after) {
                (Some(time_s), Some(goals)) => {
                    format!("after {goals} goals, {} s", time_text(time_s))
                }
                _ => String::new(),
            });
        }
        found.add_row(row);
    }
    found
}

/// Latencies of every hop.
fn latency_table(s: &Summary) -> TerminalTable {
    let columns = [
        ("hop", 0),
        ("p50 (us)", 0),
        ("p90 (us)", 3),
        ("p99 (us)", 1),
        ("max (us)", 2),
    ];
    let mut latency = TerminalTable::new(columns, 1);
    for (hop, p) in &s.latency_us {
        let cells = [p.p50, p.p90, p.p99, p.max].map(|value| format!("{value:.1}"));
        latency.add_row([hop.clone()].into_iter().chain(cells));
    }
    latency
}

/// The verdict of a run.
fn verdict(report: &MissionReport) -> String {
    let s = &report.summary;
    let interrupted = if report.interrupted {
        "interrupted: "
    } else {
        ""
    };
    let words = outcome_words(&s.robots, s.coverage.as_ref());
    format!("{interrupted}{words}")
}

/// The result without notes and statistics: verdict, outcomes of the robots, failures, digest and log.
pub fn short(report: &MissionReport) -> String {
    let s = &report.summary;
    let mut text = format!("{}\n\n{}\n\n", verdict(report), robots_table(s));
    for process in &s.processes {
        text += &failures_text(process);
    }
    match s.topics.values().map(|topic| topic.gaps).sum::<u64>() {
        0 => {}
        lost => text += &format!("messages  {lost} lost\n"),
    }
    text += &format!("digest    {}\n", s.digest);
    if !s.log.as_os_str().is_empty() {
        text += &format!("log       {}\n", s.log.display());
    }
    text.trim_end().to_owned()
}

/// The summary for people: first the verdict, last what to do next.
pub fn text(
    scenario: &ResolvedScenario,
    remarks: &[ScenarioRemark],
    report: &MissionReport,
    with_latency: bool,
) -> String {
    let s = &report.summary;
    let mut text = format!(
        "{}\n{} (seed {}): {} s simulated in {:.2} s, {:.0}x real time, {} ticks\n\n{}\n\n",
        verdict(report),
        scenario.name,
        scenario.run.seed,
        time_text(s.sim_time_s),
        report.wall_time_s,
        report.real_time_factor(),
        s.ticks,
        robots_table(s),
    );
    if let Some(predictions) = &s.predictions {
        text += &format!("{}\n\n", predictions_table(predictions));
    }
    if with_latency {
        text += &format!("{}\n\n", latency_table(s));
    }
    let stops: u32 = s.robots.iter().map(|r| r.fail_safe_stops).sum();
    if stops > 0 {
        text += &format!("fail-safe stops: {stops} (no fresh command)\n");
    }
    for robot in s.robots.iter().filter(|robot| robot.standstills > 0) {
        let (name, times) = (&robot.name, robot.standstills);
        text += &format!("{name} stood before its goal for 10 s or more: {times} x\n");
    }
    for process in &s.processes {
        text += &failures_text(process);
    }
    if !s.links.is_empty() {
        let messages: u64 = s.links.iter().map(|link| link.messages).sum();
        let lost: u64 = s.links.iter().map(|link| link.lost).sum();
        let links = s.links.len();
        text += &format!("links     {lost} of {messages} messages lost on {links} links\n");
    }
    if let Some(coverage) = &s.coverage {
        text += &format!(
            "coverage  {:.1} % of {:.1} m2 free area, {:.1} % of the coverable area, path length {:.0} m\n",
            100.0 * coverage.fraction,
            coverage.free_m2,
            100.0 * coverage.coverable_fraction,
            coverage.way_m,
        );
    }
    for patrol in &s.patrols {
        let (count, nodes) = (patrol.robots.len(), patrol.nodes.len());
        let of = match nodes {
            0 => "the contour".to_owned(),
            _ => format!("{nodes} nodes"),
        };
        if let (Some(mean), Some(worst)) = (patrol.mean_idleness_s, patrol.worst_idleness_s)
            && (nodes > 0 || patrol.nearest_m.is_some())
        {
            text += &format!(
                "patrol    {count} robots, idleness of {of} {mean:.1} s on average, {worst:.1} s at most"
            );
            if let Some(nearest) = patrol.nearest_m {
                text += &format!("; at least {nearest:.1} m apart");
            }
            text += "\n";
        }
    }
    for adversary in AttackTotals::from_outcomes(&s.attacks) {
        let AttackTotals {
            attacker,
            method,
            attacks,
            detected,
        } = adversary;
        let method = method.replace('_', " ");
        text += &format!("attacks   {attacker}, {method}: {detected} of {attacks} detected\n");
    }
    for robot in &s.robots {
        if let Some(waypoints) = &robot.waypoints {
            text += &waypoints_text(robot, waypoints);
        }
    }
    // The warnings have been shown before the run.
    for note in remark_lines(remarks.iter().filter(|remark| !remark.is_warning())) {
        text += &format!("{note}\n");
    }
    text + &messages_text(s) + &format!("digest    {}\n", s.digest) + &log_text(s)
}

/// Counts of the messages, as a line of text.
fn messages_text(s: &Summary) -> String {
    let sum = |count: fn(&TopicCount) -> u64| s.topics.values().map(count).sum::<u64>();
    let rejected = match sum(|topic| topic.rejected) {
        0 => String::new(),
        rejected => format!(", {rejected} rejected"),
    };
    format!(
        "messages  {}, {} lost{rejected}\n",
        s.message_counts(),
        sum(|topic| topic.gaps),
    )
}

/// The log and what to do with it.
fn log_text(s: &Summary) -> String {
    if s.log.as_os_str().is_empty() {
        let why = if s.ticks == 0 {
            " (the run ended before the first tick)"
        } else {
            "; --out FILE writes one"
        };
        return format!("log       none{why}");
    }
    let log = s.log.to_string_lossy();
    format!(
        "log       {log} ({:.1} MB)\nnext      {}",
        s.log_bytes as f64 * 1e-6,
        command_line(&["report", &log, "--open"]),
    )
}
