//! What a person sees of it.

use super::fault::FaultKind;
use super::{ChaosReport, Outcome};
use crate::mission::report::table;
use crate::statistics::Distribution;

/// One line about a fault.
pub fn line(outcome: &Outcome) -> String {
    let fault = &outcome.fault;
    let what = if outcome.injected {
        format!("over after {:.2} s", outcome.over_after_s)
    } else {
        "too late every time".to_owned()
    };
    let course = serde_json::json!(fault.course);
    let policy = serde_json::json!(fault.policy);
    let mut line = format!(
        "{:5}  {} {} at {:.0} % ({}, {}): {what}",
        outcome.number,
        fault.kind.name(),
        fault.target,
        100.0 * fault.moment,
        course.as_str().unwrap_or_default(),
        policy.as_str().unwrap_or_default(),
    );
    for broken in &outcome.broken {
        line += &format!("\n       BROKEN: {broken}");
    }
    line
}

/// The result.
pub fn text(report: &ChaosReport) -> String {
    let mut rows = table(&[
        "fault",
        "injected",
        "promises broken",
        "over after, p50 [s]",
        "p99 [s]",
        "back after, p50 [s]",
        "p99 [s]",
        "robots stopped after, most [simulated s]",
        "lost, most [s]",
    ]);
    for kind in FaultKind::ALL {
        let of_kind = || {
            let all = report.outcomes.iter();
            all.filter(move |o| o.fault.kind == kind && o.injected)
        };
        if of_kind().next().is_none() {
            continue;
        }
        let over = || of_kind().map(|o| o.over_after_s);
        let back = || of_kind().filter_map(|o| o.back_after_s);
        let stopped = of_kind().filter_map(|o| o.stopped_after_s);
        let lost = of_kind().filter_map(|o| o.lost_s).reduce(f64::max);
        rows.add_row([
            kind.name().to_owned(),
            of_kind().count().to_string(),
            of_kind().map(|o| o.broken.len()).sum::<usize>().to_string(),
            seconds(quantile(over(), 0.5)),
            seconds(quantile(over(), 0.99)),
            seconds(quantile(back(), 0.5)),
            seconds(quantile(back(), 0.99)),
            seconds(stopped.reduce(f64::max)),
            seconds(lost),
        ]);
    }
    let mut text = rows.to_string();
    for outcome in report.outcomes.iter().filter(|o| !o.broken.is_empty()) {
        text += &format!("\n{}", line(outcome));
    }
    text + &format!(
        "\n{} faults injected in {:.1} min, {} promises broken",
        report.injected,
        report.lasted_s / 60.0,
        report.broken
    )
}

/// The value below which a share of the times lies [s]; `None` without any.
fn quantile(values: impl Iterator<Item = f64>, share: f64) -> Option<f64> {
    let mut times = Distribution::new()?;
    values.for_each(|seconds| times.record((seconds * 1e9) as u64));
    (times.count() > 0).then(|| times.at(share) * 1e-6)
}

fn seconds(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |s| format!("{s:.3}"))
}
